// Crawling: a hump that travels along a long, low body, as a caterpillar's, from its tail to its head.
#pragma once

#include "sim/control/controller.h"

namespace vivify::sim {

Schema crawl_controller_schema();
// Throws Error(usage) for segments without vertices, and as Course does.
std::unique_ptr<Controller> make_crawl_controller(const ControlledBody& body, const Value& settings);

}  // namespace vivify::sim
