#include "sim/elastic/models.h"

#include <array>

#include "common/registry.h"
#include "sim/elastic/models/models.h"

namespace vivify::sim {
namespace {

constexpr std::array<ModelEntry, 6> kModels = {{
    {"solid3d", 3, 4, solid3d_schema, build_solid3d, solid3d_warning},
    {"solid3d_stvk", 3, 4, solid3d_stvk_schema, build_solid3d_stvk, solid3d_stvk_warning},
    {"shell3d", 3, 3, shell3d_schema, build_shell3d, shell3d_warning},
    {"solid2d", 2, 3, solid2d_schema, build_solid2d, solid2d_warning},
    {"solid2d_printed", 2, 3, solid2d_schema, build_solid2d_printed, solid2d_warning},
    {"rod2d", 2, 2, rod2d_schema, build_rod2d, rod2d_warning},
}};

// Everything that a region can say of its own.
Schema region_schema(const ModelEntry& entry) {
  return entry.material_schema()
      .field("min", vector("Lower corner of the region, in shares of the bounding box of the body.", 3)
                        .initially({0, 0, 0}))
      .field("max", vector("Upper corner of the region, in shares of the bounding box of the body.", 3)
                        .initially({1, 1, 1}));
}

}  // namespace

Materials::Materials(const SimMesh& reference, const Value& model)
    : model_(model), region_(static_cast<std::size_t>(reference.E.rows()), -1) {
  const std::vector<Value>& regions = model["regions"].items();
  if (regions.empty() || reference.V.rows() == 0) return;
  const Eigen::Index d = reference.V.cols();
  const Eigen::RowVectorXd low = reference.V.colwise().minCoeff(), high = reference.V.colwise().maxCoeff();
  for (Eigen::Index e = 0; e < reference.E.rows(); ++e) {
    Eigen::RowVectorXd centre = Eigen::RowVectorXd::Zero(d);
    for (int k = 0; k < reference.element_points(); ++k) {
      centre += reference.V.row(reference.E(e, k)) / reference.element_points();
    }
    for (std::size_t r = 0; r < regions.size(); ++r) {
      const Eigen::RowVectorXd from = regions[r]["min"].as_vector().head(d).transpose(),
                               to = regions[r]["max"].as_vector().head(d).transpose();
      const Eigen::RowVectorXd size = high - low;
      if (((centre - low).array() >= from.array() * size.array()).all() &&
          ((centre - low).array() <= to.array() * size.array()).all()) {
        region_[static_cast<std::size_t>(e)] = static_cast<int>(r);
      }
    }
  }
}

const Value& Materials::of(int element) const {
  const int region = region_[static_cast<std::size_t>(element)];
  return region < 0 ? model_ : model_["regions"].items()[static_cast<std::size_t>(region)];
}

std::span<const ModelEntry> elastic_models() { return kModels; }

const ModelEntry& model_entry(const Value& model) {
  return find_entry(elastic_models(), model["type"].as_string(), "elastic model");
}

Schema model_schema(std::span<const ModelEntry> models) {
  Schema schema =
      variant("Elastic model and material of a body.", "type").initially(models.front().name.data());
  for (const ModelEntry& entry : models) {
    schema = std::move(schema).option(
        std::string(entry.name),
        entry.material_schema()
            .field("damping_s",
                   number("Damping in proportion to stiffness (Rayleigh's β): a vibration of angular "
                          "frequency ω loses the share exp(−β ω² t/2). It acts on the measures of "
                          "deformation, so it keeps linear and angular momentum.")
                       .unit("s")
                       .at_least(0)
                       .initially(0.0))
            .field("regions", list("Parts with a material of their own; the last that holds the centre of "
                                   "an element counts.",
                                   region_schema(entry))));
  }
  return schema;
}

ElasticModel build_model(const SimMesh& reference, RestLayout layout, const Value& model) {
  return build_model(model_entry(model), reference, layout, model);
}

ElasticModel build_model(const ModelEntry& entry, const SimMesh& reference, RestLayout layout,
                         const Value& model) {
  const auto kind = [](int points) {
    return points == 2 ? "edges" : points == 3 ? "triangles" : "tetrahedra";
  };
  if (reference.dimension() != entry.dimension || reference.element_points() != entry.element_points) {
    throw Error(ErrorKind::geometry,
                "model " + std::string(entry.name) + " needs " + kind(entry.element_points) + " in " +
                    std::to_string(entry.dimension) + " dimensions, and the mesh has " +
                    kind(reference.element_points()) + " in " + std::to_string(reference.dimension()),
                "choose another model, or another mesh", model.where());
  }
  return entry.build(reference, layout, Materials(reference, model));
}

std::vector<std::string> model_warnings(const Value& model) {
  std::vector<std::string> warnings;
  const ModelEntry& entry = model_entry(model);
  const auto add = [&](const Value& material, const std::string& where) {
    if (const std::string text = entry.warning(material); !text.empty()) warnings.push_back(where + text);
  };
  add(model, "model: ");
  for (std::size_t r = 0; r < model["regions"].items().size(); ++r) {
    add(model["regions"].items()[r], "model.regions[" + std::to_string(r) + "]: ");
  }
  return warnings;
}

}  // namespace vivify::sim
