#include "common/value.h"

#include <gtest/gtest.h>

#include <limits>

namespace vivify {
namespace {

TEST(Value, GivesWhatWasPutIn) {
  Value map = Value::map();
  map.set("a", Value::integer(3));
  map.set("b", Value::list({Value::number(1), Value::integer(2), Value::number(3.5)}));
  map.set("a", Value::integer(4));
  EXPECT_EQ(map["a"].as_integer(), 4);
  EXPECT_EQ(map["a"].as_number(), 4.0);
  EXPECT_EQ(map["b"].as_vector3(), Eigen::Vector3d(1, 2, 3.5));
  EXPECT_EQ(map["b"].as_vector().size(), 3);
  EXPECT_TRUE(map.has("a"));
  EXPECT_FALSE(map.has("c"));
  EXPECT_TRUE(map["c"].is_null());
  EXPECT_EQ(map.entries().size(), 2U);
}

TEST(Value, WrongAccessIsADefect) {
  const auto kind_of = [](const auto& access) {
    try {
      access();
    } catch (const Error& error) {
      return error.kind();
    }
    return ErrorKind::usage;
  };
  const Value text = Value::string("a");
  EXPECT_EQ(kind_of([&] { text.as_number(); }), ErrorKind::internal);
  EXPECT_EQ(kind_of([&] { text.as_bool(); }), ErrorKind::internal);
  EXPECT_EQ(kind_of([&] { text.items(); }), ErrorKind::internal);
  EXPECT_EQ(kind_of([&] { text["a"]; }), ErrorKind::internal);
  EXPECT_EQ(kind_of([&] { Value::number(1.5).as_integer(); }), ErrorKind::internal);
  EXPECT_EQ(kind_of([&] { Value::list({Value::integer(1)}).as_vector3(); }), ErrorKind::internal);
}

TEST(Value, YamlQuotesWhatWouldReadAsSomethingElse) {
  EXPECT_EQ(Value::string("porcelain").yaml(), "porcelain\n");
  EXPECT_EQ(Value::string("../a/b.glb").yaml(), "../a/b.glb\n");
  for (const char* text :
       {"true", "No", "null", "~", "", "5", "1e3", ".inf", "inf", "a: b", "- a", "#", "a b", "---"}) {
    EXPECT_EQ(Value::string(text).yaml(), "\"" + std::string(text) + "\"\n");
  }
  EXPECT_EQ(Value::string("a\"\\\n\x01").yaml(), "\"a\\\"\\\\\\n\\x01\"\n");
}

TEST(Value, YamlIsBlockStyleWithFlowForPlainLists) {
  Value inner =
      Value::map({{"x", Value::number(0.1)}, {"v", Value::list({Value::integer(1), Value::integer(2)})}});
  Value map = Value::map({{"a", Value::list({inner, Value::list({Value::list({})})})},
                          {"e", Value::map()},
                          {"i", Value::number(std::numeric_limits<double>::infinity())},
                          {"limit", Value()},
                          {"n", Value::boolean(true)}});
  EXPECT_EQ(map.yaml(),
            "a:\n"
            "  - x: 0.1\n"
            "    v: [1, 2]\n"
            "  - [[]]\n"
            "e: {}\n"
            "i: .inf\n"
            "limit: null\n"
            "\"n\": true\n");
}

}  // namespace
}  // namespace vivify
