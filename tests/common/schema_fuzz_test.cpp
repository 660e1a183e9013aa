// Deterministic mutations of a valid scene: whatever the text, the answer is a value or errors with a place.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "common/rng.h"
#include "common/schema.h"
#include "tests/common/sample_schema.h"

namespace vivify {
namespace {

std::string mutated(std::string text, CounterRng& rng) {
  static const std::vector<std::string> kPieces = {"&a ",
                                                   "*a",
                                                   "---",
                                                   "...",
                                                   "[",
                                                   "]",
                                                   "{",
                                                   "}",
                                                   ": ",
                                                   "- ",
                                                   "<<: ",
                                                   "'",
                                                   "\"",
                                                   "|",
                                                   ">",
                                                   "#",
                                                   "!",
                                                   "!!int ",
                                                   "%",
                                                   "@",
                                                   "`",
                                                   "\t",
                                                   "\n",
                                                   "\r\n",
                                                   "  ",
                                                   "010",
                                                   "~",
                                                   "null",
                                                   "nan",
                                                   "-.inf",
                                                   "1e999",
                                                   "\xff",
                                                   std::string(1, '\0'),
                                                   "\xEF\xBB\xBF",
                                                   "? ",
                                                   "é",
                                                   "-3",
                                                   "99999999999999999999",
                                                   "?",
                                                   ",",
                                                   "\\",
                                                   "\\x",
                                                   "&",
                                                   "*",
                                                   "type: x",
                                                   "name: cup"};
  const std::uint64_t edits = 1 + rng.next() % 4;
  for (std::uint64_t i = 0; i < edits; ++i) {
    const std::size_t at = rng.next() % (text.size() + 1);
    const std::size_t length = std::min<std::size_t>(rng.next() % 12, text.size() - at);
    switch (rng.next() % 6) {
      case 0:
        text.erase(at, length);
        break;
      case 1:
        text.insert(at, kPieces[rng.next() % kPieces.size()]);
        break;
      case 2:
        text.replace(at, length, kPieces[rng.next() % kPieces.size()]);
        break;
      case 3:
        text.insert(at, text.substr(rng.next() % text.size(), length * 8));
        break;
      case 4:
        if (at < text.size()) text[at] = static_cast<char>(rng.next());
        break;
      default:
        if (rng.next() % 8 == 0) text.resize(at);
        break;
    }
    if (text.empty()) text = "a";
  }
  return text;
}

TEST(SchemaFuzz, EveryMutationGivesAValueOrErrorsWithAPlace) {
  const Schema schema = testing_support::sample_schema();
  CounterRng rng(2012);
  int valid = 0, invalid = 0;
  for (int i = 0; i < 2000; ++i) {
    const std::string text = mutated(testing_support::sample_scene(), rng);
    std::vector<Error> errors;
    const ConfigNode root = parse_yaml(text, "s.yaml", errors);
    const Value value = resolve(schema, root, errors);
    for (const Error& error : errors) {
      EXPECT_EQ(error.kind(), ErrorKind::usage);
      EXPECT_EQ(error.where().file, "s.yaml");
      EXPECT_GT(error.where().line, 0) << error.full_text() << "\n" << text;
      EXPECT_GT(error.where().column, 0) << error.full_text() << "\n" << text;
    }
    (errors.empty() ? valid : invalid) += 1;
    if (!errors.empty()) continue;
    const std::string once = value.yaml();
    const Value again = resolve(schema, parse_yaml(once, "s.yaml", errors), errors);
    ASSERT_TRUE(errors.empty()) << errors.front().full_text() << "\n" << once;
    EXPECT_EQ(again.yaml(), once);
  }
  EXPECT_GT(valid, 100);
  EXPECT_GT(invalid, 1000);
}

}  // namespace
}  // namespace vivify
