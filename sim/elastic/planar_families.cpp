// The families of plane bodies: rods and flat solids.
#include "sim/elastic/family_of.h"
#include "sim/elastic/measures/area.h"
#include "sim/elastic/measures/edge_length.h"
#include "sim/elastic/measures/green_strain.h"
#include "sim/elastic/measures/turning_angle.h"

namespace vivify::sim {

std::unique_ptr<MeasureFamily> make_edge_length_2d(Kernels kernels) {
  return quadratic_family<EdgeLength<2>>("edge_length_2d", kernels);
}
std::unique_ptr<MeasureFamily> make_area(Kernels kernels) { return quadratic_family<Area>("area", kernels); }
std::unique_ptr<MeasureFamily> make_green_strain_2d(Kernels kernels) {
  return quadratic_family<GreenStrain<2>>("green_strain_2d", kernels);
}
std::unique_ptr<MeasureFamily> make_printed_green_strain(Kernels kernels) {
  return family_of<GreenStrain<2>>("printed_green_strain", kernels, make_printed_green_law());
}
std::unique_ptr<MeasureFamily> make_turning_angle(Kernels kernels) {
  return quadratic_family<TurningAngle>("turning_angle", kernels);
}

}  // namespace vivify::sim
