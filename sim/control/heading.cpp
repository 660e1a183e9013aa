#include "sim/control/heading.h"

#include <cmath>
#include <numbers>

namespace vivify::sim {

Schema heading_schema() { return number("Direction of travel: 0 is +z, 90 is +x.").unit("°").initially(0); }

Eigen::Vector3d heading_of(const ControlledBody& body, const Value& settings) {
  if (!(body.gravity > 0)) {
    throw Error(ErrorKind::usage,
                "a " + settings["type"].as_string() + " needs gravity that points down (-y)",
                "change gravity or the controller", settings.where());
  }
  const double heading = settings["heading_deg"].as_number() * std::numbers::pi / 180;
  if (body.dimension() == 3) return {std::sin(heading), 0, std::cos(heading)};
  if (std::abs(std::sin(heading)) < 0.99) {
    throw Error(ErrorKind::usage,
                "a body of the plane travels along x: controller.heading_deg must be 90 or -90",
                "90 is to the right (+x)", settings["heading_deg"].where());
  }
  return std::copysign(1.0, std::sin(heading)) * Eigen::Vector3d::UnitX();
}

}  // namespace vivify::sim
