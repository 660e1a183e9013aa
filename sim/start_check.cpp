#include "sim/start_check.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <sstream>

#include "common/error.h"
#include "common/text.h"

namespace vivify::sim {
namespace {

constexpr double kResolvedDepth = 0.02;  // of the height

std::string metres(double length) {
  std::ostringstream text;
  text.precision(3);
  text << length << " m";
  return text.str();
}

ContactPoints element_centres(const SimMesh& mesh) {
  ContactPoints centres;
  centres.dimension = mesh.dimension();
  centres.vertices = mesh.E;
  centres.weights = RowMatrixXd::Constant(mesh.E.rows(), mesh.E.cols(), 1.0 / mesh.element_points());
  return centres;
}

struct Depth {
  double depth = 0;  // m
  int collider = -1;
};

Depth depth_in_colliders(const ContactPoints& points, const Body& body,
                         const std::vector<Collider>& colliders, double time) {
  const std::vector<ContactMemory> untouched(static_cast<std::size_t>(points.size()));
  const ContactSet contacts(points, body.model().contact, colliders, body.x(), 0, untouched, time, time,
                            true);
  Depth deepest;
  for (const Contact& contact : contacts.contacts()) {
    const double depth = -contacts.distance(contact, body.x());
    if (depth > deepest.depth) deepest = {depth, contact.collider};
  }
  return deepest;
}

// "starts ", or of several "start "; later "appears at 2 s, ".
std::string starts(double time, bool several = false) {
  if (time == 0) return several ? "start " : "starts ";
  return (several ? "are, when one appears at " : "appears at ") + number_text(time) + " s, ";
}

void check_colliders(const Body& body, const std::vector<Collider>& colliders, double time) {
  const BodyModel& model = body.model();
  Depth deepest = depth_in_colliders(model.contact_points, body, colliders, time);
  const Depth inside = depth_in_colliders(element_centres(model.mesh), body, colliders, time);
  if (inside.depth > deepest.depth) deepest = inside;
  const double resolved = kResolvedDepth * model.height;
  if (deepest.depth <= resolved) return;
  throw Error(ErrorKind::geometry,
              "body '" + model.name + "' " + starts(time) + metres(deepest.depth) + " inside collider '" +
                  colliders[static_cast<std::size_t>(deepest.collider)].name() +
                  "'; contact resolves at most " + metres(resolved),
              "move it out of the collider", model.where);
}

// The middles of the elements and of the sides of the surface. Bodies of the same shape may lie in one
// another with no corner inside.
std::vector<Eigen::Vector3d> middles(const Body& body) {
  std::vector<Eigen::Vector3d> points;
  const ContactPoints centres = element_centres(body.model().mesh);
  for (int i = 0; i < centres.size(); ++i) points.push_back(centres.position(i, body.x()));
  for (const auto& side : body.surface().sides().rowwise()) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const int corner : side) sum += body.surface().point(corner);
    points.push_back(sum / static_cast<double>(side.size()));
  }
  return points;
}

// How deep the middles of a are inside the solid b, m.
double depth_inside(const Body& a, const Body& b) {
  if (b.model().surface.two_sided) return 0;
  const BoundingBox box = b.surface().box();
  double depth = 0;
  for (const Eigen::Vector3d& y : middles(a)) {
    if (!box.contains(y)) continue;
    if (const auto place = b.surface().nearest(y, box.diagonal().norm()))
      depth = std::max(depth, -place->distance);
  }
  return depth;
}

double volume(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
              const Eigen::Vector3d& d) {
  return (b - a).dot((c - a).cross(d - a));
}

bool crosses_triangle(const Eigen::Vector3d& p, const Eigen::Vector3d& q, const Eigen::Vector3d& a,
                      const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  if (volume(p, a, b, c) * volume(q, a, b, c) >= 0) return false;
  const double ab = volume(p, q, a, b), bc = volume(p, q, b, c), ca = volume(p, q, c, a);
  return (ab > 0 && bc > 0 && ca > 0) || (ab < 0 && bc < 0 && ca < 0);
}

// In the plane.
bool crosses_segment(const Eigen::Vector3d& p, const Eigen::Vector3d& q, const Eigen::Vector3d& a,
                     const Eigen::Vector3d& b) {
  const auto area = [](const Eigen::Vector3d& u, const Eigen::Vector3d& v, const Eigen::Vector3d& w) {
    return (v - u).cross(w - u).z();
  };
  return area(p, q, a) * area(p, q, b) < 0 && area(a, b, p) * area(a, b, q) < 0;
}

// Whether an edge of a goes through a side of b.
bool crosses(const SurfaceState& a, const SurfaceState& b) {
  const bool planar = a.surface().planar();
  bool found = false;
  BoxTree::visit_pairs(planar ? a.side_tree() : a.edge_tree(), b.side_tree(), 0, [&](int edge, int side) {
    const auto ends = a.surface().edges.row(edge);
    const auto corners = b.sides().row(side);
    const Eigen::Vector3d p = a.point(ends[0]), q = a.point(ends[1]);
    found = found ||
            (planar ? crosses_segment(p, q, b.point(corners[0]), b.point(corners[1]))
                    : crosses_triangle(p, q, b.point(corners[0]), b.point(corners[1]), b.point(corners[2])));
  });
  return found;
}

void check_pair(const Body& body_a, const Body& body_b, double time) {
  const BodyModel &a = body_a.model(), &b = body_b.model();
  const std::string names = "bodies '" + a.name + "' and '" + b.name + "' " + starts(time, true);
  double depth = std::max(depth_inside(body_a, body_b), depth_inside(body_b, body_a));
  const double touching = a.surface.radius + b.surface.radius;
  for (const SurfacePair& pair : near_pairs(body_a.surface(), body_b.surface(), touching))
    depth = std::max(depth, touching - pair.distance);
  const double resolved = kResolvedDepth * std::min(a.height, b.height);
  if (depth > resolved) {
    throw Error(ErrorKind::geometry,
                names + metres(depth) + " inside each other; contact resolves at most " + metres(resolved),
                "move one of them away by that much", b.where);
  }
  const bool thin = a.surface.two_sided || b.surface.two_sided;
  if (thin && (crosses(body_a.surface(), body_b.surface()) || crosses(body_b.surface(), body_a.surface()))) {
    throw Error(ErrorKind::geometry,
                names + "across each other, and what is thin has no side to be pushed to",
                "move one of them away", b.where);
  }
}

}  // namespace

void check_start(const std::vector<Member>& members, const std::vector<Collider>& colliders, long step,
                 double time) {
  const auto arrives = [&](int m) { return members[static_cast<std::size_t>(m)].body->spawn_step() == step; };
  std::vector<BoundingBox> boxes;
  for (std::size_t m = 0; m < members.size(); ++m) {
    Body& body = *members[m].body;
    if (arrives(static_cast<int>(m))) check_colliders(body, colliders, time);
    body.move_surface(body.x());
    const Eigen::Vector3d radius = Eigen::Vector3d::Constant(body.model().surface.radius);
    const BoundingBox box = body.surface().box();
    boxes.emplace_back(box.min() - radius, box.max() + radius);
  }
  for (const auto& [a, b] : near_boxes(boxes, 0)) {
    if (!arrives(a) && !arrives(b)) continue;
    const Body &body_a = *members[static_cast<std::size_t>(a)].body,
               &body_b = *members[static_cast<std::size_t>(b)].body;
    if (body_a.model().dimension() == body_b.model().dimension()) check_pair(body_a, body_b, time);
  }
}

}  // namespace vivify::sim
