// What the scenes of the cast ask of their characters, in one table: for their tests, and for the bench of
// their robustness (bench/cast_trials.cpp). A new scene is a row for each of its characters.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tests/pipeline/scene_result.h"

namespace vivify::testing_support {

enum class Gait { hop, roll, walk };

struct Role {
  const char* scene;  // in configs/, without .yaml
  const char* body;
  Gait gait;
  double height, width;  // m
  bool in_plane = false;
  std::optional<Eigen::Vector3d> place = {};  // where its centre of mass ends and stays, level, m
  std::optional<double> heading_deg = {};     // that it travels along
  double distance = 0;                        // that it gets from its start, level, m
  int flights = 0;                            // of a tenth of a second
  int steps = 0;                              // that it takes on the ground, towards where it goes
  // What else is missing, in words; empty when nothing is.
  std::string (*missing)(const SceneResult&) = nullptr;
  // Of one that can be sent elsewhere: the setting of its body that holds its course, what else to set of it,
  // and of the scene.
  std::string course = {};
  std::vector<std::string> besides = {}, of_scene = {};
};

// In the order of docs/gallery.md.
const std::vector<Role>& cast_roles();

// The roles in one scene.
std::vector<Role> roles_in(const std::string& scene);

// A role in which the character of another role is sent somewhere by command line alone.
struct Errand {
  std::string name;                  // "heading 45", "to (1.5, 1)"
  std::vector<std::string> options;  // of the command line
  Role role;
};
// Eight headings (of bodies of the plane two), along each of which it gets by half its height or more in 8 s,
// and four places, where it is after 16 s; none for roles without `course`. The character begins at the
// origin, and the others of its scene never appear.
std::vector<Errand> errands(const Role& role);

// What a character does not do of what its role asks for: "hops 3 times, not 8". It must not fall, either:
// hoppers and walkers stay within 45° of upright.
std::vector<std::string> shortcomings(const SceneResult& run, const Role& role);

}  // namespace vivify::testing_support
