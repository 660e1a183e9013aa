#include "common/hash.h"

#include <gtest/gtest.h>

#include <set>
#include <span>

namespace vivify {
namespace {

TEST(Hasher, BoundariesOfThePartsCount) {
  EXPECT_NE(Hasher().add("ab").add("c").hex(), Hasher().add("a").add("bc").hex());
  EXPECT_NE(Hasher().add("abc").hex(), Hasher().add("abc").add("").hex());
  EXPECT_EQ(Hasher().add("ab").add("c").hex(), Hasher().add("ab").add("c").hex());
}

TEST(Hasher, GivesDistinctLowerCaseHexadecimals) {
  std::set<std::string> seen;
  for (int i = 0; i < 1000; ++i) {
    const std::string hex = Hasher().add(std::to_string(i)).hex();
    EXPECT_EQ(hex.size(), 32U);
    EXPECT_EQ(hex.find_first_not_of("0123456789abcdef"), std::string::npos);
    seen.insert(hex);
  }
  EXPECT_EQ(seen.size(), 1000U);
}

TEST(HashHex, IsTheHashOfOnePart) {
  const std::string text = "content";
  EXPECT_EQ(hash_hex(std::as_bytes(std::span(text))), Hasher().add(text).hex());
  EXPECT_NE(hash_hex({}), Hasher().hex());
}

}  // namespace
}  // namespace vivify
