// What a simulation wrote, for tests of whole scenes.
#pragma once

#include <cmath>
#include <filesystem>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "common/file.h"

namespace vivify::testing_support {

// The columns of sim/steps.csv, by name.
class Steps {
 public:
  explicit Steps(const std::filesystem::path& csv) {
    std::istringstream lines(read_text_file(csv));
    std::string line;
    std::getline(lines, line);
    const std::vector<std::string> names = cells(line);
    while (std::getline(lines, line)) {
      const std::vector<std::string> row = cells(line);
      for (std::size_t i = 0; i < names.size(); ++i) columns_[names[i]].push_back(row.at(i));
    }
  }
  std::size_t size() const { return columns_.at("step").size(); }
  double operator()(const std::string& name, std::size_t row) const {
    return std::stod(columns_.at(name).at(row));
  }
  const std::string& text(const std::string& name, std::size_t row) const {
    return columns_.at(name).at(row);
  }
  double largest(const std::string& name) const {
    double value = -INFINITY;
    for (std::size_t i = 0; i < size(); ++i) value = std::max(value, (*this)(name, i));
    return value;
  }

 private:
  static std::vector<std::string> cells(const std::string& line) {
    std::vector<std::string> result;
    std::istringstream stream(line);
    for (std::string cell; std::getline(stream, cell, ',');) result.push_back(cell);
    return result;
  }
  std::map<std::string, std::vector<std::string>> columns_;
};

// A stretch of steps without any contact.
struct Flight {
  std::size_t first, last;
  double duration, clearance;
};

inline std::vector<Flight> flights(const Steps& steps, double h) {
  std::vector<Flight> found;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (steps("contacts", i) != 0) continue;
    Flight flight{i, i, 0, 0};
    for (; i < steps.size() && steps("contacts", i) == 0; ++i) {
      flight.last = i;
      flight.clearance = std::max(flight.clearance, steps("min_clearance_m", i));
    }
    flight.duration = static_cast<double>(flight.last - flight.first + 1) * h;
    if (i < steps.size()) found.push_back(flight);  // one that ends within the run
  }
  return found;
}

}  // namespace vivify::testing_support
