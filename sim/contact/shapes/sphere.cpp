// A ball.
#include "sim/contact/shapes/shapes.h"

namespace vivify::sim {
namespace {

class Sphere final : public ColliderShape {
 public:
  Sphere(const Eigen::Vector3d& centre, double radius) : centre_(centre), radius_(radius) {}

  SurfacePoint nearest(const Eigen::Vector3d& point) const override {
    const double length = (point - centre_).norm();
    const Eigen::Vector3d normal =
        length > 0 ? Eigen::Vector3d((point - centre_) / length) : Eigen::Vector3d::UnitY();
    return {centre_ + radius_ * normal, normal, length - radius_};
  }

  TriangleMesh drawing() const override { return round_surface(centre_, centre_, radius_); }

 private:
  Eigen::Vector3d centre_;
  double radius_;
};

}  // namespace

Schema sphere_schema() {
  return object("A ball around the origin of the object.")
      .field("radius", number("Its radius.").unit("m").above(0).required());
}

std::unique_ptr<ColliderShape> make_sphere(const Value& settings, const ShapePlace& place) {
  return std::make_unique<Sphere>(place.point(Eigen::Vector3d::Zero()),
                                  place.scale * settings["radius"].as_number());
}

}  // namespace vivify::sim
