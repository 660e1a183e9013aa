// All points within a radius of a segment: a rod with round ends.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/contact/shapes/shapes.h"

namespace vivify::sim {
namespace {

constexpr int kMeridians = 64;     // of the drawn surface
constexpr int kRingsOfAnEnd = 16;  // from the pole of a round end to its rim

class Capsule final : public ColliderShape {
 public:
  Capsule(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double radius)
      : a_(a), b_(b), radius_(radius) {}

  SurfacePoint nearest(const Eigen::Vector3d& point) const override {
    const Eigen::Vector3d along = b_ - a_;
    const double length2 = along.squaredNorm();
    const double share = length2 > 0 ? std::clamp(along.dot(point - a_) / length2, 0.0, 1.0) : 0.0;
    const Eigen::Vector3d core = a_ + share * along;
    const double length = (point - core).norm();
    const Eigen::Vector3d normal =
        length > 0 ? Eigen::Vector3d((point - core) / length) : Eigen::Vector3d(along.unitOrthogonal());
    return {core + radius_ * normal, normal, length - radius_};
  }

  TriangleMesh drawing() const override { return round_surface(a_, b_, radius_); }

 private:
  Eigen::Vector3d a_, b_;
  double radius_;
};

}  // namespace

TriangleMesh round_surface(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double radius) {
  const Eigen::Quaterniond tilt = a == b
                                      ? Eigen::Quaterniond::Identity()
                                      : Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitY(), b - a);
  // Rings from the pole at a to the pole at b; the two rims are one ring for a sphere.
  const int rings = a == b ? 2 * kRingsOfAnEnd + 1 : 2 * kRingsOfAnEnd + 2;
  TriangleMesh mesh{Points(rings * kMeridians, 3), Triangles(2 * (rings - 2) * kMeridians, 3), {}, {}, {}};
  int face = 0;
  for (int ring = 0; ring < rings; ++ring) {
    const bool beyond_the_middle = ring > kRingsOfAnEnd;
    const int quarter = beyond_the_middle ? rings - 1 - ring : ring;  // 0 at a pole
    const double latitude = std::numbers::pi / 2 * (1 - static_cast<double>(quarter) / kRingsOfAnEnd);
    const double height = (beyond_the_middle ? 1 : -1) * radius * std::sin(latitude);
    const double width = quarter == 0 ? 0 : radius * std::cos(latitude);
    for (int meridian = 0; meridian < kMeridians; ++meridian) {
      const double longitude = 2 * std::numbers::pi * meridian / kMeridians;
      const Eigen::Vector3d offset(width * std::sin(longitude), height, width * std::cos(longitude));
      mesh.V.row(ring * kMeridians + meridian) = ((beyond_the_middle ? b : a) + tilt * offset).transpose();
      const int here = ring * kMeridians + meridian, beside = ring * kMeridians + (meridian + 1) % kMeridians;
      if (ring + 1 < rings && ring > 0) mesh.F.row(face++) << here, beside, beside + kMeridians;
      if (ring + 2 < rings) mesh.F.row(face++) << here, beside + kMeridians, here + kMeridians;
    }
  }
  return mesh;
}

Schema capsule_schema() {
  return object("All points within a radius of a segment: a rod with round ends.")
      .field("from", vector("One end of the segment.", 3).unit("m").required())
      .field("to", vector("The other end.", 3).unit("m").required())
      .field("radius", number("Its radius.").unit("m").above(0).required());
}

std::unique_ptr<ColliderShape> make_capsule(const Value& settings, const ShapePlace& place) {
  return std::make_unique<Capsule>(place.point(settings["from"].as_vector3()),
                                   place.point(settings["to"].as_vector3()),
                                   place.scale * settings["radius"].as_number());
}

}  // namespace vivify::sim
