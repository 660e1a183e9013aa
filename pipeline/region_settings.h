// Parts of a body that handles hold, of scene and pose files.
#pragma once

#include <string>
#include <vector>

#include "common/error.h"
#include "common/schema.h"
#include "common/value.h"
#include "sim/region.h"

namespace vivify::pipeline {

Schema region_schema();
// Point about which a handle turns, next to its region.
Schema about_schema();

// Adds an Error(usage) when the region of the handle `name` ("handles[0]") is empty.
void check_region(const Value& handle, const std::string& name, std::vector<Error>& errors);

sim::Region make_region(const Value& handle, const std::string& name);

}  // namespace vivify::pipeline
