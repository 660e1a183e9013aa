// Near places that look like walls when a step begins, although the bodies pass them by.
#pragma once

#include "sim/contact/surface_pairs.h"

namespace vivify::sim {

// The place of a surface's points with these weights.
Eigen::Vector3d place_of(const SurfaceState& surface, const std::array<int, 3>& points,
                         const std::array<double, 3>& weights);

// A point that gets far may cross the plane of its nearest place and yet be outside in the end: it passes
// over an edge, say. When the pair's point moves by `move` (of a as seen from b, m), is then still farther
// than `apart` (m) from the other surface, on another side of it, and was nowhere deeper inside than that on
// its straight way, the pair gets the place and the normal nearest there; its distance stays that of now.
// Faces of shells and rods have no outside; their pairs stay as they are.
void follow_passing(SurfacePair& pair, const SurfaceState& a, const SurfaceState& b,
                    const Eigen::Vector3d& move, double apart);

// Whether nothing can touch `body` at the place y of its surface from the direction n (unit, out of the
// body), because `cover` lies flush against it: `gap` (m) along n from y is on the surface of `cover`, or
// not far inside it, and the outward normal there is one of `body` at y too. The latter tells a seam from an
// inner corner, both of whose sides are touched.
bool is_covered(const Eigen::Vector3d& y, const Eigen::Vector3d& n, const SurfaceState& body,
                const SurfaceState& cover, double gap);

}  // namespace vivify::sim
