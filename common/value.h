// A setting after it was checked against its schema: every default filled in, every key known, each with its place in
// the file. Access never fails for what the schema promises; asking for something else is a defect (Error(internal)).
#pragma once

#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>

#include "common/error.h"

namespace vivify {

class Value {
 public:
  enum class Kind { null, boolean, integer, number, string, list, map };

  Value() = default;
  static Value boolean(bool v);
  static Value integer(long v);
  static Value number(double v);
  static Value string(std::string v);
  static Value list(std::vector<Value> items);
  static Value map(std::vector<std::pair<std::string, Value>> entries = {});

  Kind kind() const { return kind_; }
  bool is_null() const { return kind_ == Kind::null; }
  bool as_bool() const;
  long as_integer() const;
  double as_number() const;  // integers too
  const std::string& as_string() const;
  Eigen::VectorXd as_vector() const;   // a list of numbers
  Eigen::Vector3d as_vector3() const;  // a list of three numbers

  const std::vector<Value>& items() const;                           // of a list
  const std::vector<std::pair<std::string, Value>>& entries() const;  // of a map, in the order of the schema
  bool has(const std::string& key) const;                             // present and not null
  const Value& operator[](const std::string& key) const;              // of a map; null when absent
  void set(const std::string& key, Value value);                      // of a map; adds or replaces

  const Location& where() const { return where_; }
  void set_where(Location where) { where_ = std::move(where); }

  // The value as YAML text (block style, numbers that read back exactly); the same value gives the same bytes.
  std::string yaml() const;

 private:
  Kind kind_ = Kind::null;
  bool bool_ = false;
  long integer_ = 0;
  double number_ = 0;
  std::string string_;
  std::vector<Value> items_;
  std::vector<std::pair<std::string, Value>> entries_;
  Location where_;
};

}  // namespace vivify
