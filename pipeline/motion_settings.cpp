#include "pipeline/motion_settings.h"

#include <vector>

namespace vivify::pipeline {

Schema add_motion(Schema object_schema, const std::string& what, const std::string& place,
                  const Schema& place_schema, const std::string& turns) {
  Schema key = object("Where the " + what + " is at a time.")
                   .field("t_s", number("Time; 0 is the first frame.").unit("s").required())
                   .field(place, place_schema)
                   .field("rotation_deg", vector(turns, 3).unit("deg").initially({0, 0, 0}));
  return std::move(object_schema)
      .field(
          "motion",
          list("Keyframes of its motion, which goes smoothly through them without overshooting. Before the "
               "first and after the last it rests.",
               std::move(key)))
      .field(
          "repeat_motion",
          boolean("Whether the motion is repeated, with the time from the first to the last keyframe as its "
                  "period.")
              .initially(false));
}

bool moves(const Value& item) { return !item["motion"].items().empty(); }

void check_motion(const Value& item, const std::string& where, std::vector<Error>& errors) {
  if (!item["repeat_motion"].as_bool() || moves(item)) return;
  errors.emplace_back(ErrorKind::usage, where + ".repeat_motion does not fit: there is no motion",
                      "give it keyframes, `motion`", item["repeat_motion"].where());
}

sim::RigidPath motion_path(const Value& item, const std::string& where, const std::string& place,
                           const Eigen::Vector3d& otherwise) {
  std::vector<sim::RigidKey> keys;
  for (const Value& key : item["motion"].items()) {
    keys.push_back({key["t_s"].as_number(), key.has(place) ? key[place].as_vector3() : otherwise,
                    key["rotation_deg"].as_vector3(), key.where()});
  }
  return {std::move(keys), item["repeat_motion"].as_bool(), where + ".motion"};
}

}  // namespace vivify::pipeline
