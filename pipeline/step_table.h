// sim/steps.csv, read back.
#pragma once

#include <string>
#include <vector>

namespace vivify::pipeline {

class StepTable {
 public:
  explicit StepTable(const std::string& csv);
  // The values of one column for one body, step by step.
  std::vector<double> column(const std::string& name, const std::string& body) const;

 private:
  std::size_t index(const std::string& name) const;

  std::vector<std::string> columns_;
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace vivify::pipeline
