// The schema of the scene file: key, type, unit, default, bounds and text of every setting, held once. It
// serves parsing, `check`, `schema --json`, `schema --markdown` and scene.resolved.yaml.
//
//   Schema material = object("Elastic material.")
//       .field("density", number("Mass per volume.").unit("kg/m³").above(0).initially(1000))
//       .field("stiffness", number("Edge stiffness k_l.").unit("Pa").above(0).required());
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/config.h"
#include "common/value.h"

namespace vivify {

class Schema {
 public:
  enum class Kind {
    boolean,
    integer,
    number,
    string,
    choice,
    path,
    vector,
    list,
    object,
    variant,
    dictionary
  };

  // Refinements; each returns the refined schema, so that they can be chained.
  [[nodiscard]] Schema unit(std::string unit) &&;
  [[nodiscard]] Schema above(double bound) &&;     // value > bound
  [[nodiscard]] Schema at_least(double bound) &&;  // value >= bound
  [[nodiscard]] Schema below(double bound) &&;     // value < bound
  [[nodiscard]] Schema at_most(double bound) &&;   // value <= bound
  [[nodiscard]] Schema infinite() &&;              // a number may be `inf`
  [[nodiscard]] Schema initially(double v) &&;     // default of a number or integer
  [[nodiscard]] Schema initially(int v) &&;
  [[nodiscard]] Schema initially(bool v) &&;
  [[nodiscard]] Schema initially(const char* v) &&;          // default of a string, choice or path
  [[nodiscard]] Schema initially(std::vector<double> v) &&;  // default of a vector
  [[nodiscard]] Schema required() &&;  // must be given; without a default and not required: null
  [[nodiscard]] Schema items_at_least(int count) &&;                // of a list
  [[nodiscard]] Schema field(std::string key, Schema schema) &&;    // of an object; order is kept
  [[nodiscard]] Schema option(std::string name, Schema object) &&;  // of a variant

  // Data, for the code that walks the schema.
  Kind kind = Kind::object;
  std::string doc;
  std::string unit_text;
  std::optional<double> lower, upper;
  bool lower_open = false, upper_open = false, may_be_infinite = false;
  bool is_required = false;
  int size = 0;       // of a vector: wanted length
  int min_items = 0;  // of a list
  Value default_value;
  std::vector<std::string> choices;
  std::vector<std::pair<std::string, Schema>> fields;  // of an object
  std::string tag;  // of a variant: the key that selects, for example "type"; empty: the option is the key
  std::vector<std::pair<std::string, Schema>> options;  // of a variant
  std::shared_ptr<Schema> item;                         // of a list or dictionary
};

// What a setting is. `doc` is one or two full sentences for the reference.
Schema boolean(std::string doc);
Schema integer(std::string doc);
Schema number(std::string doc);
Schema string(std::string doc);
Schema choice(std::string doc, std::vector<std::string> choices);
Schema path(std::string doc);               // a file, relative to the scene file
Schema vector(std::string doc, int size);   // `size` numbers
Schema list(std::string doc, Schema item);  // any number of items; an item that is an object with a required
                                            // `name` must have a name of its own
Schema dictionary(std::string doc, Schema item);  // free keys, each with a value of the same kind
Schema object(std::string doc);  // an object none of whose fields is required may be left out
// One of several objects, selected by the key `tag`; `initially("name")` makes the tag optional.
Schema variant(std::string doc, std::string tag);
// One of several objects, under its name as the only key: `walk: {speed: 0.5}`.
Schema one_of(std::string doc);

// Checks `node` against `schema` and fills in defaults; a key without a value counts as left out. Adds one
// Error(usage) per problem to `errors`, in the order of the file, such as
//   configs/walk.yaml:14:21: error: bodies[0].material.density = -3 kg/m³ must be > 0
// and unknown keys name the nearest known one. The result is whole when no error was added.
// Paths stay as they were written.
Value resolve(const Schema& schema, const ConfigNode& node, std::vector<Error>& errors);

std::string json_schema(const Schema& schema, const std::string& title);  // JSON Schema, draft 2020-12
std::string markdown(const Schema& schema);                               // the body of docs/reference.md

}  // namespace vivify
