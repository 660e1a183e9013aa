#include "tests/pipeline/tiny_scene.h"

#include <map>
#include <stdexcept>

#include "common/file.h"
#include "common/text.h"

namespace vivify::testing_support {
namespace {

constexpr const char* kScene = R"(version: 1
frames: {fps: 24, duration_s: 0.25, steps_per_frame: 2}
materials:
  clay: {type: diffuse, color: [0.7, 0.4, 0.3]}
bodies:
  - name: ball
    mesh: ball.obj
    position: [0, 0.5, 0]
    tetrahedra: {backend: tetgen, vertices: 60}
    rest_space: {type: cage, vertices: 8, harmonic_unknowns: 500}
    model: {type: solid3d, density: 100, stiffness: 30000}
    controller: {type: hop, heading_deg: 90}
    looks: {all: clay}
colliders:
  - {name: plate, mesh: plate.obj, position: [0, -0.1, 0]}
camera: {position: [0, 1, 4], target: [0, 0.5, 0], follow: ball}
lights:
  - {type: environment}
render: {size: [32, 18], spp: 1}
)";

// One midpoint per edge, so that the refined surface stays closed.
int midpoint(TriangleMesh& mesh, std::map<std::pair<int, int>, int>& known, int a, int b) {
  const auto [entry, fresh] = known.emplace(std::minmax(a, b), static_cast<int>(mesh.V.rows()));
  if (fresh) {
    mesh.V.conservativeResize(mesh.V.rows() + 1, 3);
    mesh.V.row(mesh.V.rows() - 1) = (mesh.V.row(a) + mesh.V.row(b)) / 2;
  }
  return entry->second;
}

}  // namespace

TriangleMesh box_mesh(const Eigen::Vector3d& half) {
  TriangleMesh mesh;
  mesh.V.resize(8, 3);
  for (int i = 0; i < 8; ++i) {
    mesh.V.row(i) << ((i & 1) != 0 ? half.x() : -half.x()), ((i & 2) != 0 ? half.y() : -half.y()),
        ((i & 4) != 0 ? half.z() : -half.z());
  }
  mesh.F.resize(12, 3);
  mesh.F << 0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5,
      3, 7, 5;
  return mesh;
}

TriangleMesh ball_mesh(double radius, int refinements) {
  TriangleMesh mesh;
  mesh.V.resize(6, 3);
  mesh.V << 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1;
  mesh.F.resize(8, 3);
  mesh.F << 0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5;
  for (int r = 0; r < refinements; ++r) {
    std::map<std::pair<int, int>, int> known;
    Triangles finer(4 * mesh.F.rows(), 3);
    for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
      const int a = mesh.F(f, 0), b = mesh.F(f, 1), c = mesh.F(f, 2);
      const int ab = midpoint(mesh, known, a, b), bc = midpoint(mesh, known, b, c),
                ca = midpoint(mesh, known, c, a);
      finer.row(4 * f) << a, ab, ca;
      finer.row(4 * f + 1) << ab, b, bc;
      finer.row(4 * f + 2) << ca, bc, c;
      finer.row(4 * f + 3) << ab, bc, ca;
    }
    mesh.F = finer;
  }
  mesh.V = radius * mesh.V.rowwise().normalized();
  return mesh;
}

std::string obj_text(const TriangleMesh& mesh) {
  std::string text;
  for (const auto& v : mesh.V.rowwise()) {
    text += "v " + number_text(v[0]) + " " + number_text(v[1]) + " " + number_text(v[2]) + "\n";
  }
  for (const auto& f : mesh.F.rowwise()) {
    text += "f " + std::to_string(f[0] + 1) + " " + std::to_string(f[1] + 1) + " " +
            std::to_string(f[2] + 1) + "\n";
  }
  return text;
}

TinyScene::TinyScene() : file_(folder_ / "tiny.yaml") {
  write_file_atomic(file_, std::string_view(kScene));
  write("ball.obj", obj_text(ball_mesh(0.5, 2)));
  write("plate.obj", obj_text(box_mesh({3, 0.1, 3})));
}

void TinyScene::change(const std::string& text, const std::string& replacement) {
  std::string scene = read_text_file(file_);
  const std::size_t at = scene.find(text);
  if (at == scene.npos) throw std::logic_error("the tiny scene does not hold '" + text + "'");
  write_file_atomic(file_, scene.replace(at, text.size(), replacement));
}

void TinyScene::write(const std::string& name, const std::string& content) const {
  write_file_atomic(folder_ / name, content);
}

}  // namespace vivify::testing_support
