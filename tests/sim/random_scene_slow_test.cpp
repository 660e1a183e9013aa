#include "tests/sim/random_scene.h"

namespace vivify::sim {
namespace {

INSTANTIATE_TEST_SUITE_P(Many, RandomScenes, ::testing::Range<std::uint64_t>(20, 200));

}  // namespace
}  // namespace vivify::sim
