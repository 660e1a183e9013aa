#include "bench/validation/report.h"

#include <cstdio>
#include <memory>

#include "common/error.h"
#include "common/file.h"

namespace vivify::validation {
namespace {

std::string percent(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2g", value);
  return text;
}

std::string exact(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", value);
  return text;
}

// The commands of one plot, with its data inline.
std::string gnuplot_script(const Plot& plot, const std::filesystem::path& svg) {
  std::string script = "set terminal svg size 720,450 font 'sans-serif,12' background 'white'\n";
  script += "set output '" + svg.string() + "'\nset encoding utf8\nset termoption noenhanced\n";
  script += "set title \"" + plot.title + "\"\nset xlabel \"" + plot.x_label + "\"\nset ylabel \"" +
            plot.y_label + "\"\n";
  script += "set key outside right\nset grid lc rgb '#dddddd'\n";
  if (plot.log_x) script += "set logscale x\nset format x '%g'\n";
  if (plot.log_y) script += "set logscale y\nset format y '%g'\n";
  if (plot.equal_axes) script += "set size ratio -1\n";
  std::string commands;
  int color = 0;
  for (std::size_t k = 0; k < plot.curves.size(); ++k) {
    const Curve& curve = plot.curves[k];
    script += "$c" + std::to_string(k) + " << EOD\n";
    for (std::size_t i = 0; i < curve.x.size(); ++i)
      script += exact(curve.x[i]) + " " + exact(curve.y[i]) + "\n";
    script += "EOD\n";
    commands +=
        (k == 0 ? "plot " : ", ") + ("$c" + std::to_string(k)) + " title \"" + curve.name + "\" with ";
    if (curve.is_reference) {
      commands += "lines lw 1.5 lc rgb '#000000' dt " + std::to_string(k % 3 + 1);
    } else {
      commands += "points ps 0.6 lt " + std::to_string(++color);
    }
  }
  return script + commands + "\n";
}

void draw(const Plot& plot, const std::filesystem::path& svg) {
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen("gnuplot", "w"), pclose);
  const std::string script = gnuplot_script(plot, svg);
  std::filesystem::remove(svg);
  if (pipe != nullptr) std::fwrite(script.data(), 1, script.size(), pipe.get());
}

std::string row(const std::vector<std::string>& cells) {
  std::string line = "|";
  for (const std::string& cell : cells) line += " " + cell + " |";
  return line + "\n";
}

std::string section(const Result& result, const std::string& folder) {
  std::string text = "## " + result.title + "\n\n" + result.text + "\n\n";
  text += "| | ours | reference | error | tolerance |\n|---|---|---|---|---|\n";
  for (const Figure& figure : result.figures) {
    text += row({figure.name, exact(figure.ours), exact(figure.reference), percent(figure.error()),
                 percent(figure.tolerance) + (figure.holds() ? "" : " **missed**")});
  }
  text += "\n";
  for (const Plot& plot : result.plots) {
    text += "![" + plot.title + "](" + folder + "/" + plot.name + ".svg)\n\n";
  }
  for (const Table& table : result.tables) {
    text +=
        table.caption + "\n\n" + row(table.head) + row(std::vector<std::string>(table.head.size(), "---"));
    for (const std::vector<std::string>& cells : table.rows) text += row(cells);
    text += "\n";
  }
  return text;
}

}  // namespace

void write_report(const std::vector<Result>& results, const std::filesystem::path& document) {
  const std::filesystem::path folder = document.parent_path() / document.stem();
  std::filesystem::create_directories(folder);
  std::string text =
      "# Validation of the simulation\n\n"
      "Written by `build/release/bench/validation` (`cmake --build --preset release --target validation`; "
      "needs "
      "`gnuplot-nox`). Every reference is computed by the program itself, without any part of the simulation "
      "(`bench/validation/references.cpp` and the problems beside it), or is a closed form given in the "
      "text; "
      "remembered or printed figures serve as a second source only. The tests `tests/validation` run the "
      "same "
      "problems on smaller meshes and assert their tolerances. Errors and tolerances are relative, or "
      "absolute "
      "where the reference is 0.\n\nWhether the scenes of the cast bear changes of material, friction and "
      "pushes is in "
      "[robustness.md](robustness.md).\n\n";
  for (const Result& result : results) {
    for (const Plot& plot : result.plots) {
      const std::filesystem::path svg = folder / (plot.name + ".svg");
      draw(plot, svg);
      if (!std::filesystem::exists(svg)) {
        throw Error(ErrorKind::usage, "gnuplot did not draw " + plot.name, "install gnuplot-nox");
      }
    }
    text += section(result, folder.filename().string());
  }
  while (text.ends_with("\n\n")) text.pop_back();
  write_file_atomic(document, text);
}

}  // namespace vivify::validation
