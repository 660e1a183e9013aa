#include "meshing/backends/tetgen.h"

#include <spawn.h>
#include <sys/socket.h>
#include <unistd.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <map>

#include "common/error.h"
#include "meshing/backends/tetgen_protocol.h"
#include "meshing/byte_stream.h"

extern char** environ;

namespace vivify::meshing {
namespace {

constexpr const char* kWorkerName = "vivify_tetgen";

// The worker lies beside the program, in the installed libexec folder, or in the build tree.
std::filesystem::path worker_path() {
  namespace fs = std::filesystem;
  std::vector<fs::path> candidates;
  if (const char* given = std::getenv("VIVIFY_TETGEN")) candidates.emplace_back(given);
  std::error_code failure;
  const fs::path program = fs::read_symlink("/proc/self/exe", failure);
  if (!failure) {
    candidates.push_back(program.parent_path() / kWorkerName);
    candidates.push_back(program.parent_path().parent_path() / "libexec" / "vivify" / kWorkerName);
  }
  candidates.emplace_back(VIVIFY_TETGEN_WORKER);
  for (const fs::path& candidate : candidates) {
    if (access(candidate.c_str(), X_OK) == 0) return candidate;
  }
  throw Error(ErrorKind::io, std::string("the helper program ") + kWorkerName + " was not found",
              "it belongs beside the vivify program; build or install again, or choose the backend cgal");
}

ChildOutcome run_worker(std::span<const std::byte> request, const ProcessLimits& limits) {
  const std::string path = worker_path().string();
  std::array<int, 2> sockets = {};
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, sockets.data()) != 0) {
    throw Error(ErrorKind::io, std::string("cannot make a socket pair: ") + std::strerror(errno));
  }
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, sockets[1], STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, sockets[1], STDOUT_FILENO);
  std::string name = kWorkerName;
  std::array<char*, 2> arguments = {name.data(), nullptr};
  pid_t child = 0;
  const int failure = posix_spawn(&child, path.c_str(), &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(sockets[1]);
  if (failure != 0) {
    close(sockets[0]);
    throw Error(ErrorKind::io, "cannot start " + path + ": " + std::strerror(failure));
  }
  return converse(child, sockets[0], request, limits);
}

// What the codes mean that TetGen throws.
struct Refusal {
  int code;
  const char* message;
  const char* hint;
};
constexpr const char* kRepairHint = "repair the surface first, or choose the backend cgal";
constexpr Refusal kRefusals[] = {
    {1, "TetGen could not get enough memory", "ask for fewer vertices"},
    {2, "TetGen stopped with an internal error", kRepairHint},
    {3, "TetGen rejects the surface: facets intersect one another", kRepairHint},
    {4, "TetGen rejects the surface: it has a feature too small for double precision", kRepairHint},
    {5, "TetGen rejects the surface: two facets almost coincide", kRepairHint},
    {10, "TetGen rejects the surface: its input is not valid", kRepairHint},
};

[[noreturn]] void report_failure(const ChildOutcome& outcome, const ProcessLimits& limits) {
  for (const Refusal& refusal : kRefusals) {
    if (outcome.exit_code() == kTetgenExit + refusal.code) {
      throw Error(ErrorKind::geometry, refusal.message, refusal.hint);
    }
  }
  if (outcome.timed_out || outcome.exit_code() == kOutOfMemoryExit) {
    throw Error(ErrorKind::geometry, "TetGen " + outcome.describe(limits), "ask for fewer vertices");
  }
  throw Error(ErrorKind::geometry, "TetGen " + outcome.describe(limits),
              std::string("flat and self-intersecting surfaces do this; ") + kRepairHint);
}

void check_input(const TetgenInput& input) {
  const auto fail = [](const std::string& message) { throw Error(ErrorKind::geometry, message); };
  if (input.points.rows() < 4 || input.facets.rows() < 4) {
    fail("a surface of " + std::to_string(input.points.rows()) + " points and " +
         std::to_string(input.facets.rows()) + " triangles encloses no volume");
  }
  for (Eigen::Index v = 0; v < input.points.rows(); ++v) {
    if (!input.points.row(v).allFinite())
      fail("point " + std::to_string(v) + " of the surface is not finite");
  }
  if (input.facets.minCoeff() < 0 || input.facets.maxCoeff() >= input.points.rows()) {
    fail("a triangle of the surface refers to a point that does not exist");
  }
}

void make_positive(TetMesh& mesh) {
  const Eigen::VectorXd volumes = tet_volumes(mesh);
  for (Eigen::Index t = 0; t < mesh.T.rows(); ++t) {
    if (volumes[t] < 0) std::swap(mesh.T(t, 2), mesh.T(t, 3));
  }
}

// Boundary triangles of the tetrahedra, outward, with the facet that TetGen found them on.
void take_boundary(const Triangles& faces, const Eigen::VectorXi& markers, TetgenOutput& output) {
  const auto key_of = [](const auto& face) {
    std::array<int, 3> key = {face[0], face[1], face[2]};
    std::sort(key.begin(), key.end());
    return key;
  };
  std::map<std::array<int, 3>, int> facet;
  for (Eigen::Index f = 0; f < faces.rows(); ++f) facet[key_of(faces.row(f))] = markers[f] - 1;
  output.boundary = boundary_faces(output.mesh);
  output.boundary_facet.resize(output.boundary.rows());
  for (Eigen::Index f = 0; f < output.boundary.rows(); ++f) {
    const auto found = facet.find(key_of(output.boundary.row(f)));
    output.boundary_facet[f] = found == facet.end() ? -1 : found->second;
  }
}

}  // namespace

TetgenOutput run_tetgen(const TetgenInput& input, const std::string& switches, const ProcessLimits& limits) {
  check_input(input);
  const Box box = bounding_box(input.points);
  const Eigen::RowVector3d centre = (0.5 * (box.min + box.max)).transpose();
  const double size = box.diagonal();
  if (!(size > 0)) throw Error(ErrorKind::geometry, "all points of the surface coincide");
  const Points scaled = (input.points.rowwise() - centre) / size;

  ByteWriter request;
  request.put(limits.megabytes).put(switches + "JQ").put(scaled).put(input.facets);  // J: keep unused points
  const ChildOutcome outcome = run_worker(request.take(), limits);
  if (!outcome.succeeded()) report_failure(outcome, limits);

  TetgenOutput output;
  Triangles faces;
  Eigen::VectorXi markers;
  ByteReader answer(outcome.answer);
  answer.get(output.mesh.V);
  answer.get(output.mesh.T);
  answer.get(faces);
  answer.get(markers);
  if (output.mesh.T.rows() == 0) {
    throw Error(ErrorKind::geometry, "TetGen made no tetrahedron: the surface is open or encloses no volume",
                kRepairHint);
  }
  if (output.mesh.V.rows() < input.points.rows()) {
    throw Error(ErrorKind::internal, "TetGen dropped points of its input");
  }
  output.mesh.V = ((output.mesh.V * size).rowwise() + centre).eval();
  output.mesh.V.topRows(input.points.rows()) = input.points;
  make_positive(output.mesh);
  take_boundary(faces, markers, output);
  return output;
}

}  // namespace vivify::meshing
