#include "pipeline/push_settings.h"

#include "common/text.h"

namespace vivify::pipeline {

Schema push_schema() {
  return object("A force on the body as a whole, from outside: a shove, a gust, a blow.")
      .field("at_s", number("When it begins.").unit("s").at_least(0).required())
      .field("for_s", number("How long it lasts; the force is constant.").unit("s").above(0).initially(0.1))
      .field("impulse",
             vector("Force times duration: it changes the velocity by this over the body's mass.", 3)
                 .unit("N s")
                 .required());
}

void check_pushes(const Value& body, const std::string& where, bool planar, std::vector<Error>& errors) {
  const std::vector<Value>& pushes = body["pushes"].items();
  const double spawn = body["spawn_s"].as_number();
  for (std::size_t i = 0; i < pushes.size(); ++i) {
    const std::string name = where + ".pushes[" + std::to_string(i) + "].";
    const Value &begin = pushes[i]["at_s"], &impulse = pushes[i]["impulse"];
    if (begin.as_number() < spawn) {
      errors.emplace_back(ErrorKind::usage,
                          name + "at_s = " + number_text(begin.as_number()) +
                              " s is before the body appears, at " + number_text(spawn) + " s",
                          "push later", begin.where());
    }
    if (planar && impulse.as_vector3().z() != 0) {
      errors.emplace_back(ErrorKind::usage, name + "impulse leads out of the plane, where the body cannot go",
                          "its third component must be 0", impulse.where());
    }
  }
}

std::vector<sim::Push> make_pushes(const Value& body) {
  std::vector<sim::Push> pushes;
  for (const Value& push : body["pushes"].items())
    pushes.push_back({push["at_s"].as_number(), push["for_s"].as_number(), push["impulse"].as_vector3()});
  return pushes;
}

}  // namespace vivify::pipeline
