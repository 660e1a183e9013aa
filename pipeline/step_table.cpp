#include "pipeline/step_table.h"

#include <algorithm>
#include <sstream>

namespace vivify::pipeline {
namespace {

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream stream(line);
  for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
  return cells;
}

}  // namespace

StepTable::StepTable(const std::string& csv) {
  std::istringstream lines(csv);
  std::string line;
  std::getline(lines, line);
  columns_ = split(line);
  while (std::getline(lines, line)) rows_.push_back(split(line));
}

std::vector<double> StepTable::column(const std::string& name, const std::string& body) const {
  std::vector<double> values;
  const std::size_t value = index(name), owner = index("body");
  for (const std::vector<std::string>& row : rows_) {
    if (row.at(owner) == body) values.push_back(std::stod(row.at(value)));
  }
  return values;
}

std::size_t StepTable::index(const std::string& name) const {
  return static_cast<std::size_t>(std::find(columns_.begin(), columns_.end(), name) - columns_.begin());
}

}  // namespace vivify::pipeline
