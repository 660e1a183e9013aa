#include "pipeline/body_settings.h"

#include <array>
#include <tuple>

#include "meshing/cage.h"
#include "meshing/harmonic.h"
#include "meshing/outline.h"
#include "meshing/tetrahedralize.h"
#include "pipeline/handle_settings.h"
#include "pipeline/placement.h"
#include "pipeline/push_settings.h"
#include "sim/control/behavior.h"
#include "sim/control/controller.h"
#include "sim/elastic/models.h"
#include "sim/settings.h"

namespace vivify::pipeline {
namespace {

// The key that gives the number of elements, and what they are, by kind.
struct KindEntry {
  const char* shape;
  const char* elements;
  const char* words;
};
constexpr std::array<KindEntry, 4> kKinds = {{{"mesh", "tetrahedra", "a surface filled with tetrahedra"},
                                              {"mesh", "triangles", "the triangles of a surface"},
                                              {"outline", "triangles", "an outline filled with triangles"},
                                              {"outline", "edges", "edges along an outline"}}};
const KindEntry& entry_of(BodyKind kind) { return kKinds[static_cast<std::size_t>(kind)]; }

Schema pose_of_body_schema() {
  return object("A pose of the simulation mesh.")
      .field("file",
             path("Mesh of the pose, in the coordinates of the body's own mesh or outline: for a shell "
                  "the surface of the body with its vertices moved; for others a PLY with the "
                  "vertices of the simulation mesh in their order, as `vivify pose` writes it."))
      .field("pose", path("Pose file (see `vivify pose`), solved for the simulation mesh when it is needed."))
      .field("name",
             string("Name in messages and for `pose`. Left out: that of the file, without its ending."));
}

Schema example_schema() {
  return pose_of_body_schema().field(
      "group", string("Examples of one group share a hull: their weights are kept from being negative "
                      "and from summing to more than 1.")
                   .initially(""));
}

Schema examples_schema(std::string doc) {
  return object(std::move(doc))
      .field("examples", list("The poses.", example_schema()).items_at_least(1).required());
}

Schema rest_space_schema() {
  return variant("How the rest shape may change.", "type")
      .initially("cage")
      .option(
          "cage",
          meshing::cage_schema()
              .field("points", list("For bodies of the plane, corners of a polygon around the body to use "
                                    "as the cage, in the coordinates of the outline; it moves with the "
                                    "body's position and scale.",
                                    vector("A corner, x and y.", 2).unit("m")))
              .field(
                  "examples",
                  list("Poses for `pose` and `blend`, which the cage takes as nearly as it can; what a pose "
                       "leaves in its place stays there more closely than the rest.",
                       pose_of_body_schema()))
              .field("harmonic_unknowns",
                     integer("Size of the problem that gives the harmonic coordinates; more is more "
                             "accurate.")
                         .at_least(100)
                         .at_most(1'000'000)
                         .initially(meshing::HarmonicSettings().unknowns)))
      .option("full", object("Every vertex of the simulation mesh is free."))
      .option("examples", examples_schema("The rest shape is a mixture of example poses, element by element "
                                          "(incompatible, Section 5)."))
      .option("strains",
              examples_schema("The target strains are a mixture of those of example poses, without "
                              "a rest shape; for comparison."));
}

Schema triangles_schema() {
  return object("The triangles of a flat solid or of a shell.")
      .field("vertices",
             integer("Wanted number of vertices; the mesh has this many within 15 %. Left out: 80 for "
                     "a flat solid; a shell keeps the triangles of its file.")
                 .at_least(20)
                 .at_most(20000));
}

Schema edges_schema() {
  return object("The edges of a rod.")
      .field("vertices",
             integer("Number of vertices, evenly spread.").at_least(3).at_most(20000).initially(40));
}

Schema extrude_schema() {
  return object("How a body of the plane is drawn: as a plate, a rod as a band.")
      .field("depth",
             number("Extent in z, about the z of the body's position.").unit("m").above(0).initially(0.2))
      .field(
          "bevel",
          number("Width of the slanted edge between front and side.").unit("m").at_least(0).initially(0.01));
}

// Whether the file gives a setting; what is left out has the place of the map around it.
bool given(const Value& map, const std::string& key) {
  const auto place = [](const Location& where) { return std::tie(where.file, where.line, where.column); };
  return !map[key].is_null() && place(map[key].where()) != place(map.where());
}

class BodyCheck {
 public:
  BodyCheck(const Value& body, std::string where, std::vector<Error>& errors)
      : body_(body), where_(std::move(where)), kind_(body_kind(body)), errors_(errors) {}

  void run() {
    shape();
    elements();
    if (is_planar(kind_)) plane();
    rest_space();
    check_handles(body_, where_, is_planar(kind_), errors_);
    check_pushes(body_, where_, is_planar(kind_), errors_);
    if (!body_["behavior"].items().empty() && body_["controller"]["type"].as_string() != "rest") {
      fail(body_["controller"], where_ + ".controller and .behavior both say what the body does",
           "move the controller into the list `behavior`, or remove one of them");
    }
  }

 private:
  void fail(const Value& value, const std::string& message, const std::string& hint) {
    errors_.emplace_back(ErrorKind::usage, message, hint, value.where());
  }
  std::string model() const { return "model " + body_["model"]["type"].as_string(); }
  std::string made_of() const { return model() + " is made of " + entry_of(kind_).words; }

  void shape() {
    const std::string wanted = entry_of(kind_).shape, other = wanted == "mesh" ? "outline" : "mesh";
    if (body_.has(other)) {
      fail(body_[other], where_ + "." + other + " does not fit: " + made_of(),
           body_.has(wanted) ? "remove `" + other + "`"
                             : "give `" + wanted + "` instead, or choose another model");
    } else if (!body_.has(wanted)) {
      fail(body_, where_ + "." + wanted + " is missing: " + made_of(), "add the key `" + wanted + "`");
    }
    const Value& outline = body_["outline"];
    if (kind_ == BodyKind::flat && !outline.is_null() && outline["type"].as_string() == "polyline") {
      fail(outline["type"],
           where_ + ".outline.type = polyline does not fit: " + made_of() +
               ", and a polyline "
               "has no inside",
           "use a polygon, or model rod2d");
    }
  }

  void elements() {
    const std::string wanted = entry_of(kind_).elements;
    for (const std::string key : {"tetrahedra", "triangles", "edges"}) {
      if (key == wanted || !given(body_, key)) continue;
      fail(body_[key], where_ + "." + key + " does not fit: " + made_of(), "use `" + wanted + "`");
    }
    if (!is_planar(kind_) && given(body_, "extrude")) {
      fail(body_["extrude"], where_ + ".extrude does not fit: " + made_of() + " and is drawn as it is",
           "remove it");
    }
  }

  void plane() {
    if (body_["heading_deg"].as_number() != 0) {
      fail(body_["heading_deg"],
           where_ + ".heading_deg must be 0: a body of the plane cannot be turned out of it",
           "turn the outline's own coordinates, or set the heading of the controller to 90 or -90");
    }
    const double depth = body_["extrude"]["depth"].as_number();
    if (body_["extrude"]["bevel"].as_number() >= depth / 2) {
      fail(body_["extrude"]["bevel"], where_ + ".extrude.bevel must be less than half the depth",
           "lower it, or raise the depth");
    }
  }

  void rest_space() {
    const Value& space = body_["rest_space"];
    const std::string where = where_ + ".rest_space.";
    if (space["type"].as_string() == "cage") {
      const bool points = !space["points"].items().empty();
      if (is_planar(kind_) && space.has("file")) {
        fail(space["file"], where + "file does not fit: the cage of a body of the plane is a polygon",
             "give its corners as `points`");
      }
      if (!is_planar(kind_) && points) {
        fail(space["points"], where + "points does not fit: the cage of a body of space is a closed surface",
             "give a mesh as `file`");
      }
      if (points && space["points"].items().size() < 3) {
        fail(space["points"], where + "points must have at least 3 corners", "add corners");
      }
    }
    const std::vector<Value>& examples = examples_of(body_);
    for (std::size_t i = 0; i < examples.size(); ++i) {
      const Value& example = examples[i];
      if (example.has("file") == example.has("pose")) {
        fail(example, where + "examples[" + std::to_string(i) + "] needs either `file` or `pose`",
             "`file` is a mesh, `pose` a file of handles");
      }
    }
  }

  const Value& body_;
  std::string where_;
  BodyKind kind_;
  std::vector<Error>& errors_;
};

}  // namespace

BodyKind body_kind(const Value& body) {
  const sim::ModelEntry& model = sim::model_entry(body["model"]);
  if (model.dimension == 2) return model.element_points == 2 ? BodyKind::rod : BodyKind::flat;
  return model.element_points == 3 ? BodyKind::shell : BodyKind::solid;
}

const std::vector<Value>& examples_of(const Value& body) {
  static const std::vector<Value> none;
  return body["rest_space"].has("examples") ? body["rest_space"]["examples"].items() : none;
}

bool is_planar(BodyKind kind) { return kind == BodyKind::flat || kind == BodyKind::rod; }

Schema body_schema() {
  return placed_schema(
             "A soft character or object. Its model says what it is made of: solids and shells of a "
             "`mesh`, flat solids and rods of an `outline`.",
             false)
      .field("outline", meshing::outline_schema())
      .field("extrude", extrude_schema())
      .field("tetrahedra", meshing::tetrahedra_schema())
      .field("triangles", triangles_schema())
      .field("edges", edges_schema())
      .field("rest_space", rest_space_schema())
      .field("model", sim::model_schema())
      .field("regularizer", sim::regularizer_schema())
      .field("contact", sim::contact_schema())
      .field("velocity", vector("Velocity at the start.", 3).unit("m/s").initially({0, 0, 0}))
      .field("spawn_s",
             number("When the body appears, with its position and velocity. Before, it is not there.")
                 .unit("s")
                 .at_least(0)
                 .initially(0.0))
      .field("handles", list("What holds parts of the body, as pins or along keyframes.", handle_schema()))
      .field("pushes", list("What pushes the body from outside, and when.", push_schema()))
      .field("controller", sim::controller_schema())
      .field("behavior", sim::behavior_schema())
      .field("solver", sim::solver_schema());
}

void check_body(const Value& body, const std::string& where, std::vector<Error>& errors) {
  BodyCheck(body, where, errors).run();
}

std::vector<std::pair<std::string, Value>> behaviors_of(const Value& body) {
  const std::vector<Value>& script = body["behavior"].items();
  if (script.empty()) return {{"controller", body["controller"]}};
  std::vector<std::pair<std::string, Value>> behaviors;
  for (std::size_t i = 0; i < script.size(); ++i) {
    const auto& [name, settings] = script[i].entries().front();
    behaviors.emplace_back("behavior[" + std::to_string(i) + "]." + name, settings);
  }
  return behaviors;
}

const Value& shape_of(const Value& body) { return body.has("mesh") ? body["mesh"] : body["outline"]; }

}  // namespace vivify::pipeline
