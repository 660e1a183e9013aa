#include "sim/control/controller.h"

#include <array>

#include "common/registry.h"
#include "sim/control/controllers/blend.h"
#include "sim/control/controllers/crawl.h"
#include "sim/control/controllers/goals.h"
#include "sim/control/controllers/hop.h"
#include "sim/control/controllers/pose.h"
#include "sim/control/controllers/rest.h"
#include "sim/control/controllers/roll.h"
#include "sim/control/controllers/turn.h"
#include "sim/control/controllers/wait.h"
#include "sim/control/controllers/walk.h"

namespace vivify::sim {
namespace {

constexpr std::array<ControllerEntry, 10> kControllers = {{
    {"rest", rest_controller_schema, make_rest_controller},
    {"hop", hop_controller_schema, make_hop_controller},
    {"roll", roll_controller_schema, make_roll_controller},
    {"walk", walk_controller_schema, make_walk_controller},
    {"crawl", crawl_controller_schema, make_crawl_controller},
    {"wait", wait_controller_schema, make_wait_controller},
    {"turn", turn_controller_schema, make_turn_controller},
    {"goals", goals_controller_schema, make_goals_controller},
    {"pose", pose_controller_schema, make_pose_controller},
    {"blend", blend_controller_schema, make_blend_controller},
}};

}  // namespace

std::span<const ControllerEntry> controllers() { return kControllers; }

Schema controller_schema() {
  Schema schema = variant("What the body tries to do.", "type").initially(kControllers.front().name.data());
  for (const ControllerEntry& entry : kControllers) {
    schema = std::move(schema).option(std::string(entry.name), entry.schema());
  }
  return schema;
}

std::unique_ptr<Controller> make_controller(const ControlledBody& body, const Value& settings) {
  return find_entry(controllers(), settings["type"].as_string(), "controller").make(body, settings);
}

}  // namespace vivify::sim
