// A schema with every kind of setting, and a scene that fits it.
#pragma once

#include <string>

#include "common/schema.h"

namespace vivify::testing_support {

inline Schema sample_schema() {
  Schema model =
      variant("Elastic model.", "type")
          .option("solid3d",
                  object("Tetrahedra with springs.")
                      .field("density", number("Mass per volume.").unit("kg/m³").above(0).initially(1000))
                      .field("stiffness", number("Stiffness of edges.").unit("Pa").above(0).required()))
          .option("rigid",
                  object("Does not deform.").field("mass", number("Mass.").unit("kg").above(0).initially(1)))
          .required();
  Schema space =
      variant("Rest space.", "type")
          .option("full", object("All vertices."))
          .option("cage",
                  object("A cage.").field(
                      "vertices", integer("Vertices of the cage.").at_least(4).at_most(200).initially(8)))
          .initially("cage");
  Schema body =
      object("A body.")
          .field("name", string("Name.").required())
          .field("mesh", path("Surface.").required())
          .field("position", vector("Where it stands.", 3).unit("m").initially(std::vector<double>{0, 0, 0}))
          .field("heading_deg", number("Turn about +Y.").unit("°").at_least(-360).below(360).initially(0))
          .field("friction", number("Coulomb coefficient.").at_least(0).infinite().initially(1))
          .field("model", std::move(model))
          .field("rest_space", std::move(space))
          .field(
              "steps",
              list("What it does, one after the other.",
                   one_of("A deed.")
                       .option("walk", object("Goes on foot.").field("speed", number("Speed.").initially(1)))
                       .option("wait", object("Stands still.").field("for_s", number("Time.").required()))))
          .field("outline", list("Its corners.", vector("A corner.", 2).required()).items_at_least(3))
          .field("looks", dictionary("Material of each part.", string("Name of a material.")));
  return object("A test scene.")
      .field("version", integer("Version of the format.").at_least(1).at_most(1).required())
      .field("title", string("Shown nowhere."))
      .field("frames", object("Timing.")
                           .field("fps", integer("Frames per second.").above(0).at_most(1000).initially(24))
                           .field("duration_s", number("Length.").unit("s").above(0).initially(4.0))
                           .field("loop", boolean("Start again.").initially(false)))
      .field("gravity", vector("Gravity.", 3)
                            .unit("m/s²")
                            .at_least(-100)
                            .at_most(100)
                            .initially(std::vector<double>{0, -9.81, 0}))
      .field("bodies", list("The bodies.", std::move(body)).required().items_at_least(1))
      .field("backend", choice("Mesher.", {"tetgen", "mesh3"}).initially("tetgen"))
      .field("cutoff", number("An optional limit.").above(0));
}

inline const std::string& sample_scene() {
  static const std::string text = R"(# a comment
version: 1
title: "a # b: 'c' | \"d\" – é"
frames: {fps: 30, duration_s: 2.5e0}
gravity: [0, -1.62, 0]
bodies:
  - name: cup
    mesh: ../assets/cup.glb
    position: [0.1, 1e-3, -2]
    heading_deg: 90
    friction: inf
    model: {type: solid3d, density: 900, stiffness: 1e5}
    rest_space: {type: cage, vertices: 12}
    looks:
      porcelain: white
      eyes: black
  - name: "table"
    mesh: table.obj
    model:
      type: rigid
      mass: 40
    rest_space: {type: full}
backend: mesh3
)";
  return text;
}

}  // namespace vivify::testing_support
