// Which points of the drawn surface touch the world.
#pragma once

#include "sim/contact/contact_set.h"

namespace vivify::sim {

// `count` well-spread points of the drawn surface: half of them on the part it stands on (the lowest
// hundredth of its height), the rest over the whole surface, each by farthest-point sampling. `surface` (#P
// by 3) is the drawn surface at rest; row i of `vertices` and `weights` (#P by k) embeds its point i in the
// simulation mesh, whose points have `dimension` coordinates.
ContactPoints select_contact_points(const Points& surface, const RowMatrixXi& vertices,
                                    const RowMatrixXd& weights, int dimension, int count);

// Number of the points that carry the body when it stands upright at rest (those in its lowest hundredth).
int count_standing_points(const ContactPoints& points, const Eigen::VectorXd& rest);

}  // namespace vivify::sim
