#include "common/parallel.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "common/error.h"

namespace vivify {
namespace {

std::vector<double> work(int threads) {
  set_thread_count(threads);
  std::vector<double> result(10007);
  parallel_for(result.size(), [&](std::size_t i) {
    result[i] = std::sin(static_cast<double>(i)) * 1e-3 + std::exp(-static_cast<double>(i));
  });
  set_thread_count(0);
  return result;
}

TEST(ParallelFor, SameBitsForAnyNumberOfThreads) {
  const std::vector<double> one = work(1);
  EXPECT_EQ(one, work(2));
  EXPECT_EQ(one, work(7));
}

TEST(ParallelFor, VisitsEveryIndexOnce) {
  std::vector<int> visits(1000, 0);
  parallel_for(visits.size(), [&](std::size_t i) { ++visits[i]; });
  EXPECT_EQ(visits, std::vector<int>(1000, 1));
  parallel_for(0, [](std::size_t) { FAIL(); });
}

TEST(ParallelFor, RethrowsWhatABodyThrows) {
  try {
    parallel_for(100, [](std::size_t i) {
      if (i == 37) throw Error(ErrorKind::numerical, "body 37");
    });
    FAIL();
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "body 37");
    EXPECT_EQ(error.kind(), ErrorKind::numerical);
  }
}

TEST(ThreadCount, CanBeLimited) {
  set_thread_count(1);
  EXPECT_EQ(thread_count(), 1);
  set_thread_count(0);
  EXPECT_GE(thread_count(), 1);
}

}  // namespace
}  // namespace vivify
