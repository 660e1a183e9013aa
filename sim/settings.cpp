#include "sim/settings.h"

#include "sim/solve/step_method.h"

namespace vivify::sim {

Schema regularizer_schema() {
  return object(
             "Cost of changing the rest shape: the elastic energy between the initial and the current rest "
             "shape, (11).")
      .field("stiffness",
             number("Stiffness against stretch, as a share of the model's.").above(0).initially(0.03))
      .field("volume_stiffness",
             number("Stiffness against change of area or volume, as a share of the model's.")
                 .at_least(0)
                 .initially(0.03))
      .field("bending_stiffness", number("Bending stiffness of rods and shells, as a share of the model's.")
                                      .at_least(0)
                                      .initially(0.03))
      .field("hull", number("Cost of leaving the hull of the examples (weights that are negative or sum to "
                            "more than 1), in units of weight times height.")
                         .at_least(0)
                         .initially(10))
      .field("rate", number("Cost of changing the rest shape quickly; strong values make characters fall.")
                         .at_least(0)
                         .initially(0.03));
}

Schema contact_schema() {
  return object("Contact with colliders and other bodies.")
      .field(
          "points",
          integer("Points of the drawn surface that can touch.").at_least(4).at_most(100000).initially(160))
      .field("layer",
             number("Thickness of the contact layer as a share of the body's height: softer when larger.")
                 .above(0)
                 .at_most(0.1)
                 .initially(0.0015))
      .field("friction",
             number("Factor of Coulomb's friction: two things that touch have the product of theirs.")
                 .at_least(0)
                 .initially(1))
      .field("self", boolean("Whether the body touches itself.").initially(false));
}

Schema solver_schema() {
  std::vector<std::string> methods;
  for (const StepMethodEntry& entry : step_methods()) methods.emplace_back(entry.name);
  const SolverSettings standard;
  return object("How each step is solved.")
      .field(
          "method",
          choice("Lagrangian optimisation (sqp), or a forward simulation for every trial (reduced).", methods)
              .initially(standard.method.c_str()))
      .field(
          "exact_hessian",
          boolean(
              "Use the full blocks A, B, C of (13) instead of Gauss–Newton: dearer, seldom fewer iterations.")
              .initially(standard.exact_hessian))
      .field("max_iterations", integer("Most iterations in one step.")
                                   .at_least(1)
                                   .at_most(1000)
                                   .initially(standard.max_iterations))
      .field("decrement", number("Stop at this Newton decrement, in units of weight times height.")
                              .above(0)
                              .initially(standard.decrement));
}

SolverSettings solver_settings(const Value& solver) {
  SolverSettings settings;
  settings.method = solver["method"].as_string();
  settings.exact_hessian = solver["exact_hessian"].as_bool();
  settings.max_iterations = static_cast<int>(solver["max_iterations"].as_integer());
  settings.decrement = solver["decrement"].as_number();
  return settings;
}

}  // namespace vivify::sim
