// Bodies of the speed benches, generated: meshes of chosen sizes, cages and poses for them, and a ground.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "sim/body.h"

namespace vivify::bench {

// Solids of tetrahedra: cubic cells of edge `cell` (m) in six tetrahedra each, the whole standing on y = 0
// about the y axis.
SimMesh box(int nx, int ny, int nz, double cell);
// Cells of an nx by ny by nz grid that `inside` keeps.
SimMesh cells(int nx, int ny, int nz, double cell, const std::function<bool(int, int, int)>& inside);
// Three crossing bars `thick` cells wide that reach arms[k] cells beyond the middle towards −x, +x, −y, +y,
// −z, +z, standing on the tips of three arms.
SimMesh cross(int thick, const std::vector<int>& arms, double cell);
// A ball of `layers` concentric spheres with 12, 42, 162 ... vertices for 0, 1, 2 ... subdivisions, and its
// centre.
SimMesh ball(double radius, int layers, int subdivisions);

// Flat solids of triangles.
SimMesh rectangle(int nx, int ny, double cell);
// Cells of a picture of rows from the top down, '#' for material, each `split` by `split` squares.
SimMesh letter(const std::vector<std::string>& picture, int split, double cell);
SimMesh disc(double radius, int rings);

// A closed rod of n edges along the rim of a rectangle, standing on its lower side.
SimMesh closed_rod(int n, double width, double height);
// A sheet of nx by ny squares, arched about y so that it stands on its lower edge.
SimMesh card(int nx, int ny, double cell);

// Coordinates of the vertices in the 2^d corners of a box around them (multilinear).
Eigen::MatrixXd corner_weights(const RowMatrixXd& V);
// Coordinates in `count` vertices spread over the body, by moving least squares: like those of a cage, they
// sum to 1 and reproduce affine maps, and every cage vertex moves every vertex.
Eigen::MatrixXd spread_weights(const RowMatrixXd& V, int count);
// Smooth deformations: waves of growing frequency in alternating directions, of 0.12 of the body's size.
std::vector<sim::ExamplePose> waves(const RowMatrixXd& V, int count);

// Settings given as YAML, checked and completed. Throws the first Error.
Value settings(const Schema& schema, const std::string& yaml);

// A body with `model` and `controller` (YAML) that touches the ground with at most 160 of its surface
// vertices. Its rest space is a cage with the corners of its box, until the caller sets another.
sim::BodyInput body_input(const std::string& name, SimMesh mesh, const std::string& model,
                          const std::string& controller);
// The model whose stiffness (Pa, N, N/m) is `lively` times density · g · height of the mesh.
std::string lively_model(const std::string& type, const SimMesh& mesh, double lively = 45);

// A square of 100 m at y = 0 with friction 1.
std::vector<sim::Collider> ground();

}  // namespace vivify::bench
