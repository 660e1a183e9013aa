// The families of bodies in space: shells and solids.
#include "sim/elastic/family_of.h"
#include "sim/elastic/measures/dihedral_angle.h"
#include "sim/elastic/measures/edge_length.h"
#include "sim/elastic/measures/green_strain.h"
#include "sim/elastic/measures/volume.h"

namespace vivify::sim {

std::unique_ptr<MeasureFamily> make_edge_length_3d(Kernels kernels) {
  return quadratic_family<EdgeLength<3>>("edge_length_3d", kernels);
}
std::unique_ptr<MeasureFamily> make_volume(Kernels kernels) {
  return quadratic_family<Volume>("volume", kernels);
}
std::unique_ptr<MeasureFamily> make_green_strain_3d(Kernels kernels) {
  return quadratic_family<GreenStrain<3>>("green_strain_3d", kernels);
}
std::unique_ptr<MeasureFamily> make_dihedral_angle(Kernels kernels) {
  return quadratic_family<DihedralAngle>("dihedral_angle", kernels);
}

}  // namespace vivify::sim
