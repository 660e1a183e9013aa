#include "pipeline/friction_settings.h"

#include <algorithm>
#include <map>

#include "common/text.h"

namespace vivify::pipeline {
namespace {

std::vector<std::string> names_of(const Value& scene, const std::string& list) {
  std::vector<std::string> names;
  for (const Value& item : scene[list].items()) names.push_back(item["name"].as_string());
  return names;
}

bool is_one_of(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

}  // namespace

Schema friction_schema() {
  Schema pair =
      object("Friction of two things.")
          .field("between", list("Names of two bodies, or of a body and a collider; the name of one body "
                                 "twice is its contact with itself.",
                                 string("A name."))
                                .items_at_least(2)
                                .required())
          .field("coefficient",
                 number("Coulomb coefficient; inf never slips.").at_least(0).infinite().required());
  return list("Friction of pairs, instead of the product of `friction` of both.", std::move(pair));
}

void check_friction(const Value& scene, std::vector<Error>& errors) {
  const std::vector<std::string> bodies = names_of(scene, "bodies"), colliders = names_of(scene, "colliders");
  std::vector<std::string> known = bodies;
  known.insert(known.end(), colliders.begin(), colliders.end());
  std::map<std::pair<std::string, std::string>, std::string> seen;
  const std::vector<Value>& pairs = scene["friction"].items();
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Value& between = pairs[i]["between"];
    const std::string item = "friction[" + std::to_string(i) + "]", path = item + ".between";
    const auto fail = [&](const Value& value, const std::string& message, const std::string& hint) {
      errors.emplace_back(ErrorKind::usage, path + message, hint, value.where());
    };
    if (between.items().size() != 2) {
      fail(between, " must have two names", "give each pair an entry of its own");
      continue;
    }
    bool found = true;
    for (const Value& name : between.items()) {
      if (is_one_of(known, name.as_string())) continue;
      const std::string nearest = nearest_word(name.as_string(), known);
      fail(name, ": there is no body or collider '" + name.as_string() + "'",
           nearest.empty() ? "known: " + join_words(known) : "did you mean '" + nearest + "'?");
      found = false;
    }
    if (!found) continue;
    const std::string &a = between.items()[0].as_string(), &b = between.items()[1].as_string();
    if (!is_one_of(bodies, a) && !is_one_of(bodies, b)) {
      fail(between, ": '" + a + "' and '" + b + "' are colliders, which never touch each other",
           "name a body");
      continue;
    }
    const auto [entry, fresh] = seen.emplace(std::minmax(a, b), item);
    if (!fresh) fail(between, ": the pair is in " + entry->second + " already", "remove one of them");
  }
}

sim::FrictionByName friction_of(const Value& scene, const std::string& body) {
  sim::FrictionByName friction;
  for (const Value& pair : scene["friction"].items()) {
    const std::string &a = pair["between"].items()[0].as_string(),
                      &b = pair["between"].items()[1].as_string();
    const double coefficient = pair["coefficient"].as_number();
    if (a == body) friction[b] = coefficient;
    if (b == body) friction[a] = coefficient;
  }
  return friction;
}

}  // namespace vivify::pipeline
