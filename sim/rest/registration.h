// Registration of the elements of an example pose to the rest shape, Section 5 of Coros et al. 2012: each
// element is turned and moved so that only its deformation is left.
#pragma once

#include "sim/rest/rest_space.h"

namespace vivify::sim {

// The stacked points of the pose (`posed`, flat, with `dimension` coordinates per point) with every element
// registered to that of `rest`. Simplices: by the rotation of the polar decomposition of their deformation
// gradient. Elements round a centre edge: the edge turned to the direction of its counterpart (in space also
// the mean normal of the two triangles), with the centres of both edges in one place. Throws Error(geometry)
// that names the pose and the element when it is turned inside out or has no size.
Eigen::VectorXd register_elements(const Eigen::VectorXd& posed, const Eigen::VectorXd& rest,
                                  const RestPoints& points, int dimension, const std::string& pose);

// Throws Error(geometry) when a pose does not have the vertices of the mesh, or has numbers that are not
// finite.
void check_pose(const ExamplePose& pose, const SimMesh& mesh);

}  // namespace vivify::sim
