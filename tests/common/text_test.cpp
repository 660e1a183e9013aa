#include "common/text.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "common/rng.h"

namespace vivify {
namespace {

TEST(NearestWord, FindsWhatWasMeant) {
  const std::vector<std::string> keys = {"density", "stiffness", "position", "heading_deg", "fps", "spp"};
  EXPECT_EQ(nearest_word("densty", keys), "density");
  EXPECT_EQ(nearest_word("Density", keys), "density");
  EXPECT_EQ(nearest_word("heading-deg", keys), "heading_deg");
  EXPECT_EQ(nearest_word("headnig_deg", keys), "heading_deg");
  EXPECT_EQ(nearest_word("pos", keys), "position");
  EXPECT_EQ(nearest_word("fsp", keys), "fps");
  EXPECT_EQ(nearest_word("bodys", {"camera", "bodies"}), "bodies");
}

TEST(NearestWord, SaysNothingWhenNothingIsNear) {
  const std::vector<std::string> keys = {"density", "x", "fps"};
  EXPECT_EQ(nearest_word("camera", keys), "");
  EXPECT_EQ(nearest_word("y", keys), "");
  EXPECT_EQ(nearest_word("", keys), "");
  EXPECT_EQ(nearest_word("density", {}), "");
}

TEST(NumberText, ReadsBackAsTheSameNumber) {
  CounterRng rng(7);
  for (int i = 0; i < 20000; ++i) {
    const double value = std::bit_cast<double>(rng.next());
    if (!std::isfinite(value)) continue;
    const std::string text = number_text(value);
    ASSERT_EQ(std::bit_cast<std::uint64_t>(std::strtod(text.c_str(), nullptr)),
              std::bit_cast<std::uint64_t>(value))
        << text;
  }
}

TEST(NumberText, IsWhatAPersonWouldWrite) {
  EXPECT_EQ(number_text(0.1), "0.1");
  EXPECT_EQ(number_text(1e-9), "1e-09");
  EXPECT_EQ(number_text(3), "3");
  EXPECT_EQ(number_text(-3), "-3");
  EXPECT_EQ(number_text(100000), "100000");
  EXPECT_EQ(number_text(1e20), "1e+20");
  EXPECT_EQ(number_text(0), "0");
  EXPECT_EQ(number_text(std::numeric_limits<double>::infinity()), "inf");
  EXPECT_EQ(number_text(-std::numeric_limits<double>::quiet_NaN()), "nan");
}

TEST(JoinWords, Joins) {
  EXPECT_EQ(join_words({}), "");
  EXPECT_EQ(join_words({"a"}), "a");
  EXPECT_EQ(join_words({"a", "b"}, "or"), "a or b");
  EXPECT_EQ(join_words({"a", "b", "c"}), "a, b and c");
}

}  // namespace
}  // namespace vivify
