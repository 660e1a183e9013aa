#include "common/schema.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>

#include "common/text.h"

namespace vivify {

Schema Schema::unit(std::string text) && {
  unit_text = std::move(text);
  return std::move(*this);
}
Schema Schema::above(double bound) && {
  lower = bound;
  lower_open = true;
  return std::move(*this);
}
Schema Schema::at_least(double bound) && {
  lower = bound;
  lower_open = false;
  return std::move(*this);
}
Schema Schema::below(double bound) && {
  upper = bound;
  upper_open = true;
  return std::move(*this);
}
Schema Schema::at_most(double bound) && {
  upper = bound;
  upper_open = false;
  return std::move(*this);
}
Schema Schema::infinite() && {
  may_be_infinite = true;
  return std::move(*this);
}
Schema Schema::initially(double v) && {
  default_value = kind == Kind::integer ? Value::integer(static_cast<long>(v)) : Value::number(v);
  return std::move(*this);
}
Schema Schema::initially(int v) && {
  default_value = kind == Kind::integer ? Value::integer(v) : Value::number(v);
  return std::move(*this);
}
Schema Schema::initially(bool v) && {
  default_value = Value::boolean(v);
  return std::move(*this);
}
Schema Schema::initially(const char* v) && {
  default_value = Value::string(v);
  return std::move(*this);
}
Schema Schema::initially(std::vector<double> v) && {
  std::vector<Value> numbers;
  for (const double number : v) numbers.push_back(Value::number(number));
  default_value = Value::list(std::move(numbers));
  return std::move(*this);
}
Schema Schema::required() && {
  is_required = true;
  return std::move(*this);
}
Schema Schema::items_at_least(int count) && {
  min_items = count;
  return std::move(*this);
}
Schema Schema::field(std::string key, Schema schema) && {
  fields.emplace_back(std::move(key), std::move(schema));
  return std::move(*this);
}
Schema Schema::option(std::string name, Schema object) && {
  options.emplace_back(std::move(name), std::move(object));
  return std::move(*this);
}

namespace {

Schema make(Schema::Kind kind, std::string doc) {
  Schema schema;
  schema.kind = kind;
  schema.doc = std::move(doc);
  return schema;
}

}  // namespace

Schema boolean(std::string doc) { return make(Schema::Kind::boolean, std::move(doc)); }
Schema integer(std::string doc) { return make(Schema::Kind::integer, std::move(doc)); }
Schema number(std::string doc) { return make(Schema::Kind::number, std::move(doc)); }
Schema string(std::string doc) { return make(Schema::Kind::string, std::move(doc)); }
Schema path(std::string doc) { return make(Schema::Kind::path, std::move(doc)); }
Schema object(std::string doc) { return make(Schema::Kind::object, std::move(doc)); }
Schema choice(std::string doc, std::vector<std::string> choices) {
  Schema schema = make(Schema::Kind::choice, std::move(doc));
  schema.choices = std::move(choices);
  return schema;
}
Schema vector(std::string doc, int size) {
  Schema schema = make(Schema::Kind::vector, std::move(doc));
  schema.size = size;
  return schema;
}
Schema list(std::string doc, Schema item) {
  Schema schema = make(Schema::Kind::list, std::move(doc));
  schema.item = std::make_shared<Schema>(std::move(item));
  return schema;
}
Schema dictionary(std::string doc, Schema item) {
  Schema schema = make(Schema::Kind::dictionary, std::move(doc));
  schema.item = std::make_shared<Schema>(std::move(item));
  return schema;
}
Schema variant(std::string doc, std::string tag) {
  Schema schema = make(Schema::Kind::variant, std::move(doc));
  schema.tag = std::move(tag);
  return schema;
}
Schema one_of(std::string doc) { return variant(std::move(doc), ""); }

namespace {

std::vector<std::string> names_of(const std::vector<std::pair<std::string, Schema>>& entries) {
  std::vector<std::string> names;
  for (const auto& [name, schema] : entries) names.push_back(name);
  return names;
}

std::string wanted_text(const Schema& schema) {
  switch (schema.kind) {
    case Schema::Kind::boolean:
      return "true or false";
    case Schema::Kind::integer:
      return "a whole number";
    case Schema::Kind::number:
      return "a number";
    case Schema::Kind::string:
      return "a text";
    case Schema::Kind::choice:
      return join_words(schema.choices, "or");
    case Schema::Kind::path:
      return "the path of a file";
    case Schema::Kind::vector:
      return "a list of " + std::to_string(schema.size) + " numbers";
    case Schema::Kind::list:
      return "a list";
    case Schema::Kind::variant:
      if (schema.tag.empty())
        return "one of " + join_words(names_of(schema.options), "or") + " with its settings";
      return "a map of keys and values";
    case Schema::Kind::object:
    case Schema::Kind::dictionary:
      return "a map of keys and values";
  }
  return "something else";
}

std::string found_text(const ConfigNode& node) {
  switch (node.kind) {
    case ConfigNode::Kind::null:
      return "nothing";
    case ConfigNode::Kind::list:
      return "a list of " + std::to_string(node.items.size());
    case ConfigNode::Kind::map:
      return "a map";
    case ConfigNode::Kind::scalar:
      break;
  }
  std::string text = node.scalar.substr(0, 60);
  return (node.quoted ? "the quoted text '" : "'") + text + (node.scalar.size() > 60 ? "…'" : "'");
}

const Schema* find(const std::vector<std::pair<std::string, Schema>>& entries, const std::string& name) {
  for (const auto& [key, schema] : entries) {
    if (key == name) return &schema;
  }
  return nullptr;
}

const ConfigNode::Entry* find_entry_of(const ConfigNode& node, const std::string& key) {
  for (const ConfigNode::Entry& entry : node.entries) {
    if (entry.key == key) return &entry;
  }
  return nullptr;
}

// A real number, also `inf`, `.inf` and `nan` in any sign; false when the text is no number or too large for
// one.
bool read_number(const std::string& scalar, double& value) {
  std::string_view text = scalar;
  bool negative = false;
  if (!text.empty() && (text[0] == '+' || text[0] == '-')) {
    negative = text[0] == '-';
    text.remove_prefix(1);
  }
  if (text == ".inf" || text == ".Inf" || text == ".INF" || text == "inf") {
    value = negative ? -INFINITY : INFINITY;
    return true;
  }
  if (text == ".nan" || text == ".NaN" || text == ".NAN" || text == "nan" || text == "NaN") {
    value = NAN;
    return true;
  }
  if (text.empty() || (text[0] != '.' && (text[0] < '0' || text[0] > '9'))) return false;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return false;
  if (negative) value = -value;
  return true;
}

std::string bounds_text(const Schema& schema) {
  std::string text;
  if (schema.lower) text += (schema.lower_open ? "> " : ">= ") + number_text(*schema.lower);
  if (schema.lower && schema.upper) text += " and ";
  if (schema.upper) text += (schema.upper_open ? "< " : "<= ") + number_text(*schema.upper);
  return text;
}

bool any_required(const std::vector<std::pair<std::string, Schema>>& fields) {
  return std::any_of(fields.begin(), fields.end(), [](const auto& f) { return f.second.is_required; });
}

class Resolver {
 public:
  explicit Resolver(std::vector<Error>& errors) : errors_(errors) {}

  Value resolve(const Schema& schema, const ConfigNode& node, const std::string& path) {
    Value value = resolve_kind(schema, node, path);
    value.set_where(node.where);
    return value;
  }

  // The value of a setting that was left out of the map at `where`.
  Value absent(const Schema& schema, const Location& where, const std::string& path) {
    Value value;
    if (schema.is_required) {
      problem(where, path + " is missing", "it must be " + wanted_text(schema));
    } else if (schema.kind == Schema::Kind::object && !any_required(schema.fields)) {
      value = resolve_fields(schema.fields, empty_map(where), path, nullptr);
    } else if (schema.kind == Schema::Kind::variant && !schema.default_value.is_null()) {
      const Schema* const option = find(schema.options, schema.default_value.as_string());
      if (option != nullptr && !any_required(option->fields))
        value = resolve_variant(schema, empty_map(where), path);
    } else if (schema.kind == Schema::Kind::list && schema.default_value.is_null()) {
      // What must have items is not there at all: an empty list could not be read back.
      if (schema.min_items == 0) value = Value::list({});
    } else if (schema.kind == Schema::Kind::dictionary) {
      value = Value::map();
    } else if (schema.kind != Schema::Kind::variant) {
      value = schema.default_value;
    }
    value.set_where(where);
    return value;
  }

 private:
  static ConfigNode empty_map(const Location& where) {
    ConfigNode node;
    node.kind = ConfigNode::Kind::map;
    node.where = where;
    return node;
  }

  void problem(const Location& where, const std::string& message, const std::string& hint = {}) {
    errors_.emplace_back(ErrorKind::usage, message, hint, where);
  }

  void wrong_type(const Schema& schema, const ConfigNode& node, const std::string& path,
                  std::string hint = {}) {
    problem(node.where,
            (path.empty() ? "the scene" : path) + " must be " + wanted_text(schema) + ", found " +
                found_text(node),
            std::move(hint));
  }

  Value resolve_kind(const Schema& schema, const ConfigNode& node, const std::string& path) {
    switch (schema.kind) {
      case Schema::Kind::boolean:
        return resolve_boolean(schema, node, path);
      case Schema::Kind::integer:
      case Schema::Kind::number:
        return resolve_number(schema, node, path);
      case Schema::Kind::string:
      case Schema::Kind::path:
        if (node.kind == ConfigNode::Kind::scalar && !node.scalar.empty()) return Value::string(node.scalar);
        if (node.kind == ConfigNode::Kind::scalar && schema.kind == Schema::Kind::string)
          return Value::string("");
        wrong_type(schema, node, path);
        return {};
      case Schema::Kind::choice:
        return resolve_choice(schema, node, path);
      case Schema::Kind::vector:
        return resolve_vector(schema, node, path);
      case Schema::Kind::list:
        return resolve_list(schema, node, path);
      case Schema::Kind::dictionary:
        return resolve_dictionary(schema, node, path);
      case Schema::Kind::object:
        if (node.kind == ConfigNode::Kind::map) return resolve_fields(schema.fields, node, path, nullptr);
        wrong_type(schema, node, path);
        return {};
      case Schema::Kind::variant:
        return schema.tag.empty() ? resolve_one_of(schema, node, path) : resolve_variant(schema, node, path);
    }
    return {};
  }

  Value resolve_boolean(const Schema& schema, const ConfigNode& node, const std::string& path) {
    if (node.kind == ConfigNode::Kind::scalar && !node.quoted) {
      if (node.scalar == "true") return Value::boolean(true);
      if (node.scalar == "false") return Value::boolean(false);
    }
    wrong_type(schema, node, path);
    return {};
  }

  Value resolve_number(const Schema& schema, const ConfigNode& node, const std::string& path) {
    double number = 0;
    if (node.kind != ConfigNode::Kind::scalar || node.quoted) {
      double unused;
      const bool only_quotes = node.kind == ConfigNode::Kind::scalar && read_number(node.scalar, unused);
      wrong_type(schema, node, path, only_quotes ? "remove the quotes" : "");
      return {};
    }
    if (!read_number(node.scalar, number)) {
      wrong_type(schema, node, path);
      return {};
    }
    if (std::isnan(number)) {
      problem(node.where, path + " = " + node.scalar + " must be a number");
      return {};
    }
    if (std::isinf(number) && !schema.may_be_infinite) {
      problem(node.where, path + " = " + node.scalar + " must be finite");
      return {};
    }
    long whole = 0;
    if (schema.kind == Schema::Kind::integer) {
      if (number != std::floor(number) || std::abs(number) > 9e15) {
        wrong_type(schema, node, path);
        return {};
      }
      whole = static_cast<long>(number);
    }
    const bool too_low =
        schema.lower && (schema.lower_open ? number <= *schema.lower : number < *schema.lower);
    const bool too_high =
        schema.upper && (schema.upper_open ? number >= *schema.upper : number > *schema.upper);
    if (too_low || too_high) {
      problem(node.where, path + " = " + number_text(number) +
                              (schema.unit_text.empty() ? "" : " " + schema.unit_text) + " must be " +
                              bounds_text(schema));
    }
    return schema.kind == Schema::Kind::integer ? Value::integer(whole) : Value::number(number);
  }

  Value resolve_choice(const Schema& schema, const ConfigNode& node, const std::string& path) {
    if (node.kind != ConfigNode::Kind::scalar) {
      wrong_type(schema, node, path);
      return {};
    }
    if (std::find(schema.choices.begin(), schema.choices.end(), node.scalar) == schema.choices.end()) {
      problem(node.where, path + " = " + node.scalar + " must be " + join_words(schema.choices, "or"),
              meant(node.scalar, schema.choices));
    }
    return Value::string(node.scalar);
  }

  Value resolve_vector(const Schema& schema, const ConfigNode& node, const std::string& path) {
    if (node.kind != ConfigNode::Kind::list || node.items.size() != static_cast<std::size_t>(schema.size)) {
      wrong_type(schema, node, path);
      return {};
    }
    Schema component = schema;
    component.kind = Schema::Kind::number;
    std::vector<Value> values;
    for (std::size_t i = 0; i < node.items.size(); ++i) {
      values.push_back(resolve(component, node.items[i], path + "[" + std::to_string(i) + "]"));
    }
    return Value::list(std::move(values));
  }

  Value resolve_list(const Schema& schema, const ConfigNode& node, const std::string& path) {
    if (node.kind != ConfigNode::Kind::list) {
      wrong_type(schema, node, path);
      return {};
    }
    if (node.items.size() < static_cast<std::size_t>(schema.min_items)) {
      problem(node.where, path + " must have at least " + std::to_string(schema.min_items) +
                              (schema.min_items == 1 ? " item" : " items") + ", found " +
                              std::to_string(node.items.size()));
    }
    const Schema* const name = find(schema.item->fields, "name");
    const bool named = name != nullptr && name->is_required;
    std::map<std::string, std::string> taken;  // name, path of its owner
    std::vector<Value> values;
    for (std::size_t i = 0; i < node.items.size(); ++i) {
      const std::string item_path = path + "[" + std::to_string(i) + "]";
      values.push_back(resolve(*schema.item, node.items[i], item_path));
      const ConfigNode::Entry* const entry = named ? find_entry_of(node.items[i], "name") : nullptr;
      if (entry == nullptr || entry->value.kind != ConfigNode::Kind::scalar) continue;
      const auto [owner, is_new] = taken.emplace(entry->value.scalar, item_path);
      if (!is_new) {
        problem(entry->value.where, item_path + ".name = " + entry->value.scalar + " is the name of " +
                                        owner->second + " already");
      }
    }
    return Value::list(std::move(values));
  }

  Value resolve_dictionary(const Schema& schema, const ConfigNode& node, const std::string& path) {
    if (node.kind != ConfigNode::Kind::map) {
      wrong_type(schema, node, path);
      return {};
    }
    Value value = Value::map();
    for (const ConfigNode::Entry& entry : node.entries) {
      value.set(entry.key, resolve(*schema.item, entry.value, path + "." + entry.key));
    }
    return value;
  }

  static std::string meant(const std::string& word, const std::vector<std::string>& known) {
    const std::string nearest = nearest_word(word, known);
    return nearest.empty() ? "" : "did you mean " + nearest + "?";
  }

  // The fields of an object, or of an option of `variant`.
  Value resolve_fields(const std::vector<std::pair<std::string, Schema>>& fields, const ConfigNode& node,
                       const std::string& path, const Schema* variant) {
    const std::string prefix = path.empty() ? "" : path + ".";
    std::vector<std::string> known = names_of(fields);
    if (variant != nullptr) known.insert(known.begin(), variant->tag);
    for (const ConfigNode::Entry& entry : node.entries) {
      if (std::find(known.begin(), known.end(), entry.key) != known.end()) continue;
      std::string hint = meant(entry.key, known);
      if (hint.empty() && variant != nullptr) {
        std::vector<std::string> owners;
        for (const auto& [name, option] : variant->options) {
          if (find(option.fields, entry.key) != nullptr) owners.push_back(name);
        }
        if (!owners.empty()) hint = "it is a key of " + variant->tag + ": " + join_words(owners, "or");
      }
      if (hint.empty() && known.size() <= 16) hint = "known keys: " + join_words(known);
      problem(entry.key_where, "unknown key '" + entry.key + "'" + (path.empty() ? "" : " in " + path), hint);
    }
    Value value = Value::map();
    for (const auto& [key, schema] : fields) {
      const ConfigNode::Entry* const entry = find_entry_of(node, key);
      // A key without a value counts as left out.
      const bool given = entry != nullptr && entry->value.kind != ConfigNode::Kind::null;
      value.set(key, given ? resolve(schema, entry->value, prefix + key)
                           : absent(schema, entry != nullptr ? entry->key_where : node.where, prefix + key));
    }
    return value;
  }

  Value resolve_variant(const Schema& schema, const ConfigNode& node, const std::string& path) {
    if (node.kind != ConfigNode::Kind::map) {
      wrong_type(schema, node, path);
      return {};
    }
    const std::vector<std::string> names = names_of(schema.options);
    const std::string tag_path = (path.empty() ? "" : path + ".") + schema.tag;
    const ConfigNode::Entry* const entry = find_entry_of(node, schema.tag);
    std::string name;
    Location tag_where = node.where;
    if (entry != nullptr && entry->value.kind == ConfigNode::Kind::scalar) {
      name = entry->value.scalar;
      tag_where = entry->value.where;
    } else if (entry != nullptr && entry->value.kind != ConfigNode::Kind::null) {
      problem(entry->value.where,
              tag_path + " must be " + join_words(names, "or") + ", found " + found_text(entry->value));
      return {};
    } else if (!schema.default_value.is_null()) {
      name = schema.default_value.as_string();
    } else {
      problem(node.where, tag_path + " is missing", "it must be " + join_words(names, "or"));
      return {};
    }
    const Schema* const option = find(schema.options, name);
    if (option == nullptr) {
      problem(tag_where, tag_path + " = " + name + " must be " + join_words(names, "or"), meant(name, names));
      return {};
    }
    Value value = Value::map();
    Value tag_value = Value::string(name);
    tag_value.set_where(tag_where);
    value.set(schema.tag, std::move(tag_value));
    const Value rest = resolve_fields(option->fields, node, path, &schema);
    for (const auto& [key, field] : rest.entries()) value.set(key, field);
    return value;
  }

  Value resolve_one_of(const Schema& schema, const ConfigNode& node, const std::string& path) {
    if (node.kind != ConfigNode::Kind::map || node.entries.size() != 1) {
      std::string hint;
      if (node.entries.size() > 1) {
        const std::string &first = node.entries[0].key, &second = node.entries[1].key;
        hint = find(schema.options, second) != nullptr
                   ? "give " + second + " after " + first + ", as an item of its own"
                   : "indent the settings of " + first + " below it";
      }
      wrong_type(schema, node, path, hint);
      return {};
    }
    const ConfigNode::Entry& entry = node.entries.front();
    const Schema* const option = find(schema.options, entry.key);
    if (option == nullptr) {
      const std::vector<std::string> names = names_of(schema.options);
      const std::string nearest = meant(entry.key, names);
      problem(entry.key_where, "unknown key '" + entry.key + "' in " + path,
              nearest.empty() ? "known keys: " + join_words(names) : nearest);
      return {};
    }
    const bool given = entry.value.kind != ConfigNode::Kind::null;
    Value value = Value::map();
    value.set(entry.key,
              resolve(*option, given ? entry.value : empty_map(entry.key_where), path + "." + entry.key));
    return value;
  }

  std::vector<Error>& errors_;
};

}  // namespace

namespace {

// Puts the errors of one file into the order of their places; those of files before stay where they are.
void sort_by_place(std::vector<Error>& errors, const std::string& file) {
  const auto first = std::find_if(errors.begin(), errors.end(),
                                  [&](const Error& error) { return error.where().file == file; });
  std::stable_sort(first, errors.end(), [](const Error& a, const Error& b) {
    return std::pair(a.where().line, a.where().column) < std::pair(b.where().line, b.where().column);
  });
}

}  // namespace

Value resolve(const Schema& schema, const ConfigNode& node, std::vector<Error>& errors) {
  const bool unreadable = node.kind == ConfigNode::Kind::null && node.where.line == 0 && !errors.empty();
  if (unreadable) return {};  // parse_yaml has said why
  ConfigNode empty;
  empty.kind = ConfigNode::Kind::map;
  empty.where = node.where;
  Value value = Resolver(errors).resolve(schema, node.kind == ConfigNode::Kind::null ? empty : node, "");
  sort_by_place(errors, node.where.file);
  return value;
}

}  // namespace vivify
