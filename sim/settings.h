// Schemas of the settings that sim/ reads besides `model` (sim/elastic/models.h) and `controller`
// (sim/control/controller.h).
#pragma once

#include "common/schema.h"
#include "sim/body_model.h"

namespace vivify::sim {

Schema regularizer_schema();  // `regularizer` of a body
Schema contact_schema();      // `contact` of a body
Schema solver_schema();       // `solver` of a body
SolverSettings solver_settings(const Value& solver);

}  // namespace vivify::sim
