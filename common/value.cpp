#include "common/value.h"

#include <algorithm>
#include <cmath>

#include "common/text.h"

namespace vivify {
namespace {

const char* kind_name(Value::Kind kind) {
  switch (kind) {
    case Value::Kind::null:
      return "null";
    case Value::Kind::boolean:
      return "boolean";
    case Value::Kind::integer:
      return "integer";
    case Value::Kind::number:
      return "number";
    case Value::Kind::string:
      return "string";
    case Value::Kind::list:
      return "list";
    case Value::Kind::map:
      return "map";
  }
  return "unknown";
}

[[noreturn]] void fail(const Value& value, const char* wanted) {
  throw Error(ErrorKind::internal,
              std::string("a setting was read as ") + wanted + " but is " + kind_name(value.kind()), "",
              value.where());
}

std::string number_yaml(double v) {
  if (std::isinf(v)) return v > 0 ? ".inf" : "-.inf";
  if (std::isnan(v)) return ".nan";
  return number_text(v);
}

// Plain style only for words that no YAML reader takes for something else; double quotes for all others.
std::string string_yaml(const std::string& text) {
  const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
  const auto inner = [&](char c) {
    return letter(c) || (c >= '0' && c <= '9') || c == '.' || c == '/' || c == '-';
  };
  const bool word_like = !text.empty() &&
                         (letter(text[0]) || text.starts_with("./") || text.starts_with("../") ||
                          (text[0] == '/' && text.size() > 1)) &&
                         std::all_of(text.begin(), text.end(), inner);
  if (word_like) {
    std::string lower = text;
    for (char& c : lower) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    const auto reserved = {"true", "false", "yes", "no",  "on",  "off",
                           "null", "y",     "n",   "inf", "nan", "infinity"};
    if (std::find(reserved.begin(), reserved.end(), lower) == reserved.end()) return text;
  }
  constexpr char kHex[] = "0123456789abcdef";
  std::string quoted = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      quoted += '\\';
      quoted += c;
    } else if (c == '\n') {
      quoted += "\\n";
    } else if (c == '\t') {
      quoted += "\\t";
    } else if (byte < 0x20 || byte == 0x7f) {
      quoted += "\\x";
      quoted += kHex[byte >> 4];
      quoted += kHex[byte & 15];
    } else {
      quoted += c;
    }
  }
  return quoted + "\"";
}

std::string scalar_yaml(const Value& value) {
  switch (value.kind()) {
    case Value::Kind::null:
      return "null";
    case Value::Kind::boolean:
      return value.as_bool() ? "true" : "false";
    case Value::Kind::integer:
      return std::to_string(value.as_integer());
    case Value::Kind::number:
      return number_yaml(value.as_number());
    case Value::Kind::string:
      return string_yaml(value.as_string());
    case Value::Kind::list:
      return "[]";  // when empty
    case Value::Kind::map:
      return "{}";
  }
  return "null";
}

bool is_block(const Value& value) {
  return (value.kind() == Value::Kind::list && !value.items().empty()) ||
         (value.kind() == Value::Kind::map && !value.entries().empty());
}

bool is_flow_list(const Value& value) {
  return value.kind() == Value::Kind::list && !value.items().empty() &&
         std::none_of(value.items().begin(), value.items().end(), is_block);
}

std::string flow_yaml(const Value& list) {
  std::string text = "[";
  for (const Value& item : list.items()) text += (text.size() > 1 ? ", " : "") + scalar_yaml(item);
  return text + "]";
}

// Appends a list or map that is not empty; the cursor stands where its first line begins.
void append_block(std::string& text, const Value& value, std::size_t indent) {
  const std::string margin(indent, ' ');
  bool first = true;
  if (value.kind() == Value::Kind::list) {
    for (const Value& item : value.items()) {
      if (!first) text += margin;
      first = false;
      text += "- ";
      if (is_flow_list(item)) {
        text += flow_yaml(item) + "\n";
      } else if (is_block(item)) {
        append_block(text, item, indent + 2);
      } else {
        text += scalar_yaml(item) + "\n";
      }
    }
    return;
  }
  for (const auto& [key, item] : value.entries()) {
    if (!first) text += margin;
    first = false;
    text += string_yaml(key) + ":";
    if (is_flow_list(item)) {
      text += " " + flow_yaml(item) + "\n";
    } else if (is_block(item)) {
      text += "\n" + margin + "  ";
      append_block(text, item, indent + 2);
    } else {
      text += " " + scalar_yaml(item) + "\n";
    }
  }
}

}  // namespace

Value Value::boolean(bool v) {
  Value value;
  value.kind_ = Kind::boolean;
  value.bool_ = v;
  return value;
}

Value Value::integer(long v) {
  Value value;
  value.kind_ = Kind::integer;
  value.integer_ = v;
  return value;
}

Value Value::number(double v) {
  Value value;
  value.kind_ = Kind::number;
  value.number_ = v;
  return value;
}

Value Value::string(std::string v) {
  Value value;
  value.kind_ = Kind::string;
  value.string_ = std::move(v);
  return value;
}

Value Value::list(std::vector<Value> items) {
  Value value;
  value.kind_ = Kind::list;
  value.items_ = std::move(items);
  return value;
}

Value Value::map(std::vector<std::pair<std::string, Value>> entries) {
  Value value;
  value.kind_ = Kind::map;
  value.entries_ = std::move(entries);
  return value;
}

bool Value::as_bool() const {
  if (kind_ != Kind::boolean) fail(*this, "boolean");
  return bool_;
}

long Value::as_integer() const {
  if (kind_ != Kind::integer) fail(*this, "integer");
  return integer_;
}

double Value::as_number() const {
  if (kind_ == Kind::integer) return static_cast<double>(integer_);
  if (kind_ != Kind::number) fail(*this, "number");
  return number_;
}

const std::string& Value::as_string() const {
  if (kind_ != Kind::string) fail(*this, "string");
  return string_;
}

Eigen::VectorXd Value::as_vector() const {
  if (kind_ != Kind::list) fail(*this, "vector");
  Eigen::VectorXd vector(static_cast<Eigen::Index>(items_.size()));
  for (std::size_t i = 0; i < items_.size(); ++i)
    vector(static_cast<Eigen::Index>(i)) = items_[i].as_number();
  return vector;
}

Eigen::Vector3d Value::as_vector3() const {
  if (kind_ != Kind::list || items_.size() != 3) fail(*this, "vector of three numbers");
  return {items_[0].as_number(), items_[1].as_number(), items_[2].as_number()};
}

const std::vector<Value>& Value::items() const {
  if (kind_ != Kind::list) fail(*this, "list");
  return items_;
}

const std::vector<std::pair<std::string, Value>>& Value::entries() const {
  if (kind_ != Kind::map) fail(*this, "map");
  return entries_;
}

bool Value::has(const std::string& key) const { return !(*this)[key].is_null(); }

const Value& Value::operator[](const std::string& key) const {
  static const Value null;
  if (kind_ != Kind::map) fail(*this, "map");
  for (const auto& [name, value] : entries_) {
    if (name == key) return value;
  }
  return null;
}

void Value::set(const std::string& key, Value value) {
  if (kind_ != Kind::map) fail(*this, "map");
  for (auto& [name, old] : entries_) {
    if (name == key) {
      old = std::move(value);
      return;
    }
  }
  entries_.emplace_back(key, std::move(value));
}

std::string Value::yaml() const {
  if (is_flow_list(*this)) return flow_yaml(*this) + "\n";
  if (!is_block(*this)) return scalar_yaml(*this) + "\n";
  std::string text;
  append_block(text, *this, 0);
  return text;
}

}  // namespace vivify
