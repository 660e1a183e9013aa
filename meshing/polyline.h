// Polylines: corners, arc length, fewer and evenly spread points.
#pragma once

#include <vector>

#include "common/mesh.h"

namespace vivify::meshing {

inline constexpr double kCornerAngle = 30;  // degrees: a polyline that turns by more has a corner there

// Vertices where the polyline turns by more than kCornerAngle, in order; the ends of an open one too.
std::vector<int> corners_of(const Points2& points, bool closed);

// The part of a (closed) polyline from vertex `first` to vertex `last`; a whole turn when they are the same.
Points2 section(const Points2& points, int first, int last);

double arc_length(const Points2& points);  // of an open polyline, metres

// `count` + 1 points at equal arc length along an open polyline, with its ends.
Points2 spread_evenly(const Points2& points, int count);

// How many pieces to cut each section into, at least one, `total` in all: the section with the longest pieces
// gets the next one.
std::vector<int> share_pieces(const std::vector<double>& lengths, int total);

// Vertices of an open polyline, its ends among them, such that the others lie within `tolerance` of the
// polyline through them (Ramer 1972, Douglas and Peucker 1973).
Points2 simplify(const Points2& points, double tolerance);

}  // namespace vivify::meshing
