// Hoppers and walkers go where the command line sends them, which their scenes did not ask for: along eight
// headings (two in the plane) and to four places; docs/robustness.md has the same.
#include "tests/pipeline/errands.h"

namespace vivify::pipeline {
namespace {

struct Sent {
  const char* scene;
  const char* body;
  int errands;
};

void PrintTo(const Sent& sent, std::ostream* stream) { *stream << sent.scene << ' ' << sent.body; }

class Errands : public testing::TestWithParam<Sent> {};

TEST_P(Errands, AreRunByCommandLineAlone) {
  EXPECT_EQ(testing_support::expect_errands_done(GetParam().scene, GetParam().body), GetParam().errands);
}

INSTANTIATE_TEST_SUITE_P(
    Cast, Errands,
    testing::Values(
        Sent{"tea_cups", "cup", 12}, Sent{"tea_cups", "mug", 12}, Sent{"tea_cups", "espresso", 12},
        Sent{"cross", "cross", 12}, Sent{"cheesy", "cheesy", 12}, Sent{"crusty_race", "light", 12},
        Sent{"crusty_race", "dark", 12}, Sent{"ace_cage", "ace", 12}, Sent{"ace_examples", "ace", 12},
        Sent{"castle_solid", "castle", 6}, Sent{"castle_rod", "castle", 6}, Sent{"pirate", "pirate", 6},
        Sent{"letters", "S", 6}, Sent{"letters", "I", 6}, Sent{"letters", "G", 6}, Sent{"letters", "G2", 6},
        Sent{"letters", "R", 6}, Sent{"letters", "A", 6}, Sent{"letters", "P", 6}, Sent{"letters", "H", 6},
        Sent{"figure3_full", "letter", 6}, Sent{"figure3_cage", "letter", 6},
        Sent{"figure3_bent", "letter", 6}, Sent{"figure3_compressed", "letter", 6}),
    [](const auto& tested) { return std::string(tested.param.scene) + "_" + tested.param.body; });

}  // namespace
}  // namespace vivify::pipeline
