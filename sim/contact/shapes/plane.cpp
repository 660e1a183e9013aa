// A plane without end; all that lies below it is inside.
#include "sim/contact/shapes/shapes.h"

namespace vivify::sim {
namespace {

class Plane final : public ColliderShape {
 public:
  Plane(const Eigen::Vector3d& origin, const Eigen::Vector3d& normal, double size)
      : origin_(origin), normal_(normal), size_(size) {}

  SurfacePoint nearest(const Eigen::Vector3d& point) const override {
    const double distance = normal_.dot(point - origin_);
    return {point - distance * normal_, normal_, distance};
  }

  // Texture coordinates are metres.
  TriangleMesh drawing() const override {
    const Eigen::Quaterniond tilt = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitY(), normal_);
    TriangleMesh square{Points(4, 3), Triangles(2, 3), TexCoords(4, 2), {}, {}};
    square.UV << -1, -1, -1, 1, 1, 1, 1, -1;
    square.UV *= size_ / 2;
    for (int i = 0; i < 4; ++i) {
      square.V.row(i) = (origin_ + tilt * Eigen::Vector3d(square.UV(i, 0), 0, square.UV(i, 1))).transpose();
    }
    square.F << 0, 1, 2, 0, 2, 3;
    return square;
  }

 private:
  Eigen::Vector3d origin_, normal_;
  double size_;
};

}  // namespace

Schema plane_schema() {
  return object("A plane without end through the origin of the object; what lies below it is inside.")
      .field("normal", vector("The direction that is up from it, of any length.", 3).initially({0, 1, 0}))
      .field("size", number("Edge length of the square that is drawn.").unit("m").above(0).initially(20));
}

std::unique_ptr<ColliderShape> make_plane(const Value& settings, const ShapePlace& place) {
  const Eigen::Vector3d normal = settings["normal"].as_vector3();
  const double length = normal.stableNorm();
  if (!(length > 0)) {
    throw Error(ErrorKind::usage, "the normal of a plane has no length", "", settings["normal"].where());
  }
  return std::make_unique<Plane>(place.point(Eigen::Vector3d::Zero()),
                                 (place.pose.linear() * (normal / length)).normalized(),
                                 place.scale * settings["size"].as_number());
}

}  // namespace vivify::sim
