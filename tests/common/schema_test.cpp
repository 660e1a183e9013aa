#include "common/schema.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>

#include "common/text.h"
#include "tests/common/sample_schema.h"

namespace vivify {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing_support::sample_scene;
using testing_support::sample_schema;

struct Outcome {
  Value value;
  std::vector<std::string> errors;
};

Outcome read(const std::string& text, const std::vector<std::string>& overrides = {}) {
  std::vector<Error> errors;
  ConfigNode root = parse_yaml(text, "s.yaml", errors);
  for (const std::string& o : overrides) apply_override(root, o);
  Outcome outcome;
  outcome.value = resolve(sample_schema(), root, errors);
  for (const Error& error : errors) {
    EXPECT_EQ(error.kind(), ErrorKind::usage);
    outcome.errors.push_back(error.full_text());
  }
  return outcome;
}

const std::string kSmall =
    "version: 1\n"
    "bodies:\n"
    "  - {name: cup, mesh: c.obj, model: {type: solid3d, stiffness: 5}}\n";

TEST(Resolve, FillsInDefaultsInTheOrderOfTheSchema) {
  const auto [value, errors] = read(kSmall);
  EXPECT_TRUE(errors.empty());
  EXPECT_EQ(value["frames"]["fps"].as_integer(), 24);
  EXPECT_EQ(value["frames"]["duration_s"].as_number(), 4);
  EXPECT_FALSE(value["frames"]["loop"].as_bool());
  EXPECT_EQ(value["gravity"].as_vector3().y(), -9.81);
  EXPECT_EQ(value["backend"].as_string(), "tetgen");
  EXPECT_FALSE(value.has("cutoff"));
  const Value& body = value["bodies"].items().at(0);
  EXPECT_EQ(body["model"]["density"].as_number(), 1000);
  EXPECT_EQ(body["rest_space"]["type"].as_string(), "cage");
  EXPECT_EQ(body["rest_space"]["vertices"].as_integer(), 8);
  EXPECT_FALSE(body.has("outline"));  // a list with items, and left out
  EXPECT_TRUE(body["looks"].entries().empty());
  EXPECT_EQ(value.entries()[0].first, "version");
  EXPECT_EQ(value.entries().back().first, "cutoff");
  EXPECT_EQ(body["model"]["stiffness"].where().text(), "s.yaml:3:64");
}

TEST(Resolve, ReadsWhatIsGiven) {
  const auto [value, errors] = read(sample_scene());
  EXPECT_TRUE(errors.empty()) << errors.front();
  const Value& cup = value["bodies"].items().at(0);
  EXPECT_EQ(value["frames"]["duration_s"].as_number(), 2.5);
  EXPECT_TRUE(std::isinf(cup["friction"].as_number()));
  EXPECT_EQ(cup["model"]["stiffness"].as_number(), 1e5);
  EXPECT_EQ(cup["looks"]["eyes"].as_string(), "black");
  EXPECT_EQ(value["title"].as_string(), "a # b: 'c' | \"d\" – é");
  EXPECT_EQ(value["bodies"].items().at(1)["rest_space"].entries().size(), 1U);
}

TEST(Resolve, ResolvedYamlReadsBackToTheSameBytes) {
  for (const std::string& text : {kSmall, sample_scene()}) {
    const std::string once = read(text).value.yaml();
    const auto [value, errors] = read(once);
    EXPECT_TRUE(errors.empty()) << errors.front() << "\n" << once;
    EXPECT_EQ(value.yaml(), once);
  }
}

TEST(Resolve, ReadsOneOfSeveralByItsKey) {
  const auto with = [](const std::string& steps) {
    return "version: 1\nbodies:\n"
           "  - {name: cup, mesh: c.obj, model: {type: solid3d, stiffness: 5}, steps: " +
           steps + "}\n";
  };
  const auto [value, errors] = read(with("[{walk: {speed: 2}}, {wait: {for_s: 3}}, {walk: }]"));
  EXPECT_TRUE(errors.empty()) << errors.front();
  const std::vector<Value>& steps = value["bodies"].items().at(0)["steps"].items();
  ASSERT_EQ(steps.size(), 3U);
  EXPECT_EQ(steps[0].entries().at(0).first, "walk");
  EXPECT_EQ(steps[0]["walk"]["speed"].as_number(), 2);
  EXPECT_EQ(steps[1]["wait"]["for_s"].as_number(), 3);
  EXPECT_EQ(steps[2]["walk"]["speed"].as_number(), 1);
  EXPECT_EQ(read(value.yaml()).value.yaml(), value.yaml());

  EXPECT_THAT(
      read(with("[{wlak: {}}]")).errors,
      ElementsAre("s.yaml:3:77: error: unknown key 'wlak' in bodies[0].steps[0] (did you mean walk?)"));
  EXPECT_THAT(
      read(with("[{walk: {}, speed: 3}]")).errors,
      ElementsAre(AllOf(HasSubstr("must be one of walk or wait"), HasSubstr("indent the settings of walk"))));
  EXPECT_THAT(read(with("[{walk: {}, wait: {}}]")).errors,
              ElementsAre(HasSubstr("(give wait after walk, as an item of its own)")));
  EXPECT_THAT(read(with("[walk]")).errors, ElementsAre(HasSubstr("found 'walk'")));
  EXPECT_THAT(read(with("[{wait: {}}]")).errors, ElementsAre(HasSubstr("steps[0].wait.for_s is missing")));
}

TEST(Resolve, NamesEveryProblemOfAFileInOneGo) {
  const auto [value, errors] = read(
      "version: 2\n"
      "frames: {fps: 1.5, duration_s: yes, loop: yes}\n"
      "gravity: [0, -9.81]\n"
      "bodies:\n"
      "  - name: cup\n"
      "    mesh: c.obj\n"
      "    heading_dge: 5\n"
      "    model: {type: solid3d, density: -3}\n"
      "  - name: cup\n"
      "    mesh: [a]\n"
      "    model: {type: soft}\n"
      "    friction: .nan\n"
      "    heading_deg: inf\n"
      "    rest_space: {type: full, vertices: 5}\n"
      "backend: tegten\n"
      "cutoff: '5'\n");
  EXPECT_THAT(
      errors,
      ElementsAre(
          "s.yaml:1:10: error: version = 2 must be >= 1 and <= 1",
          "s.yaml:2:15: error: frames.fps must be a whole number, found '1.5'",
          "s.yaml:2:32: error: frames.duration_s must be a number, found 'yes'",
          "s.yaml:2:43: error: frames.loop must be true or false, found 'yes'",
          "s.yaml:3:10: error: gravity must be a list of 3 numbers, found a list of 2",
          "s.yaml:7:5: error: unknown key 'heading_dge' in bodies[0] (did you mean heading_deg?)",
          "s.yaml:8:12: error: bodies[0].model.stiffness is missing (it must be a number)",
          "s.yaml:8:37: error: bodies[0].model.density = -3 kg/m³ must be > 0",
          "s.yaml:9:11: error: bodies[1].name = cup is the name of bodies[0] already",
          "s.yaml:10:11: error: bodies[1].mesh must be the path of a file, found a list of 1",
          "s.yaml:11:19: error: bodies[1].model.type = soft must be solid3d or rigid",
          "s.yaml:12:15: error: bodies[1].friction = .nan must be a number",
          "s.yaml:13:18: error: bodies[1].heading_deg = inf must be finite",
          "s.yaml:14:30: error: unknown key 'vertices' in bodies[1].rest_space (it is a key of type: cage)",
          "s.yaml:15:10: error: backend = tegten must be tetgen or mesh3 (did you mean tetgen?)",
          "s.yaml:16:9: error: cutoff must be a number, found the quoted text '5' (remove the quotes)"));
}

TEST(Resolve, MissingKeysAreReportedAtTheEnclosingMap) {
  EXPECT_THAT(
      read("bodies:\n  - {name: a}\n").errors,
      ElementsAre("s.yaml:1:1: error: version is missing (it must be a whole number)",
                  "s.yaml:2:5: error: bodies[0].mesh is missing (it must be the path of a file)",
                  "s.yaml:2:5: error: bodies[0].model is missing (it must be a map of keys and values)"));
  EXPECT_THAT(read("").errors, ElementsAre(HasSubstr("s.yaml:1:1: error: version is missing"),
                                           HasSubstr("s.yaml:1:1: error: bodies is missing")));
  EXPECT_THAT(read("version: 1\nbodies: []\n").errors,
              ElementsAre("s.yaml:2:9: error: bodies must have at least 1 item, found 0"));
}

TEST(Resolve, RejectsWrongKindsEverywhere) {
  EXPECT_THAT(
      read("[1, 2]\n").errors,
      ElementsAre("s.yaml:1:1: error: the scene must be a map of keys and values, found a list of 2"));
  EXPECT_THAT(read("5\n").errors, ElementsAre(HasSubstr("s.yaml:1:1: error: the scene must be a map")));
  for (const char* flag : {"yes", "no", "on", "off", "True", "1", "'true'"}) {
    EXPECT_THAT(read(kSmall + "frames: {loop: " + flag + "}\n").errors,
                ElementsAre(HasSubstr("s.yaml:4:16: error: frames.loop must be true or false")));
  }
  for (const char* number :
       {"abc", "1e999", "0x10", "1_000", "1,5", "--5", "+-5", "5 m", "{}", "[]", "infinity", "1e", "''"}) {
    EXPECT_EQ(read(kSmall + "cutoff: " + number + "\n").errors.size(), 1U) << number;
  }
  for (const char* number : {"5", "+5", "5.", ".5", "5e3", "5E+3", "1e-300"}) {
    EXPECT_TRUE(read(kSmall + "cutoff: " + number + "\n").errors.empty()) << number;
  }
  for (const char* number : {"1.5", "inf", "1e30", "'5'", "true"}) {
    EXPECT_EQ(read(kSmall + "frames: {fps: " + number + "}\n").errors.size(), 1U) << number;
  }
  EXPECT_EQ(read(kSmall + "frames: {fps: 1e2}\n").value["frames"]["fps"].as_integer(), 100);
}

TEST(Resolve, OverridesAreCheckedToo) {
  EXPECT_THAT(read(kSmall, {"bodies.cup.model.density=-1"}).errors,
              ElementsAre("--set: error: bodies[0].model.density = -1 kg/m³ must be > 0"));
  EXPECT_THAT(read(kSmall, {"frmes.fps=3"}).errors,
              ElementsAre(HasSubstr("--set: error: unknown key 'frmes'")));
}

TEST(Resolve, AParseErrorIsNotFollowedByNonsense) {
  EXPECT_EQ(read("version: [1\n").errors.size(), 1U);
  EXPECT_EQ(read(kSmall + "version: 1\n").errors.size(), 1U);  // the rest is still checked:
  EXPECT_EQ(read(kSmall + "version: 1\ncutoff: -1\n").errors.size(), 2U);
}

TEST(Resolve, ErrorsOfAFileBeforeStayWhereTheyAre) {
  std::vector<Error> errors;
  for (const auto& [file, text] :
       {std::pair("b.yaml", "version: [1\n"), std::pair("a.yaml", ""), std::pair("c.yaml", "5\n")}) {
    const ConfigNode root = parse_yaml(text, file, errors);
    resolve(sample_schema(), root, errors);
  }
  std::vector<std::string> files;
  for (const Error& error : errors) files.push_back(error.where().file);
  EXPECT_THAT(files, ElementsAre("b.yaml", "a.yaml", "a.yaml", "c.yaml"));
}

// Calls visit(field, path as for --set) for every number of the schema that the small scene reaches.
void for_each_number(const Schema& schema, const std::string& path,
                     const std::function<void(const Schema&, const std::string&)>& visit) {
  const auto walk = [&](const auto& fields) {
    for (const auto& [key, field] : fields)
      for_each_number(field, path.empty() ? key : path + "." + key, visit);
  };
  switch (schema.kind) {
    case Schema::Kind::integer:
    case Schema::Kind::number:
      visit(schema, path);
      return;
    case Schema::Kind::list:
      for_each_number(*schema.item, path + ".0", visit);
      return;
    case Schema::Kind::object:
      walk(schema.fields);
      return;
    case Schema::Kind::variant:
      for (const auto& [name, option] : schema.options) {
        if (name == "solid3d" || name == "cage") walk(option.fields);
      }
      return;
    default:
      return;
  }
}

TEST(Resolve, BoundsHoldOnBothSidesOfEveryNumber) {
  int bounds = 0;
  for_each_number(sample_schema(), "", [&](const Schema& field, const std::string& path) {
    const bool whole = field.kind == Schema::Kind::integer;
    const auto errors_with = [&](double v) { return read(kSmall, {path + "=" + number_text(v)}).errors; };
    const auto check = [&](double bound, bool open, double outward) {
      ++bounds;
      const double step = whole ? 1 : std::max(1e-12, std::abs(bound) * 1e-12);
      EXPECT_EQ(errors_with(bound).size(), open ? 1U : 0U) << path;
      EXPECT_EQ(errors_with(bound - outward * step).size(), 0U) << path;
      const auto errors = errors_with(bound + outward * step);
      ASSERT_EQ(errors.size(), 1U) << path;
      EXPECT_THAT(errors[0], HasSubstr(field.unit_text + " must be "));
      EXPECT_THAT(errors[0],
                  HasSubstr(std::string(outward < 0 ? ">" : "<") + (open ? " " : "= ") + number_text(bound)));
    };
    if (path == "version") return;  // one value only
    if (field.lower) check(*field.lower, field.lower_open, -1);
    if (field.upper) check(*field.upper, field.upper_open, +1);
  });
  EXPECT_EQ(bounds, 11);
}

TEST(JsonSchema, SaysWhatTheSchemaSays) {
  const auto json = nlohmann::json::parse(json_schema(sample_schema(), "vivify scene"));
  EXPECT_EQ(json["$schema"], "https://json-schema.org/draft/2020-12/schema");
  EXPECT_EQ(json["title"], "vivify scene");
  EXPECT_EQ(json["type"], "object");
  EXPECT_EQ(json["additionalProperties"], false);
  EXPECT_EQ(json["required"], nlohmann::json({"version", "bodies"}));
  const auto& fps = json["properties"]["frames"]["properties"]["fps"];
  EXPECT_EQ(fps["type"], "integer");
  EXPECT_EQ(fps["exclusiveMinimum"], 0);
  EXPECT_EQ(fps["maximum"], 1000);
  EXPECT_EQ(fps["default"], 24);
  EXPECT_EQ(json["properties"]["backend"]["enum"], nlohmann::json({"tetgen", "mesh3"}));
  EXPECT_EQ(json["properties"]["gravity"]["minItems"], 3);
  EXPECT_EQ(json["properties"]["gravity"]["default"][1], -9.81);
  EXPECT_EQ(json["properties"]["cutoff"]["type"], nlohmann::json({"number", "null"}));
  const auto& body = json["properties"]["bodies"]["items"];
  EXPECT_THAT(body["properties"]["friction"].dump(), HasSubstr("\"inf\""));
  const auto& model = body["properties"]["model"]["oneOf"][0];
  EXPECT_EQ(model["properties"]["type"]["const"], "solid3d");
  EXPECT_EQ(model["required"], nlohmann::json({"type", "stiffness"}));
  EXPECT_EQ(model["additionalProperties"], false);
  EXPECT_EQ(model["properties"]["density"]["description"], "Mass per volume. Unit: kg/m³.");
  EXPECT_FALSE(body["properties"]["rest_space"]["oneOf"][1].contains("required"));
  EXPECT_EQ(body["properties"]["looks"]["additionalProperties"]["type"], nlohmann::json({"string", "null"}));
}

TEST(Markdown, HasARowForEverySettingAndAHeadingForEverySection) {
  const std::string text = markdown(sample_schema());
  EXPECT_THAT(
      text, HasSubstr("| `version` | whole number |  | **required** | ≥ 1, ≤ 1 | Version of the format. |"));
  EXPECT_THAT(text, HasSubstr("\n## `frames`\n"));
  EXPECT_THAT(text, HasSubstr("\n## `bodies[]`\n"));
  EXPECT_THAT(text, HasSubstr("\n### `bodies[].model`\n"));
  EXPECT_THAT(text, HasSubstr("\n#### `bodies[].model` with `type: solid3d`\n"));
  EXPECT_THAT(text, HasSubstr("| `density` | number | kg/m³ | `1000` | > 0 | Mass per volume. |"));
  EXPECT_THAT(text, HasSubstr("may be `inf`"));
  EXPECT_THAT(text, HasSubstr("`tetgen` or `mesh3`"));
}

}  // namespace
}  // namespace vivify
