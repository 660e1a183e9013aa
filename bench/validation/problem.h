// Validation problems: each computes figures and curves of the simulation beside references that do not come
// from it. The tests assert the tolerances; the program `validation` writes docs/validation.md from them.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace vivify::validation {

// One number beside its reference. `tolerance` is relative to the reference, or absolute when that is 0.
struct Figure {
  std::string name;
  double ours = 0;
  double reference = 0;
  double tolerance = 0;

  double error() const;
  bool holds() const { return error() <= tolerance; }  // false for NaN
};

// The largest of some errors; infinite when one is not a number.
struct Largest {
  double value = 0;
  void add(double error);
};

struct Curve {
  std::string name;
  std::vector<double> x = {}, y = {};
  bool is_reference = false;  // drawn as a line; ours as points

  void add(double x_value, double y_value) {
    x.push_back(x_value);
    y.push_back(y_value);
  }
};

struct Plot {
  std::string name;  // of the file
  std::string title, x_label, y_label;
  bool log_x = false, log_y = false;
  bool equal_axes = false;
  std::vector<Curve> curves = {};
};

struct Table {
  std::string caption;
  std::vector<std::string> head;
  std::vector<std::vector<std::string>> rows = {};
};

struct Result {
  std::string title;
  std::string text;  // what is solved, and where the reference comes from (Markdown)
  std::vector<Figure> figures;
  std::vector<Table> tables;
  std::vector<Plot> plots;

  void figure(std::string name, double ours, double reference, double tolerance) {
    figures.push_back({std::move(name), ours, reference, tolerance});
  }
};

// `quick`: what the tests run; `full`: with the long sweeps of the document. Both hold the same tolerances.
enum class Effort { quick, full };

struct ProblemEntry {
  std::string_view name;
  Result (*run)(Effort effort);
};

// Every problem, in the order of the document. A new one is a file here and a line in this table.
std::span<const ProblemEntry> problems();

Result derivatives(Effort effort);
Result elimination(Effort effort);
Result patch(Effort effort);
Result rest_invariance(Effort effort);
Result flight(Effort effort);
Result integrator(Effort effort);
Result cantilever(Effort effort);
Result large_deflection(Effort effort);
Result buckling(Effort effort);
Result inversion(Effort effort);
Result interpolation(Effort effort);
Result slope(Effort effort);
Result stopping(Effort effort);
Result resting(Effort effort);
Result impact(Effort effort);
Result corner_cases(Effort effort);
Result arch(Effort effort);
Result card_house(Effort effort);

// A number with four significant digits.
std::string short_number(double value);

}  // namespace vivify::validation
