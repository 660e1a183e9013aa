// Ground given by its heights on a grid: two triangles in each cell.
#include "sim/contact/shapes/shapes.h"

namespace vivify::sim {

Schema height_field_schema() {
  return object(
             "Ground given by its heights on a grid, with two triangles in each cell. The middle of the grid "
             "is at the origin of the object; beyond its rim there is nothing.")
      .field("heights", list("The rows of the grid, from -z to +z.",
                             list("Heights in metres, from -x to +x.", number("A height.")).items_at_least(2))
                            .items_at_least(2)
                            .required())
      .field("cell", vector("Width of a cell along x and along z.", 2).unit("m").above(0).initially({1, 1}));
}

std::unique_ptr<ColliderShape> make_height_field(const Value& settings, const ShapePlace& place) {
  const std::vector<Value>& heights = settings["heights"].items();
  const Eigen::VectorXd cell = settings["cell"].as_vector();
  const auto rows = static_cast<int>(heights.size());
  const auto columns = static_cast<int>(heights.front().items().size());
  TriangleMesh ground{Points(rows * columns, 3),
                      Triangles(2 * (rows - 1) * (columns - 1), 3),
                      TexCoords(rows * columns, 2),
                      {},
                      {}};
  for (int j = 0, face = 0; j < rows; ++j) {
    const std::vector<Value>& row = heights[static_cast<std::size_t>(j)].items();
    if (static_cast<int>(row.size()) != columns) {
      throw Error(ErrorKind::usage,
                  "row " + std::to_string(j) + " of a height field has " + std::to_string(row.size()) +
                      " heights and the first row " + std::to_string(columns),
                  "give every row as many", heights[static_cast<std::size_t>(j)].where());
    }
    for (int i = 0; i < columns; ++i) {
      const int here = j * columns + i;
      const Eigen::Vector3d p(cell[0] * (i - 0.5 * (columns - 1)),
                              row[static_cast<std::size_t>(i)].as_number(), cell[1] * (j - 0.5 * (rows - 1)));
      ground.V.row(here) = place.point(p).transpose();
      ground.UV.row(here) << place.scale * p.x(), place.scale * p.z();
      if (i + 1 == columns || j + 1 == rows) continue;
      ground.F.row(face++) << here, here + columns, here + columns + 1;
      ground.F.row(face++) << here, here + columns + 1, here + 1;
    }
  }
  return make_mesh_shape("height field", std::move(ground));
}

}  // namespace vivify::sim
