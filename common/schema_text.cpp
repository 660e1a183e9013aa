// The schema as JSON Schema and as Markdown.
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "common/schema.h"
#include "common/text.h"

namespace vivify {
namespace {

using Json = nlohmann::ordered_json;

Json json_value(const Value& value) {
  switch (value.kind()) {
    case Value::Kind::null:
      return nullptr;
    case Value::Kind::boolean:
      return value.as_bool();
    case Value::Kind::integer:
      return value.as_integer();
    case Value::Kind::number:
      if (std::isinf(value.as_number())) return value.as_number() > 0 ? "inf" : "-inf";
      if (value.as_number() == std::floor(value.as_number()) && std::abs(value.as_number()) < 1e15) {
        return static_cast<long>(value.as_number());
      }
      return value.as_number();
    case Value::Kind::string:
      return value.as_string();
    case Value::Kind::list: {
      Json list = Json::array();
      for (const Value& item : value.items()) list.push_back(json_value(item));
      return list;
    }
    case Value::Kind::map: {
      Json map = Json::object();
      for (const auto& [key, item] : value.entries()) map[key] = json_value(item);
      return map;
    }
  }
  return nullptr;
}

void add_bounds(Json& json, const Schema& schema) {
  if (schema.lower)
    json[schema.lower_open ? "exclusiveMinimum" : "minimum"] = json_value(Value::number(*schema.lower));
  if (schema.upper)
    json[schema.upper_open ? "exclusiveMaximum" : "maximum"] = json_value(Value::number(*schema.upper));
}

Json number_json(const Schema& schema) {
  Json number = {{"type", "number"}};
  add_bounds(number, schema);
  if (!schema.may_be_infinite) return number;
  Json words = Json::array();
  if (!schema.upper || std::isinf(*schema.upper)) words.insert(words.end(), {"inf", "+inf"});
  if (!schema.lower || std::isinf(*schema.lower)) words.push_back("-inf");
  if (words.empty()) return number;
  return {{"anyOf", Json::array({number, Json{{"enum", words}}})}};
}

Json schema_json(const Schema& schema);

Json fields_json(const std::vector<std::pair<std::string, Schema>>& fields, Json properties, Json required) {
  for (const auto& [key, field] : fields) {
    properties[key] = schema_json(field);
    if (field.is_required) required.push_back(key);
  }
  Json json = {{"type", "object"}, {"properties", std::move(properties)}, {"additionalProperties", false}};
  if (!required.empty()) json["required"] = std::move(required);
  return json;
}

Json bare_json(const Schema& schema) {
  switch (schema.kind) {
    case Schema::Kind::boolean:
      return {{"type", "boolean"}};
    case Schema::Kind::integer: {
      Json json = {{"type", "integer"}};
      add_bounds(json, schema);
      return json;
    }
    case Schema::Kind::number:
      return number_json(schema);
    case Schema::Kind::string:
      return {{"type", "string"}};
    case Schema::Kind::path:
      return {{"type", "string"}, {"minLength", 1}};
    case Schema::Kind::choice:
      return {{"enum", schema.choices}};
    case Schema::Kind::vector:
      return {{"type", "array"},
              {"items", number_json(schema)},
              {"minItems", schema.size},
              {"maxItems", schema.size}};
    case Schema::Kind::list: {
      Json json = {{"type", "array"}, {"items", schema_json(*schema.item)}};
      if (schema.min_items > 0) json["minItems"] = schema.min_items;
      return json;
    }
    case Schema::Kind::dictionary:
      return {{"type", "object"}, {"additionalProperties", schema_json(*schema.item)}};
    case Schema::Kind::object:
      return fields_json(schema.fields, Json::object(), Json::array());
    case Schema::Kind::variant: {
      Json options = Json::array();
      for (const auto& [name, option] : schema.options) {
        if (schema.tag.empty()) {
          Json only = Json::object();
          only[name] = schema_json(option);
          options.push_back({{"title", name},
                             {"type", "object"},
                             {"properties", std::move(only)},
                             {"additionalProperties", false},
                             {"required", Json::array({name})}});
          continue;
        }
        Json properties = Json::object();
        properties[schema.tag] = {{"const", name}, {"description", option.doc}};
        // Only the option that is the default may leave its tag out; so exactly one option fits.
        const bool optional_tag = !schema.default_value.is_null() && schema.default_value.as_string() == name;
        Json json = fields_json(option.fields, std::move(properties),
                                optional_tag ? Json::array() : Json::array({schema.tag}));
        Json titled = {{"title", name}, {"description", option.doc}};
        titled.update(json);
        options.push_back(std::move(titled));
      }
      return {{"oneOf", std::move(options)}};
    }
  }
  return Json::object();
}

Json schema_json(const Schema& schema) {
  Json json = Json::object();
  json["description"] = schema.doc + (schema.unit_text.empty() ? "" : " Unit: " + schema.unit_text + ".");
  json.update(bare_json(schema));
  if (!schema.default_value.is_null() && schema.kind != Schema::Kind::variant) {
    json["default"] = json_value(schema.default_value);
  }
  // What is neither required nor has a default is `null` in scene.resolved.yaml.
  if (schema.is_required || !schema.default_value.is_null()) return json;
  if (json.contains("type")) {
    json["type"] = Json::array({json["type"], "null"});
  } else if (json.contains("enum")) {
    json["enum"].push_back(nullptr);
  } else if (json.contains("anyOf")) {
    json["anyOf"].push_back({{"type", "null"}});
  } else if (json.contains("oneOf")) {
    json["oneOf"].push_back({{"type", "null"}});
  }
  return json;
}

// --- Markdown
// ---------------------------------------------------------------------------------------------------

std::string cell(std::string text) {
  for (std::size_t at = 0; (at = text.find_first_of("|\n", at)) != std::string::npos;) {
    if (text[at] == '\n') {
      text[at++] = ' ';
    } else {
      text.insert(at, "\\");
      at += 2;
    }
  }
  return text;
}

std::string kind_text(const Schema& schema) {
  switch (schema.kind) {
    case Schema::Kind::boolean:
      return "true or false";
    case Schema::Kind::integer:
      return "whole number";
    case Schema::Kind::number:
      return "number";
    case Schema::Kind::string:
      return "text";
    case Schema::Kind::path:
      return "path";
    case Schema::Kind::choice: {
      std::vector<std::string> words;
      for (const std::string& word : schema.choices) words.push_back("`" + word + "`");
      return join_words(words, "or");
    }
    case Schema::Kind::vector:
      return std::to_string(schema.size) + " numbers";
    case Schema::Kind::list:
      return "list of: " + kind_text(*schema.item);
    case Schema::Kind::dictionary:
      return "map of names to: " + kind_text(*schema.item);
    case Schema::Kind::object:
      return "section";
    case Schema::Kind::variant:
      return schema.tag.empty() ? "section of one key" : "section by `" + schema.tag + "`";
  }
  return "";
}

std::string default_text(const Schema& schema) {
  if (schema.is_required) return "**required**";
  if (schema.default_value.is_null()) {
    return schema.kind == Schema::Kind::list || schema.kind == Schema::Kind::dictionary ? "empty" : "–";
  }
  std::string text = schema.kind == Schema::Kind::variant
                         ? schema.tag + ": " + schema.default_value.as_string()
                         : schema.default_value.yaml();
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return "`" + text + "`";
}

std::string range_text(const Schema& schema) {
  std::string text;
  if (schema.lower) text += (schema.lower_open ? "> " : "≥ ") + number_text(*schema.lower);
  if (schema.lower && schema.upper) text += ", ";
  if (schema.upper) text += (schema.upper_open ? "< " : "≤ ") + number_text(*schema.upper);
  if (schema.may_be_infinite) text += std::string(text.empty() ? "" : ", ") + "may be `inf`";
  if (schema.min_items > 0) text += "at least " + std::to_string(schema.min_items);
  return text;
}

void append_sections(std::string& text, const Schema& schema, const std::string& path, int level);

void append_fields(std::string& text, const std::vector<std::pair<std::string, Schema>>& fields,
                   const std::string& path, int level) {
  if (fields.empty()) {
    text += "No further keys.\n\n";
    return;
  }
  text += "| key | what | unit | default | range | meaning |\n|---|---|---|---|---|---|\n";
  for (const auto& [key, field] : fields) {
    text += "| `" + key + "` | " + cell(kind_text(field)) + " | " + cell(field.unit_text) + " | " +
            cell(default_text(field)) + " | " + cell(range_text(field)) + " | " + cell(field.doc) + " |\n";
  }
  text += "\n";
  for (const auto& [key, field] : fields)
    append_sections(text, field, path.empty() ? key : path + "." + key, level);
}

void append_heading(std::string& text, int level, const std::string& title) {
  text += std::string(static_cast<std::size_t>(std::min(level, 6)), '#') + " " + title + "\n\n";
}

// The sections below a field, if it has any.
void append_sections(std::string& text, const Schema& schema, const std::string& path, int level) {
  switch (schema.kind) {
    case Schema::Kind::list:
      append_sections(text, *schema.item, path + "[]", level);
      return;
    case Schema::Kind::dictionary:
      append_sections(text, *schema.item, path + ".NAME", level);
      return;
    case Schema::Kind::object:
      append_heading(text, level, "`" + path + "`");
      text += schema.doc + "\n\n";
      append_fields(text, schema.fields, path, level + 1);
      return;
    case Schema::Kind::variant: {
      append_heading(text, level, "`" + path + "`");
      std::vector<std::string> names;
      for (const auto& [name, option] : schema.options) names.push_back("`" + name + "`");
      if (schema.tag.empty()) {
        text += schema.doc + " The key is " + join_words(names, "or") + ".\n\n";
        for (const auto& [name, option] : schema.options)
          append_sections(text, option, path + "." + name, level + 1);
        return;
      }
      text +=
          schema.doc + " The key `" + schema.tag + "` is " + join_words(names, "or") +
          (schema.default_value.is_null() ? ""
                                          : "; left out, it is `" + schema.default_value.as_string() + "`") +
          ".\n\n";
      for (const auto& [name, option] : schema.options) {
        append_heading(text, level + 1, "`" + path + "` with `" + schema.tag + ": " + name + "`");
        text += option.doc + "\n\n";
        append_fields(text, option.fields, path, level + 2);
      }
      return;
    }
    default:
      return;
  }
}

}  // namespace

std::string json_schema(const Schema& schema, const std::string& title) {
  Json json = {{"$schema", "https://json-schema.org/draft/2020-12/schema"}, {"title", title}};
  Schema root = schema;
  root.is_required = true;  // a scene is never null
  json.update(schema_json(root));
  return json.dump(2) + "\n";
}

std::string markdown(const Schema& schema) {
  std::string text = schema.doc + "\n\n";
  append_fields(text, schema.fields, "", 2);
  while (text.ends_with("\n\n")) text.pop_back();
  return text;
}

}  // namespace vivify
