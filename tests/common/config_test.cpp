#include "common/config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace vivify {
namespace {

using ::testing::HasSubstr;

std::vector<std::string> errors_of(const std::string& text) {
  std::vector<Error> errors;
  parse_yaml(text, "s.yaml", errors);
  std::vector<std::string> texts;
  for (const Error& error : errors) {
    EXPECT_EQ(error.kind(), ErrorKind::usage);
    texts.push_back(error.full_text());
  }
  return texts;
}

ConfigNode parse(const std::string& text) {
  std::vector<Error> errors;
  ConfigNode root = parse_yaml(text, "s.yaml", errors);
  for (const Error& error : errors) ADD_FAILURE() << error.full_text();
  return root;
}

const ConfigNode& at(const ConfigNode& node, const std::string& key) {
  for (const ConfigNode::Entry& entry : node.entries) {
    if (entry.key == key) return entry.value;
  }
  throw std::runtime_error("no key " + key);
}

void expect_place(const Location& where, int line, int column) {
  EXPECT_EQ(where.file, "s.yaml");
  EXPECT_EQ(where.line, line);
  EXPECT_EQ(where.column, column);
}

TEST(ParseYaml, KeepsThePlaceOfEveryKeyAndValue) {
  const ConfigNode root = parse(
      "# comment\n"
      "a: 1\n"
      "list:\n"
      "  - x: [5, '6']\n"
      "    é: ü  \n"
      "ä: {b: 7}\n");
  expect_place(root.where, 2, 1);
  expect_place(root.entries[0].key_where, 2, 1);
  expect_place(at(root, "a").where, 2, 4);
  const ConfigNode& item = at(root, "list").items.at(0);
  expect_place(item.where, 4, 5);
  expect_place(at(item, "x").items[0].where, 4, 9);
  expect_place(at(item, "x").items[1].where, 4, 12);
  EXPECT_FALSE(at(item, "x").items[0].quoted);
  EXPECT_TRUE(at(item, "x").items[1].quoted);
  EXPECT_EQ(at(item, "x").items[1].scalar, "6");
  expect_place(at(item, "é").where, 5, 8);  // columns count characters, not bytes
  expect_place(at(at(root, "ä"), "b").where, 6, 8);
}

TEST(ParseYaml, PlacesHoldWithByteOrderMarkAndCarriageReturns) {
  const ConfigNode root = parse(
      "\xEF\xBB\xBF"
      "a: 1\r\nb:\r\n  c: 2\r\n");
  expect_place(at(root, "a").where, 1, 4);
  expect_place(at(at(root, "b"), "c").where, 3, 6);
  EXPECT_EQ(at(at(root, "b"), "c").scalar, "2");
}

TEST(ParseYaml, AKeyWithoutValueIsNullAtItsKey) {
  const ConfigNode root = parse("a:\nb: ~\nc: null\nd: 'null'\ne: ''\n");
  EXPECT_EQ(at(root, "a").kind, ConfigNode::Kind::null);
  expect_place(at(root, "a").where, 1, 1);
  EXPECT_EQ(at(root, "b").kind, ConfigNode::Kind::null);
  EXPECT_EQ(at(root, "c").kind, ConfigNode::Kind::null);
  EXPECT_EQ(at(root, "d").kind, ConfigNode::Kind::scalar);
  EXPECT_EQ(at(root, "e").kind, ConfigNode::Kind::scalar);
}

TEST(ParseYaml, EmptyTextIsNullAtTheFirstLine) {
  for (const char* text : {"", "\n\n", "# only a comment\n"}) {
    const ConfigNode root = parse(text);
    EXPECT_EQ(root.kind, ConfigNode::Kind::null);
    EXPECT_EQ(root.where.line, 1);
  }
}

TEST(ParseYaml, AnchorsAndAliasesOfWholeValuesWork) {
  const ConfigNode root = parse("a: &x {b: 1}\nc: *x\n");
  EXPECT_EQ(at(at(root, "c"), "b").scalar, "1");
  expect_place(at(at(root, "c"), "b").where, 1, 11);  // where it is written
}

TEST(YamlTraps, DuplicateKeysNameBothPlaces) {
  EXPECT_THAT(errors_of("a: 1\nb:\n  c: 1\n  d: 2\n  c: 3\n"),
              ::testing::ElementsAre("s.yaml:5:3: error: duplicate key 'c' (it stands at 3:3 already)"));
  EXPECT_THAT(errors_of("{a: 1, 'a': 2}\n"),
              ::testing::ElementsAre(HasSubstr("s.yaml:1:8: error: duplicate key 'a'")));
}

TEST(YamlTraps, SecondDocument) {
  EXPECT_THAT(errors_of("a: 1\n---\nb: 2\n"),
              ::testing::ElementsAre(HasSubstr("s.yaml:2:1: error: a second document")));
  EXPECT_THAT(errors_of("---\na: 1\n---\n"),
              ::testing::ElementsAre(HasSubstr("s.yaml:3:1: error: a second document")));
  EXPECT_TRUE(errors_of("---\na: 1\n").empty());
  EXPECT_TRUE(errors_of("a: 1\n...\n").empty());
  EXPECT_TRUE(errors_of("a: '--- no document'\n").empty());
  EXPECT_TRUE(errors_of("a: |\n  ---\n  text\n").empty());
}

TEST(YamlTraps, SelfReference) {
  EXPECT_THAT(
      errors_of("a: &x [1, *x]\n"),
      ::testing::ElementsAre(HasSubstr("s.yaml:1:11: error: this alias refers to the node it stands in")));
  EXPECT_THAT(errors_of("a: &x\n  b:\n    c: *x\n"),
              ::testing::ElementsAre(HasSubstr("s.yaml:3:8: error: this alias")));
}

TEST(YamlTraps, LeadingZeros) {
  EXPECT_THAT(errors_of("a: 010\n"),
              ::testing::ElementsAre(HasSubstr("s.yaml:1:4: error: the number 010 begins with 0")));
  EXPECT_THAT(errors_of("a: [1, -07]\n"),
              ::testing::ElementsAre(HasSubstr("s.yaml:1:8: error: the number -07")));
  EXPECT_TRUE(errors_of("a: [0, 0.5, -0, 00.5, '010', 10]\n").empty());
}

TEST(YamlTraps, MergeKeys) {
  EXPECT_THAT(errors_of("a: &x {b: 1}\nc:\n  <<: *x\n  d: 1\n"),
              ::testing::ElementsAre(HasSubstr("s.yaml:3:3: error: merge keys (<<) are not supported")));
}

TEST(YamlTraps, TagsAndStrangeKeys) {
  EXPECT_THAT(errors_of("a: !!int 5\n"),
              ::testing::ElementsAre(HasSubstr("error: YAML tags are not supported")));
  EXPECT_THAT(errors_of("a: !cup {b: 1}\n"),
              ::testing::ElementsAre(HasSubstr("error: YAML tags are not supported")));
  EXPECT_THAT(errors_of("? [1, 2]\n: 3\n"),
              ::testing::ElementsAre(HasSubstr("s.yaml:1:3: error: a key must be a word")));
  EXPECT_THAT(errors_of("a: 1\n: 3\n"), ::testing::ElementsAre(HasSubstr("s.yaml:2:1: error: ")));
  EXPECT_THAT(errors_of("a: &x k\n*x : 3\n"),
              ::testing::ElementsAre(HasSubstr("s.yaml:2:1: error: an alias cannot be a key")));
}

TEST(YamlTraps, SyntaxErrorsHaveAPlace) {
  EXPECT_THAT(errors_of("a: 1\nb: [1, 2\nc: 3\n"),
              ::testing::ElementsAre(::testing::ContainsRegex("^s.yaml:[23]:[0-9]+: error: ")));
  EXPECT_THAT(errors_of("a: 'x\n"),
              ::testing::ElementsAre(::testing::ContainsRegex("^s.yaml:[12]:[0-9]+: error: ")));
  EXPECT_THAT(errors_of("a: *nowhere\n"), ::testing::ElementsAre(HasSubstr("s.yaml:1:4: error: ")));
  EXPECT_THAT(errors_of("a: 1\n}\n"),
              ::testing::ElementsAre(::testing::ContainsRegex("^s.yaml:2:[0-9]+: error: ")));
}

TEST(YamlTraps, SyntaxErrorsSpeakPlainly) {
  const auto only = [](const std::string& text) { return ::testing::ElementsAre(text); };
  EXPECT_THAT(errors_of("b: [1, 2\nc: 3\n"),
              only("s.yaml:2:2: error: a '[' before this place is not closed"));
  EXPECT_THAT(errors_of("a: {b: 1\nc: 2\n"),
              only("s.yaml:2:2: error: a '{' before this place is not closed"));
  EXPECT_THAT(errors_of("a: [1]]\n"), only("s.yaml:1:7: error: this bracket closes nothing"));
  EXPECT_THAT(errors_of("a:\n\tb: 1\n"),
              only("s.yaml:2:3: error: a tab stands where YAML wants spaces (indent with spaces)"));
  EXPECT_THAT(errors_of("a:\n  b: 1\n c: 2\n"),
              only("s.yaml:3:2: error: this line does not fit the ones before (check the indentation)"));
  EXPECT_THAT(errors_of("a: @x\n"),
              only("s.yaml:1:4: error: a text cannot begin with this character (put it in quotes)"));
}

TEST(YamlTraps, AllProblemsOfAFileInOneGo) {
  const std::vector<std::string> errors = errors_of("a: 010\na: 2\nb: &x [*x]\nc: {<<: 1}\n---\nd: 1\n");
  ASSERT_EQ(errors.size(), 5U);
  for (int i = 0; i < 5; ++i)
    EXPECT_THAT(errors[i], ::testing::StartsWith("s.yaml:" + std::to_string(i + 1) + ":"));
}

TEST(YamlTraps, NestingBombsAreErrors) {
  EXPECT_EQ(errors_of(std::string(20000, '[')).size(), 1U);
  EXPECT_EQ(errors_of(std::string(20000, '{')).size(), 1U);
  EXPECT_EQ(errors_of("a: " + std::string(150, '[') + std::string(150, ']')).size(), 1U);
  EXPECT_TRUE(errors_of("a: " + std::string(50, '[') + std::string(50, ']')).empty());
  std::string deep;
  for (int i = 0; i < 5000; ++i) deep += std::string(static_cast<std::size_t>(i), ' ') + "a:\n";
  EXPECT_EQ(errors_of(deep).size(), 1U);
}

TEST(YamlTraps, AliasBombsAreErrors) {
  std::string wide = "a0: &a0 [1, 2, 3, 4, 5, 6, 7, 8, 9, 10]\n", tall = "a0: &a0 [[[[[[[[[[1]]]]]]]]]]\n";
  for (int i = 1; i < 12; ++i) {
    const std::string name = "a" + std::to_string(i), last = "*a" + std::to_string(i - 1);
    wide += name + ": &" + name + " [" + last + ", " + last + ", " + last + ", " + last + ", " + last + ", " +
            last + "]\n";
    tall += name + ": &" + name + " [[[[[[[[[[" + last + "]]]]]]]]]]\n";
  }
  ASSERT_EQ(errors_of(wide).size(), 1U);
  EXPECT_THAT(errors_of(wide)[0], HasSubstr("more than 1000000 values"));
  ASSERT_EQ(errors_of(tall).size(), 1U);
  EXPECT_THAT(errors_of(tall)[0], HasSubstr("nested more than 100 deep"));
}

const std::string kScene =
    "frames: {fps: 24}\n"
    "bodies:\n"
    "  - {name: cup, material: {density: 1}}\n"
    "  - {name: bowl}\n"
    "empty:\n";

TEST(ApplyOverride, ReachesByKeyIndexAndName) {
  ConfigNode root = parse(kScene);
  apply_override(root, "frames.fps=30");
  apply_override(root, "bodies[0].material.density=2");
  EXPECT_EQ(at(root, "frames").entries[0].value.scalar, "30");
  EXPECT_EQ(at(at(at(root, "bodies").items[0], "material"), "density").scalar, "2");
  apply_override(root, "bodies.cup.material.density=3");
  EXPECT_EQ(at(at(at(root, "bodies").items[0], "material"), "density").scalar, "3");
  apply_override(root, "bodies.1.position=[1, 2, 3]");
  EXPECT_EQ(at(at(root, "bodies").items[1], "position").items.size(), 3U);
  EXPECT_EQ(at(at(root, "bodies").items[1], "position").items[2].where.text(), "--set");
}

TEST(ApplyOverride, MakesMapsOnTheWay) {
  ConfigNode root = parse(kScene);
  apply_override(root, "render.size.width=480");
  EXPECT_EQ(at(at(at(root, "render"), "size"), "width").scalar, "480");
  apply_override(root, "empty.a={b: 1}");
  EXPECT_EQ(at(at(at(root, "empty"), "a"), "b").scalar, "1");
  ConfigNode nothing;
  apply_override(nothing, "a.b=1");
  EXPECT_EQ(at(at(nothing, "a"), "b").scalar, "1");
  apply_override(root, "frames.fps=");
  EXPECT_EQ(at(at(root, "frames"), "fps").kind, ConfigNode::Kind::null);
  apply_override(root, "title='a=b'");
  EXPECT_EQ(at(root, "title").scalar, "a=b");
}

TEST(ApplyOverride, RefusesWhatDoesNotFit) {
  for (const char* bad :
       {"frames", "=1", "frames.=1", ".fps=1", "frames..fps=1", "bodies[0=1", "bodies[]=1", "bodies[0]x=1",
        "frames.fps.x=1", "bodies.2.name=a", "bodies.jug.name=a", "bodies[-1].name=a", "frames.fps=[1",
        "frames.fps=010", "frames.fps={a: 1, a: 2}", "gravity.1=-1"}) {
    ConfigNode root = parse(kScene);
    try {
      apply_override(root, bad);
      ADD_FAILURE() << bad;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::usage) << bad;
      EXPECT_THAT(error.what(), HasSubstr("--set"));
    }
  }
}

}  // namespace
}  // namespace vivify
