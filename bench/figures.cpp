// Compares the interpolations of Figures 4 and 5 in the output folders of their scenes, prints what it finds,
// and with a third argument writes the document with the tables.
#include <cstdio>
#include <numeric>

#include "bench/figures/blends.h"
#include "common/error.h"
#include "common/file.h"

namespace vivify::figures {
namespace {

constexpr int kColumns = 10;  // weights in a row of the table
constexpr double kBarLimit = 0.01, kTubeLimit = 0.05, kEdgeLimit = 0.01;

std::string percent(double share, int digits = 2) {
  char text[32];
  std::snprintf(text, sizeof text, "%.*f", digits, 100 * share);
  return text;
}
std::string plain(double value, const char* format = "%.2f") {
  char text[32];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

// One number of every frame, in % of one, a row for every ten weights.
std::string table(const Blend& blend, double BlendFrame::*value, int digits) {
  std::string text = "| weights |";
  for (int k = 0; k < kColumns; ++k) text += k == 0 ? " first |" : " +" + std::to_string(k) + " |";
  text += "\n|---|";
  for (int k = 0; k < kColumns; ++k) text += "---|";
  text += "\n";
  for (std::size_t row = 0; row < blend.frames.size(); row += kColumns) {
    const std::size_t end = std::min(row + kColumns, blend.frames.size());
    text += "| " + plain(blend.frames[row].weight) + " … " + plain(blend.frames[end - 1].weight) + " |";
    for (std::size_t i = row; i < end; ++i) text += " " + percent(blend.frames[i].*value, digits) + " |";
    text += "\n";
  }
  return text;
}

std::string mean(const Blend& blend, double BlendFrame::*value) {
  const double sum = std::accumulate(blend.frames.begin(), blend.frames.end(), 0.0,
                                     [&](double s, const BlendFrame& frame) { return s + frame.*value; });
  return percent(sum / static_cast<double>(blend.frames.size()));
}

std::string line(const Blend& blend, const std::string& what, double BlendFrame::*value, double limit) {
  const BlendFrame& frame = worst(blend, value);
  return "| " + what + " | " + percent(frame.*value) + " % | at weight " + plain(frame.weight) + " | " +
         (limit > 0 ? percent(limit, 0) + " %" : "") + " |\n";
}

constexpr const char* kIntroduction =
    R"(# Figures 4 and 5: interpolation of poses

Section 5.3 of Coros et al. 2012 compares the incompatible interpolation of poses, element by element, with interpolation
in strain space. Here both are made in one scene from the same mesh with the same two poses: `rest_space: examples` (ours,
blue) and `rest_space: strains` (the reference, yellow), each reconstructed as the equilibrium of its rest shape
(`physics: static`) with the same elastic model. The poses themselves are orange. Distances are those of vertices after
the best rigid alignment of the two shapes, over the length of the body at rest.

Made by `figures out/figure4 out/figure5 docs/figures.md` (`bench/`) from the output of

```sh
./bootstrap run configs/figure4.yaml
./bootstrap run configs/figure5.yaml
```

The pictures show the weights 0, 1/3, 2/3 and 1 (`vivify sheet` of the frames 1, 34, 67 and 100).

)";

constexpr const char* kBar = R"(## Figure 4: a bar from straight to twisted

![The bar at four weights](images/figure4.png)

A bar of 16 : 3 whose upper end was turned by 270 degrees with the static solver (`assets/figure4/twist.yaml`). The
reference is the closest shape in Green strain (Martin et al. 2011).
)";

constexpr const char* kTube = R"(
## Figure 5: a tube from straight to a helix

![The tube at four weights](images/figure5.png)

A tube bent round a helix of two turns without twisting it (`assets/figure5/make_tubes.py`). The reference is the closest
shape in edge lengths and dihedral angles (Fröhlich and Botsch 2011). Errors of edges are those against the length
interpolated between the poses.
)";

std::string document(const Blend& bar, const Blend& tube) {
  const auto head = [](const Blend& blend, const std::string& elements) {
    return std::to_string(blend.vertices) + " vertices, " + std::to_string(blend.elements) + " " + elements +
           ", " + std::to_string(blend.frames.size()) + " weights from " +
           plain(blend.frames.front().weight) + " to " + plain(blend.frames.back().weight) +
           ".\n\n| largest | value | where | limit |\n|---|---|---|---|\n";
  };
  const auto distances = [](const Blend& blend) {
    return "\nThe mean distance is " + mean(blend, &BlendFrame::distance) + " %. At weight 1 ours is " +
           plain(blend.end_distance, "%.1g") +
           " of the length away from the pose itself.\n\nDistance at every weight, in % of the length:\n\n" +
           table(blend, &BlendFrame::distance, 2);
  };
  return kIntroduction + (kBar + head(bar, "tetrahedra")) +
         line(bar, "distance of the two shapes", &BlendFrame::distance, kBarLimit) + distances(bar) +
         (kTube + head(tube, "triangles")) +
         line(tube, "distance of the two shapes", &BlendFrame::distance, kTubeLimit) +
         line(tube, "error of an edge, ours", &BlendFrame::first_edges, kEdgeLimit) +
         line(tube, "error of an edge, reference", &BlendFrame::second_edges, 0) + distances(tube) +
         "\nLargest error of an edge at every weight, ours, in % of its length:\n\n" +
         table(tube, &BlendFrame::first_edges, 2);
}

int run(int argc, char** argv) {
  if (argc < 3 || argc > 4) {
    std::fprintf(stderr, "usage: figures FOLDER_OF_FIGURE_4 FOLDER_OF_FIGURE_5 [DOCUMENT]\n");
    return 2;
  }
  const Blend bar = compare_blends(argv[1], "ours", "reference"),
              tube = compare_blends(argv[2], "ours", "reference");
  const double bar_distance = worst(bar, &BlendFrame::distance).distance,
               tube_distance = worst(tube, &BlendFrame::distance).distance,
               edges = worst(tube, &BlendFrame::first_edges).first_edges;
  std::printf("figure 4: %zu weights, distance %s %%, end %.2g\n", bar.frames.size(),
              percent(bar_distance, 3).c_str(), bar.end_distance);
  std::printf("figure 5: %zu weights, distance %s %%, edges %s %% (reference %s %%), end %.2g\n",
              tube.frames.size(), percent(tube_distance, 3).c_str(), percent(edges, 3).c_str(),
              percent(worst(tube, &BlendFrame::second_edges).second_edges, 3).c_str(), tube.end_distance);
  if (argc == 4) write_file_atomic(argv[3], document(bar, tube));
  return bar_distance <= kBarLimit && tube_distance <= kTubeLimit && edges <= kEdgeLimit ? 0 : 1;
}

}  // namespace
}  // namespace vivify::figures

int main(int argc, char** argv) {
  try {
    return vivify::figures::run(argc, argv);
  } catch (const vivify::Error& error) {
    std::fprintf(stderr, "%s\n", error.full_text().c_str());
    return exit_code(error.kind());
  }
}
