#include "sim/world.h"

namespace vivify::sim {

World::World(const std::vector<BodyInput>& bodies, std::vector<Collider> colliders,
             const WorldSettings& settings)
    : settings_(settings), colliders_(std::move(colliders)) {
  for (const BodyInput& input : bodies) bodies_.push_back(std::make_unique<Body>(input, settings_));
}

void World::step() {
  ++steps_;
  for (const auto& body : bodies_) records_.push_back(body->step(steps_, colliders_));
}

void World::save(Hdf5Writer& file) {
  file.put_attribute("schema_version", 1);
  file.put("/t", time());
  file.put("/step", static_cast<std::int64_t>(steps_));
  std::string lines;
  for (const StepRecord& record : records_) lines += csv_line(record);
  file.put("/steps", lines);
  records_.clear();
  for (const auto& body : bodies_) body->save(file, "/bodies/" + body->model().name);
}

void World::restore(const Hdf5Reader& file) {
  steps_ = static_cast<long>(file.integer("/step"));
  records_.clear();
  for (const auto& body : bodies_) body->restore(file, "/bodies/" + body->model().name);
}

}  // namespace vivify::sim
