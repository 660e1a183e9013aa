// Golden images: small pictures kept in the repository that renders are compared with (docs/image_tests.md).
#pragma once

#include <string>

#include "common/file.h"

namespace vivify::test {

// Whether this processor is of the family that the goldens were made on: there every bit must agree.
bool on_reference_processor();

// Fails the test when the EXR file is not the golden NAME.exr: exactly on the reference processor, within the
// tolerance of `vivify diff` elsewhere. The picture and a map of the differences are then left in the folder
// that the failure names. With VIVIFY_UPDATE_GOLDENS=1 in the environment the golden is replaced, and the
// test fails to say so. A golden that does not exist is a failure.
void expect_golden(const std::string& name, const Bytes& exr);

}  // namespace vivify::test
