#include "meshing/repair.h"

#include <Eigen/Geometry>
#include <string>

#include "common/error.h"
#include "meshing/byte_stream.h"
#include "meshing/main_body.h"
#include "meshing/repair_steps.h"

namespace vivify::meshing {
namespace {

void check_input(const TriangleMesh& input) {
  const auto fail = [](const std::string& message, const std::string& hint = {}) {
    throw Error(ErrorKind::geometry, message, hint);
  };
  if (input.F.rows() == 0) fail("the mesh has no triangles");
  if (input.F.minCoeff() < 0 || input.F.maxCoeff() >= input.V.rows()) {
    fail("a triangle of the mesh refers to a vertex that does not exist");
  }
  double largest = 0;
  for (Eigen::Index f = 0; f < input.F.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      if (!input.V.row(input.F(f, k)).allFinite()) {
        fail("vertex " + std::to_string(input.F(f, k)) + " of the mesh is not finite");
      }
    }
    const Eigen::Vector3d a = input.V.row(input.F(f, 0)), b = input.V.row(input.F(f, 1)),
                          c = input.V.row(input.F(f, 2));
    largest = std::max(largest, (b - a).cross(c - a).norm());
  }
  if (!(largest > 0)) fail("every triangle of the mesh has zero area", "check the mesh file");
}

RepairedSurface run(Bytes (*steps)(const TriangleMesh&), const TriangleMesh& input,
                    const ProcessLimits& limits) {
  const Bytes bytes =
      run_guarded("repairing the surface", "simplify the mesh or repair it in a modelling program", limits,
                  [&] { return steps(input); });
  RepairedSurface surface;
  ByteReader reader(bytes);
  reader.get(surface.mesh.V);
  reader.get(surface.mesh.F);
  reader.get(surface.route);
  reader.get(surface.notes);
  return surface;
}

}  // namespace

RepairedSurface repair_surface(const TriangleMesh& input, const ProcessLimits& limits) {
  check_input(input);
  std::vector<std::string> notes;
  const TriangleMesh body = main_body(input, notes);
  RepairedSurface surface;
  try {
    surface = run(repair_step_by_step, body, limits);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::geometry) throw;
    surface = run(wrap_as_it_is, body, limits);
    notes.push_back(std::string("the step-by-step repair failed: ") + error.what());
  }
  surface.notes.insert(surface.notes.begin(), notes.begin(), notes.end());
  return surface;
}

}  // namespace vivify::meshing
