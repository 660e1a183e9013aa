#include "sim/elastic/materials.h"

#include <cmath>

#include "common/error.h"

namespace vivify::sim {
namespace {

double at(const Value& material, const char* key) { return material[key].as_number(); }

}  // namespace

Stiffness plane_solid_stiffness(const Value& material) {
  const double young = at(material, "young"), poisson = at(material, "poisson");
  if (young == 0) return {at(material, "stiffness"), at(material, "volume_stiffness"), 0};
  return {young / (1 + poisson), young * poisson / (1 - poisson * poisson), 0};
}

Stiffness stvk_stiffness(const Value& material) {
  const double young = at(material, "young"), poisson = at(material, "poisson");
  if (young == 0) return {at(material, "stiffness"), at(material, "volume_stiffness"), 0};
  return {young / (1 + poisson), young * poisson / ((1 + poisson) * (1 - 2 * poisson)), 0};
}

Stiffness simplified_solid_stiffness(const Value& material) {
  const double young = at(material, "young"), poisson = at(material, "poisson");
  if (young == 0) return {at(material, "stiffness"), at(material, "volume_stiffness"), 0};
  if (poisson < 0.25) {
    throw Error(ErrorKind::usage,
                "model.poisson must be >= 0.25 for solid3d: its edges alone have that ratio",
                "use solid3d_stvk for smaller ratios", material["poisson"].where());
  }
  const double mu = young / (2 * (1 + poisson)),
               lambda = young * poisson / ((1 + poisson) * (1 - 2 * poisson));
  return {15 * mu / 4, lambda - mu, 0};
}

Stiffness rod_stiffness(const Value& material) {
  const double young = at(material, "young"), t = at(material, "thickness");
  if (young == 0) return {at(material, "stiffness"), 0, at(material, "bending_stiffness")};
  return {young * t / 4, 0, young * std::pow(t, 3) / 12};
}

Stiffness shell_stiffness(const Value& material) {
  const double young = at(material, "young"), t = at(material, "thickness");
  if (young == 0) return {at(material, "stiffness"), 0, at(material, "bending_stiffness")};
  return {0.75 * young * t, 0, young * std::pow(t, 3) / 32};
}

namespace {

Schema with_young(Schema material, const char* young_unit) {
  return std::move(material).field(
      "young", number("Young's modulus; when it is above 0 the stiffnesses follow from it.")
                   .unit(young_unit)
                   .at_least(0)
                   .initially(0.0));
}

}  // namespace

Schema with_poisson(Schema material, const char* young_unit) {
  return with_young(std::move(material), young_unit)
      .field("poisson", number("Poisson's ratio, beside `young`.").at_least(0).below(0.5).initially(0.35));
}

Schema with_thickness(Schema material, const char* young_unit) {
  return with_young(std::move(material), young_unit)
      .field("thickness", number("Thickness: how it is drawn, and how it bends beside `young`.")
                              .unit("m")
                              .above(0)
                              .initially(0.02));
}

}  // namespace vivify::sim
