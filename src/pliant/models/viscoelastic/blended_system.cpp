#include "pliant/models/viscoelastic/blended_system.h"

namespace pliant {

BlendedSystem::BlendedSystem(bool oriented, TurnBlend blend) {
  auto solid = std::make_unique<BlendedClusters>(oriented, blend);
  solid_ = solid.get();
  elements.push_back(std::move(solid));
}

void BlendedSystem::reset() {
  ProjectiveSystem::reset();
  walls.clear();
}

void BlendedSystem::save(StateArchive& numbers) const {
  numbers.write_all(beta);
  numbers.write(unfollowed);
  const Positions& listed = liquid.listed_positions();
  numbers.write(static_cast<double>(listed.cols()));
  numbers.write_all(listed);
  ProjectiveSystem::save(numbers);
}

void BlendedSystem::load(StateArchive& numbers) {
  numbers.read_all(beta);
  unfollowed = numbers.read();
  Positions listed(3, static_cast<Eigen::Index>(numbers.read()));
  numbers.read_all(listed);
  liquid.list_at(listed);
  walls.clear();
  ProjectiveSystem::load(numbers);
}

}  // namespace pliant
