#include "meshing/guarded_process.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <numeric>

#include "common/error.h"
#include "common/mesh.h"
#include "meshing/byte_stream.h"

namespace vivify::meshing {
namespace {

std::string failure(const std::function<Bytes()>& work, const ProcessLimits& limits = {}) {
  try {
    run_guarded("the work", "a hint", limits, work);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::geometry);
    EXPECT_EQ(error.hint(), "a hint");
    return error.what();
  }
  ADD_FAILURE() << "the work succeeded";
  return {};
}

TEST(GuardedProcess, GivesBackManyBytes) {
  Bytes expected(5'000'001);
  for (std::size_t i = 0; i < expected.size(); ++i) expected[i] = static_cast<std::byte>(i * 31 >> 3);
  EXPECT_EQ(run_guarded("the work", "", {}, [&] { return expected; }), expected);
}

TEST(GuardedProcess, SurvivesACrash) {
  EXPECT_THAT(failure([]() -> Bytes {
                std::signal(SIGABRT, SIG_DFL);
                std::abort();
              }),
              testing::HasSubstr("the work crashed (Aborted)"));
}

TEST(GuardedProcess, EndsWorkThatHangs) {
  EXPECT_THAT(failure(
                  []() -> Bytes {
                    for (;;) pause();
                  },
                  {0.2, 1000}),
              testing::HasSubstr("did not end within 0.2 s"));
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
TEST(GuardedProcess, LimitsMemory) {
  EXPECT_THAT(failure([] { return Bytes(400 << 20); }, {60, 100}), testing::HasSubstr("100 MB"));
}
#endif

TEST(GuardedProcess, PassesErrorsOn) {
  EXPECT_THAT(failure([]() -> Bytes { throw std::runtime_error("something odd"); }),
              testing::HasSubstr("something odd"));
  try {
    run_guarded("the work", "", {},
                []() -> Bytes { throw Error(ErrorKind::numerical, "no convergence", "try again"); });
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::numerical);
    EXPECT_STREQ(error.what(), "no convergence");
    EXPECT_EQ(error.hint(), "try again");
  }
}

TEST(ByteStream, ReadsBackWhatWasWritten) {
  Points V = Points::Random(7, 3);
  Tetrahedra T = Tetrahedra::Constant(2, 4, -5);
  const std::vector<std::string> texts = {"", "one", "two words"};
  const Bytes bytes = ByteWriter().put(V).put(3.5).put(T).put(texts).take();
  ByteReader reader(bytes);
  Points V2;
  double number = 0;
  Tetrahedra T2;
  std::vector<std::string> texts2;
  reader.get(V2);
  reader.get(number);
  reader.get(T2);
  reader.get(texts2);
  EXPECT_EQ(V2, V);
  EXPECT_EQ(number, 3.5);
  EXPECT_EQ(T2, T);
  EXPECT_EQ(texts2, texts);
  EXPECT_TRUE(reader.at_end());

  ByteReader cut(std::span<const std::byte>(bytes.data(), bytes.size() - 1));
  cut.get(V2);
  cut.get(number);
  cut.get(T2);
  EXPECT_THROW(cut.get(texts2), std::runtime_error);
}

}  // namespace
}  // namespace vivify::meshing
