#include "meshing/outline.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "common/error.h"
#include "common/rng.h"
#include "meshing/glyph.h"
#include "meshing/svg.h"
#include "tests/common/temporary_folder.h"
#include "tests/meshing/plane_shapes.h"

namespace vivify::meshing {
namespace {

using ::testing::HasSubstr;

constexpr const char* kSans = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";

Outline outline_of(const std::string& yaml) {
  return make_outline(shapes::setting(outline_schema(), yaml),
                      [](const std::string& path) { return std::filesystem::path(path); });
}

Outline glyph(const std::string& text, const std::string& more = "") {
  return outline_of("{type: glyph, font: " + std::string(kSans) + ", text: \"" + text + "\"" + more + "}");
}

template <class Work>
std::string message_of(Work work, ErrorKind kind = ErrorKind::geometry) {
  try {
    work();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), kind);
    return error.full_text();
  }
  return "no error";
}

// Area of the contours of path data, each filled by itself.
double path_area(const std::string& data) {
  std::vector<Points2> loops;
  for (const CurveContour& contour : svg_path_contours(data)) loops.push_back(contour.flatten(1e-7));
  double sum = 0;
  for (const Points2& loop : loops) sum += signed_area(loop);
  return sum;
}

int holes(const Outline& outline) {
  int count = 0;
  for (const Points2& loop : outline.loops) count += signed_area(loop) < 0;
  return count;
}

TEST(Outline, PolygonKeepsItsCoordinates) {
  const Outline outline = outline_of("{type: polygon, points: [[1, 0.1], [2, 0.1], [2, 1.7], [1, 1.7]]}");
  ASSERT_EQ(outline.loops.size(), 1U);
  EXPECT_EQ(outline.loops[0], shapes::rectangle({1, 0.1}, {2, 1.7}));
  EXPECT_NEAR(outline.area(), 1.6, 1e-15);
}

TEST(Outline, InnerLoopsAreHoles) {
  const Outline outline = outline_of(
      "{type: polygon, loops: [[[0, 0], [3, 0], [3, 3], [0, 3]], [[1, 1], [2, 1], [2, 2], [1, 2]]]}");
  EXPECT_EQ(outline.loops.size(), 2U);
  EXPECT_EQ(holes(outline), 1);
  EXPECT_NEAR(outline.area(), 8, 1e-14);
}

TEST(Outline, BadPolygonsAreErrors) {
  const auto usage = [](const std::string& yaml) {
    return message_of([&] { outline_of(yaml); }, ErrorKind::usage);
  };
  EXPECT_THAT(usage("{type: polygon}"),
              HasSubstr("s.yaml:1:1: error: a polygon needs either points or loops"));
  EXPECT_THAT(usage("{type: polygon, points: [[0, 0], [1, 1]]}"), HasSubstr("points"));
  EXPECT_THAT(usage("{type: polygon, loops: [[[0, 0], [1, 1]]]}"), HasSubstr("loops"));
  EXPECT_THAT(message_of([] { outline_of("{type: polygon, points: [[0, 0], [1, 1], [2, 2], [1, 1]]}"); }),
              HasSubstr("the polygon fills no area"));
}

TEST(SvgPath, AreasOfEveryCommand) {
  EXPECT_NEAR(path_area("M0 0 L4 0 4 2 0 2 Z"), 8, 1e-12);
  EXPECT_NEAR(path_area("m1,1h4v2h-4z"), 8, 1e-12);
  EXPECT_NEAR(path_area("M1 1H5V3H1Z"), 8, 1e-12);
  // Under the parabola from (0,0) over (1,2) to (2,0): 4/3. Twice by the mirrored control point.
  EXPECT_NEAR(path_area("M0 0Q1 2 2 0Z"), -4.0 / 3, 1e-5);
  EXPECT_NEAR(path_area("M0 0Q1 2 2 0T4 0L4-5H0Z"), -20, 1e-5);
  EXPECT_NEAR(path_area("m0 0q1 2 2 0t2 0l0-5h-4z"), -20, 1e-5);
  // The same parabola as a cubic, and mirrored.
  EXPECT_NEAR(path_area("M0 0C.66666666667 1.33333333333 1.33333333333 1.33333333333 2 0Z"), -4.0 / 3, 1e-5);
  EXPECT_NEAR(path_area("M0 0C0 1 2 1 2 0S4-1 4 0L4-5H0Z"), -20, 1e-5);
  EXPECT_NEAR(path_area("M0 0c0 1 2 1 2 0s2-1 2 0l0-5h-4z"), -20, 1e-5);
  // A circle of two arcs, an ellipse turned by 30 degrees, a quarter that is the small or the large part.
  EXPECT_NEAR(path_area("M-1 0A1 1 0 0 1 1 0 1 1 0 0 1-1 0Z"), std::numbers::pi, 2e-5);
  EXPECT_NEAR(path_area("M-1 0A1 1 0 0 0 1 0A1 1 0 0 0-1 0Z"), -std::numbers::pi, 2e-5);
  EXPECT_NEAR(path_area("M0 0a2 1 30 012 0.5a2 1 30 01-2-.5z"),
              path_area("M0 0a2 1 30 0 1 2 .5a2 1 30 0 1 -2 -.5z"), 1e-12);
  EXPECT_NEAR(path_area("M1 0A1 1 0 0 1 0 1L0 0Z"), std::numbers::pi / 4, 1e-5);
  EXPECT_NEAR(path_area("M1 0A1 1 0 1 1 0-1L0 0Z"), 3 * std::numbers::pi / 4, 1e-5);
  // Radii that are too small grow until the arc fits.
  EXPECT_NEAR(path_area("M-1 0A.1.1 0 0 1 1 0A.1.1 0 0 1-1 0Z"), std::numbers::pi, 2e-5);
}

TEST(SvgPath, SeveralContoursAndImplicitStarts) {
  const std::vector<CurveContour> contours = svg_path_contours("M0 0h1v1zM5 5h1v1zl-1 0 0-1z");
  ASSERT_EQ(contours.size(), 3U);
  EXPECT_EQ(contours[2].start(), Eigen::Vector2d(5, 5));
  EXPECT_EQ(svg_path_contours("m1 1 2 0 0 2z m5 0 1 0 0 1z")[1].start(), Eigen::Vector2d(6, 1));
  EXPECT_TRUE(svg_path_contours("").empty());
}

TEST(SvgPath, ErrorsNameThePosition) {
  const auto message = [](const std::string& data) {
    return message_of([&] { svg_path_contours(data, "path 'a'"); });
  };
  EXPECT_THAT(message("M0 0 L1 1 X2 2"), HasSubstr("path 'a': unknown command 'X' at character 11"));
  EXPECT_THAT(message("L1 1"), HasSubstr("starts with 'L' instead of 'M' at character 1"));
  EXPECT_THAT(message("M0 0 L1"), HasSubstr("a number is missing at character 8"));
  EXPECT_THAT(message("M0 0zz 5"), HasSubstr("a command is missing at character 8"));
  EXPECT_THAT(message("M0 0 a1 1 0 2 0 3 3"), HasSubstr("a flag (0 or 1) is missing at character 13"));
  EXPECT_THAT(message("M0 0 L1e999 0"), HasSubstr("a number is missing"));
}

// Random path data gives contours or an Error(geometry), never anything else.
TEST(SvgPath, AnyTextIsReadOrRejected) {
  static constexpr std::string_view kLetters = "MmLlHhVvCcSsQqTtAaZz0123456789.-+e, #X";
  CounterRng rng(17);
  int read = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    std::string data = trial % 2 == 0 ? "M0 0" : "";
    const double length = rng.uniform(0, 30);
    while (static_cast<double>(data.size()) < length) {
      data += kLetters[static_cast<std::size_t>(rng.uniform(0, static_cast<double>(kLetters.size())))];
    }
    try {
      for (const CurveContour& contour : svg_path_contours(data)) {
        EXPECT_GE(contour.flatten(1e-3).rows(), 1);
      }
      ++read;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::geometry) << data;
    }
  }
  EXPECT_GT(read, 100);
}

class Svg : public ::testing::Test {
 protected:
  Outline outline(const std::string& body, const std::string& more = "") {
    return outline_of("{type: svg, file: " + save(body) + more + "}");
  }
  std::string save(const std::string& body) {
    const std::filesystem::path file = folder_ / "drawing.svg";
    testing_support::write_quickly(
        file, "<?xml version=\"1.0\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\">\n" + body + "\n</svg>\n");
    return file.string();
  }
  testing_support::TemporaryFolder folder_;
};

TEST_F(Svg, IsUprightAndOfTheGivenHeight) {
  // In the drawing, where y points down, the tip is above the base.
  const Outline outline = this->outline("<path d=\"M10 40 L30 40 L20 0 Z\"/>", ", height: 2");
  ASSERT_EQ(outline.loops.size(), 1U);
  EXPECT_LE((outline.loops[0] - shapes::polygon({{-0.5, 0}, {0.5, 0}, {0, 2}})).cwiseAbs().maxCoeff(), 1e-12);
}

TEST_F(Svg, TransformsOfGroupsAndPaths) {
  const Outline outline = this->outline(
      "<g transform=\"translate(5,3) scale(2)\"><g transform=\"rotate(90 1 1)\">"
      "<path transform=\"matrix(1 0 0 3 0 0)\" d=\"M0 0h1v1h-1z\"/></g></g>");
  EXPECT_NEAR(outline.area(), 12, 1e-9);
  const Eigen::Vector2d size = box_of(outline.loops).sizes();
  EXPECT_NEAR(size.x(), 6, 1e-9);
  EXPECT_NEAR(size.y(), 2, 1e-9);
}

TEST_F(Svg, FillRulesOfAttributesAndStyles) {
  const std::string star = " d=\"M0 0h9v9h-9zM3 3h3v3h-3z\"/>";
  EXPECT_NEAR(outline("<path" + star).area(), 81, 1e-6);
  EXPECT_NEAR(outline("<path fill-rule=\"evenodd\"" + star).area(), 72, 1e-6);
  EXPECT_NEAR(outline("<g style=\"fill:#000; fill-rule : evenodd\"><path" + star + "</g>").area(), 72, 1e-6);
}

TEST_F(Svg, TakesOnePathOrGroupById) {
  const std::string body =
      "<defs><path id=\"d\" d=\"M0 0h1v1z\"/></defs><path id=\"a\" d=\"M0 0h2v2h-2z\"/>"
      "<g id=\"b\"><path d=\"M5 0h1v1h-1z\"/><path d=\"M7 0h1v1h-1z\"/></g>";
  EXPECT_NEAR(outline(body, ", id: a").area(), 4, 1e-9);
  EXPECT_NEAR(outline(body, ", id: b").area(), 2, 1e-9);
  EXPECT_NEAR(outline(body).area(), 6, 1e-9);
  EXPECT_NEAR(outline(body, ", id: d").area(), 0.5, 1e-9);
  EXPECT_THAT(message_of([&] { outline(body, ", id: c"); }),
              HasSubstr("has no element with the id 'c' (the ids of its paths: d and a)"));
}

TEST_F(Svg, BadDrawingsAreErrors) {
  const auto message = [&](const std::string& body) { return message_of([&] { outline(body); }); };
  EXPECT_THAT(message("<path id=\"p\" d=\"M0 0h1v1\"/>"),
              HasSubstr("drawing.svg: path 'p' is open: contour 1 starts at (0, 0) and ends at (1, 1)"));
  EXPECT_THAT(message("\n<path d=\"M0 0 B\"/>"), HasSubstr("line 4 of "));
  EXPECT_THAT(message("<rect width=\"3\" height=\"4\"/>"), HasSubstr("has no path"));
  EXPECT_THAT(message("<path d=\"M0 0"), HasSubstr("the file is not XML"));
  EXPECT_THAT(message("<path transform=\"spin(3)\" d=\"M0 0h1v1z\"/>"),
              HasSubstr("'spin' with 1 numbers is not a transform at character 1"));
  EXPECT_EQ(message_of([] { outline_of("{type: svg, file: missing.svg}"); }, ErrorKind::io).find("no error"),
            std::string::npos);
}

TEST(Glyph, LettersHaveTheirHolesAndParts) {
  struct Case {
    const char* text;
    std::size_t loops;
    int holes;
  };
  for (const Case& c : {Case{"I", 1, 0}, Case{"o", 2, 1}, Case{"8", 3, 2}, Case{"i", 2, 0}, Case{"&", 2, 1},
                        Case{"%", 5, 2}, Case{"B", 3, 2}, Case{"Hi", 3, 0}}) {
    const Outline outline = glyph(c.text);
    EXPECT_EQ(outline.loops.size(), c.loops) << c.text;
    EXPECT_EQ(holes(outline), c.holes) << c.text;
    EXPECT_EQ(meeting_edges(outline.loops).first, -1) << c.text;
    EXPECT_GT(outline.area(), 0) << c.text;
  }
}

TEST(Glyph, HeightAndPlace) {
  const Outline outline = glyph("g", ", height: 0.4");
  const Eigen::AlignedBox2d box = box_of(outline.loops);
  EXPECT_NEAR(box.sizes().y(), 0.4, 1e-12);
  EXPECT_NEAR(box.min().y(), 0, 1e-15);
  EXPECT_NEAR(box.center().x(), 0, 1e-12);
}

// The letter o of this font is nearly two ellipses.
TEST(Glyph, CurvesAreCloseToWhatTheyDraw) {
  const Outline outline = glyph("o");
  const Eigen::Vector2d outer = box_of(outline.loops[0]).sizes(), inner = box_of(outline.loops[1]).sizes();
  const double ellipses = std::numbers::pi / 4 * (outer.prod() - inner.prod());
  EXPECT_NEAR(outline.area() / ellipses, 1, 0.15);
  EXPECT_GT(outline.corners(), 30);
}

TEST(Glyph, BadFontsAndTextsAreErrors) {
  EXPECT_THAT(message_of([] { glyph("𒀀"); }), HasSubstr("has no glyph for '𒀀' (U+012000)"));
  EXPECT_THAT(message_of([] { glyph(" "); }), HasSubstr("draws nothing"));
  EXPECT_THAT(message_of([] { outline_of("{type: glyph, font: /dev/null, text: a}"); }),
              HasSubstr("/dev/null is not a font that can be read"));
  EXPECT_THAT(message_of([] { outline_of("{type: glyph, font: none.ttf, text: a}"); }, ErrorKind::io),
              HasSubstr("none.ttf"));
  EXPECT_THAT(message_of([] { glyph_contours(kSans, "a\xff"); }, ErrorKind::usage),
              HasSubstr("not UTF-8 at byte 2"));
}

}  // namespace
}  // namespace vivify::meshing
