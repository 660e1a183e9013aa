#include "pipeline/region_settings.h"

namespace vivify::pipeline {

Schema region_schema() {
  return object("The part of the body that it holds: the vertices in a box.")
      .field("min", vector("Lower corner, in shares of the bounding box of the body at rest.", 3).required())
      .field("max", vector("Upper corner, in shares of the bounding box of the body at rest.", 3).required());
}

Schema about_schema() {
  return vector(
      "Point that stays in place but for `move`, in shares of the bounding box of the body at rest. Left "
      "out: "
      "the middle of the part.",
      3);
}

void check_region(const Value& handle, const std::string& name, std::vector<Error>& errors) {
  const Value& region = handle["region"];
  if ((region["min"].as_vector3().array() <= region["max"].as_vector3().array()).all()) return;
  errors.emplace_back(ErrorKind::usage, name + ".region is empty: min is above max", "", region.where());
}

sim::Region make_region(const Value& handle, const std::string& name) {
  return sim::region_between(handle["region"], name, handle.where());
}

}  // namespace vivify::pipeline
