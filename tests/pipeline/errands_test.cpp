// Characters go where the command line sends them; all of their errands are in the slow tests.
#include "tests/pipeline/errands.h"

namespace vivify::pipeline {
namespace {

using testing_support::expect_errands_done;

TEST(Errands, ALetterTurnsAround) { EXPECT_EQ(expect_errands_done("letters", "A", "to (-0.8, 0)"), 1); }

TEST(Errands, ACastleWalksOnAndOn) { EXPECT_EQ(expect_errands_done("castle_solid", "castle", "heading"), 2); }

}  // namespace
}  // namespace vivify::pipeline
