// Small text helpers.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace vivify {

// The candidate with the smallest edit distance to `word`, or "" when none is near enough to be meant.
std::string nearest_word(std::string_view word, const std::vector<std::string>& candidates);

// Shortest decimal text that reads back as the same double: "0.1", "1e-09", "3"; whole numbers below 1e9 in
// full.
std::string number_text(double value);

// "a, b and c".
std::string join_words(const std::vector<std::string>& words, std::string_view last = "and");

}  // namespace vivify
