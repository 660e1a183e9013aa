#include "meshing/outline.h"

#include <algorithm>

#include "common/error.h"
#include "meshing/glyph.h"
#include "meshing/svg.h"

namespace vivify::meshing {
namespace {

constexpr double kFlatness = 1.0 / 2000;  // of curves, over the diagonal of their box

Points2 loop_of(const Value& points) {
  Points2 loop(static_cast<Eigen::Index>(points.items().size()), 2);
  for (Eigen::Index i = 0; i < loop.rows(); ++i) {
    loop.row(i) = points.items()[static_cast<std::size_t>(i)].as_vector();
  }
  if (loop.rows() < 3) {
    throw Error(ErrorKind::usage, "a polygon needs at least 3 points", "add points", points.where());
  }
  return loop;
}

Outline polygon_outline(const Value& value) {
  const auto given = [&](const char* key) { return value.has(key) && !value[key].items().empty(); };
  if (given("points") == given("loops")) {
    throw Error(ErrorKind::usage, "a polygon needs either points or loops",
                "give `points` for one loop, `loops` for several", value.where());
  }
  std::vector<Points2> loops;
  if (given("points")) {
    loops.push_back(loop_of(value["points"]));
  } else {
    for (const Value& points : value["loops"].items()) loops.push_back(loop_of(points));
  }
  return clean_outline(loops, FillRule::even_odd, "the polygon");
}

// Scales the outline to the given height (if any) and puts it on y = 0 around x = 0.
Outline placed(Outline outline, const Value& height) {
  const Eigen::AlignedBox2d box = box_of(outline.loops);
  const double scale = height.is_null() ? 1 : height.as_number() / box.sizes().y();
  const Eigen::RowVector2d origin(box.center().x(), box.min().y());
  for (Points2& loop : outline.loops) loop = ((loop.rowwise() - origin) * scale).eval();
  return outline;
}

double flatness(const std::vector<CurveContour>& contours) {
  Eigen::AlignedBox2d box;
  for (const CurveContour& contour : contours) box.extend(contour.control_box());
  return kFlatness * box.diagonal().norm();
}

std::vector<Points2> flattened(const std::vector<CurveContour>& contours, double tolerance) {
  std::vector<Points2> loops;
  for (const CurveContour& contour : contours) loops.push_back(contour.flatten(tolerance));
  return loops;
}

Outline svg_outline(const Value& value, const std::filesystem::path& file) {
  const std::string id = value.has("id") ? value["id"].as_string() : "";
  const std::vector<SvgShape> shapes = svg_shapes(file, id);
  std::vector<CurveContour> all;
  for (const SvgShape& shape : shapes) all.insert(all.end(), shape.contours.begin(), shape.contours.end());
  const double tolerance = flatness(all);
  // Each path is filled by its own rule; what they fill is united.
  std::vector<Points2> loops;
  for (const SvgShape& shape : shapes) {
    const FillRule rule = shape.even_odd ? FillRule::even_odd : FillRule::nonzero;
    const std::vector<Points2> filled = fill(flattened(shape.contours, tolerance), rule);
    loops.insert(loops.end(), filled.begin(), filled.end());
  }
  return placed(clean_outline(loops, FillRule::nonzero, file.string()), value["height"]);
}

Outline glyph_outline(const Value& value, const std::filesystem::path& font) {
  const std::string text = value["text"].as_string();
  const std::vector<CurveContour> contours = glyph_contours(font, text);
  const std::string name = "'" + text + "' in " + font.string();
  return placed(clean_outline(flattened(contours, flatness(contours)), FillRule::nonzero, name),
                value["height"]);
}

}  // namespace

Points2 polyline_points(const Value& value) {
  const std::vector<Value>& items = value["points"].items();
  Points2 points(std::ssize(items), 2);
  for (std::size_t i = 0; i < items.size(); ++i) {
    points.row(static_cast<Eigen::Index>(i)) = items[i].as_vector().transpose();
  }
  return points;
}

double Outline::area() const {
  double sum = 0;
  for (const Points2& loop : loops) sum += signed_area(loop);
  return sum;
}

int Outline::corners() const {
  Eigen::Index sum = 0;
  for (const Points2& loop : loops) sum += loop.rows();
  return static_cast<int>(sum);
}

Outline clean_outline(const std::vector<Points2>& contours, FillRule rule, const std::string& name) {
  for (const Points2& contour : contours) {
    if (!contour.allFinite()) {
      throw Error(ErrorKind::geometry, name + " has a point that is not finite", "repair it");
    }
  }
  Outline outline = {fill(contours, rule)};
  if (outline.loops.empty()) {
    throw Error(ErrorKind::geometry, name + " fills no area",
                "its lines lie on top of each other or on one line: give it a loop with an inside");
  }
  return outline;
}

Schema outline_schema() {
  const Schema point = vector("A corner, x and y.", 2).unit("m");
  const Schema points =
      list("Corners of one closed loop; the last is joined with the first.", point).items_at_least(3);
  const auto height = [](const char* without) {
    return number(std::string("Height of the whole outline. Left out: ") + without + ".").unit("m").above(0);
  };
  return variant("The shape of a character in the plane.", "type")
      .option("polygon",
              object("A polygon, or several; where they overlap, every second layer is a hole (even-odd).")
                  .field("points", points)
                  .field("loops", list("Several closed loops, for example an outline and its holes.", points)
                                      .items_at_least(1)))
      .option("svg", object("Paths of an SVG drawing, filled by their fill rule, with the lowest point at "
                            "y = 0 and the middle of the width at x = 0.")
                         .field("file", path("The drawing.").required())
                         .field("id", string("The path or group to take. Left out: all paths."))
                         .field("height", height("a unit of the drawing is a metre")))
      .option("glyph",
              object("Letters of a font, with the lowest point at y = 0 and the middle of the width "
                     "at x = 0.")
                  .field("font", path("A TrueType or OpenType font.").required())
                  .field("text", string("One or more characters, set on one line.").required())
                  .field("height", number("Height of the whole outline.").unit("m").above(0).initially(1)))
      .option("polyline",
              object("An open line, for rods: it has no inside.")
                  .field("points", list("Its points in order.", vector("A point, x and y.", 2).unit("m"))
                                       .items_at_least(2)
                                       .required()));
}

Outline make_outline(const Value& value,
                     const std::function<std::filesystem::path(const std::string&)>& resolve_path) {
  const std::string& type = value["type"].as_string();
  if (type == "polyline") {
    throw Error(ErrorKind::usage, "a polyline has no inside", "give a polygon", value.where());
  }
  if (type == "polygon") return polygon_outline(value);
  if (type == "svg") return svg_outline(value, resolve_path(value["file"].as_string()));
  return glyph_outline(value, resolve_path(value["font"].as_string()));
}

}  // namespace vivify::meshing
