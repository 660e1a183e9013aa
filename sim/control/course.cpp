#include "sim/control/course.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace vivify::sim {
namespace {

constexpr double kTolerance = 0.15;      // of the body's width: how near to a place is there
constexpr double kAlongPlane = 0.99;     // least share of a heading that lies in the plane
constexpr double kLeastDistance = 1e-9;  // of the width: no direction can be told below

double width_of(const ControlledBody& body) {
  const int d = body.dimension();
  const Eigen::Map<const Eigen::MatrixXd> V(body.rest.data(), d, body.mass.size());
  const Eigen::VectorXd size = V.rowwise().maxCoeff() - V.rowwise().minCoeff();
  return d == 2 ? size[0] : std::max(size[0], size[2]);
}

constexpr std::array kCourses = {"heading_deg", "to", "path", "chase", "flee"};

// The key of the course that the settings give; empty for none.
std::string course_in(const Value& settings) {
  for (const char* key : kCourses) {
    if (settings.has(key)) return key;
  }
  return {};
}

Eigen::Vector3d direction_of(const Value& heading) {
  const double angle = heading.as_number() * std::numbers::pi / 180;
  return {std::sin(angle), 0, std::cos(angle)};
}

}  // namespace

Schema add_course(Schema controller) {
  return std::move(controller)
      .field("heading_deg",
             number("Direction of travel, without end: 0 is +z, 90 is +x. Without a course: 0, or "
                    "90 for a body of the plane.")
                 .unit("°"))
      .field("to", vector("Place on the ground to travel to, however high that is.", 3).unit("m"))
      .field("path",
             list("Places to travel to, one after the other.", vector("A place.", 3).unit("m").required())
                 .items_at_least(1))
      .field("chase", string("Name of a body to follow."))
      .field("flee", string("Name of a body to run from."));
}

void check_course(const Value& settings, const std::string& where, bool planar, std::vector<Error>& errors) {
  const std::string given = course_in(settings);
  for (const std::string key : kCourses) {
    if (!settings.has(key) || key == given) continue;
    errors.emplace_back(ErrorKind::usage, where + "." + given + " and ." + key + " are two courses",
                        "give one of them", settings[key].where());
  }
  if (!planar || given != "heading_deg") return;
  const Value& heading = settings[given];
  if (std::abs(direction_of(heading).x()) > kAlongPlane) return;
  errors.emplace_back(ErrorKind::usage,
                      where + ".heading_deg leads out of the plane, where the body cannot go",
                      "90 is to the right (+x), -90 to the left", heading.where());
}

Course::Course(const ControlledBody& body, const Value& settings)
    : planar_(body.dimension() == 2), tolerance_(kTolerance * width_of(body)) {
  if (!(body.gravity > 0)) {
    throw Error(ErrorKind::usage, "to travel needs gravity that points down (-y)",
                "change gravity or the controller", settings.where());
  }
  std::vector<Error> errors;
  check_course(settings, "the controller", planar_, errors);
  if (!errors.empty()) throw errors.front();
  const std::string given = course_in(settings);
  forward_ = planar_ ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitZ();
  if (given == "heading_deg") forward_ = level(direction_of(settings[given])).normalized();
  if (given == "to") path_ = {settings[given].as_vector3()};
  if (given == "path") {
    for (const Value& place : settings[given].items()) path_.push_back(place.as_vector3());
  }
  if (given == "chase" || given == "flee") {
    other_ = settings[given].as_string();
    towards_other_ = given == "chase" ? 1 : -1;
  }
}

// Without its vertical part, and in the plane without what leads out of it.
Eigen::Vector3d Course::level(Eigen::Vector3d v) const {
  v.y() = 0;
  if (planar_) v.z() = 0;
  return v;
}

Course::Way Course::way(const Eigen::Vector3d& centre, double ahead, const Others& others) {
  if (!begun_) {
    begun_ = true;
    from_ = centre;
  }
  if (!path_.empty()) return along_path(centre, ahead);
  constexpr double kEndless = std::numeric_limits<double>::infinity();
  if (other_.empty())
    return {forward_, Eigen::Vector3d::UnitY().cross(forward_).dot(centre - from_), kEndless};
  for (const OtherBody& other : others) {
    const Eigen::Vector3d towards = towards_other_ * level(other.centre - centre);
    if (other.name == other_ && towards.norm() > kLeastDistance * tolerance_) forward_ = towards.normalized();
  }
  return {forward_, 0, kEndless};
}

// Pure pursuit (Coulter 1992): towards the point of the path that lies `ahead` m further than the nearest
// one. Where the path turns back it is followed to its corner: beyond, that point may be where the body is.
Course::Way Course::along_path(const Eigen::Vector3d& centre, double ahead) {
  const int last = static_cast<int>(path_.size()) - 1;
  const auto progress = [&] {  // along the present leg, m
    const Eigen::Vector3d leg = level(path_[leg_] - from_);
    return leg.norm() > tolerance_ ? level(centre - from_).dot(leg.normalized()) : leg.norm();
  };
  while (leg_ < last && progress() >= level(path_[leg_] - from_).norm()) from_ = path_[leg_++];

  Eigen::Vector3d start = from_, aim = path_[leg_];
  // To a single place there is no line to keep to.
  double reach = last == 0 ? std::numeric_limits<double>::infinity() : progress() + ahead;
  for (int leg = leg_; leg <= last; start = path_[leg++]) {
    const Eigen::Vector3d whole = level(path_[leg] - start);
    const bool turns_back = leg < last && whole.dot(level(path_[leg + 1] - path_[leg])) < 0;
    const double farthest = turns_back ? std::max(reach, whole.norm()) : whole.norm();
    aim = start + whole.normalized() * std::clamp(reach, 0.0, farthest);
    if (turns_back || reach <= whole.norm()) break;
    reach -= whole.norm();
  }
  const Eigen::Vector3d towards = level(aim - centre);
  if (towards.norm() > kLeastDistance * tolerance_) forward_ = towards.normalized();
  double left = level(path_[leg_] - centre).norm();
  for (int leg = leg_ + 1; leg <= last; ++leg) left += level(path_[leg] - path_[leg - 1]).norm();
  return {forward_, 0, left};
}

Eigen::VectorXd Course::state() const {
  Eigen::VectorXd state(kStateSize);
  state << begun_, from_, leg_, forward_;
  return state;
}

void Course::restore(const Eigen::VectorXd& state) {
  begun_ = state[0] != 0;
  from_ = state.segment<3>(1);
  leg_ = static_cast<int>(state[4]);
  forward_ = state.segment<3>(5);
}

}  // namespace vivify::sim
