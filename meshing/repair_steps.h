// The CGAL part of repair_surface; runs inside its child process.
#pragma once

#include "common/file.h"
#include "common/mesh.h"

namespace vivify::meshing {

// Both give back the bytes of V, F, route and notes.
Bytes repair_step_by_step(const TriangleMesh& input);
Bytes wrap_as_it_is(const TriangleMesh& input);

}  // namespace vivify::meshing
