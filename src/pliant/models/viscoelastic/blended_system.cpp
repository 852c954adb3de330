#include "pliant/models/viscoelastic/blended_system.h"

#include "pliant/math/error.h"

namespace pliant {

BlendedSystem::BlendedSystem(bool oriented, TurnBlend blend) {
  auto solid = std::make_unique<BlendedClusters>(oriented, blend);
  solid_ = solid.get();
  elements.push_back(std::move(solid));
}

void BlendedSystem::keep_losses() {
  keeps_losses_ = true;
  solid_->keep_losses();
}

void BlendedSystem::note_motion_losses(const Eigen::VectorXd& losses) {
  if (motion_losses_.size() == 0) motion_losses_.setZero(losses.size());
  motion_losses_ += losses;
}

void BlendedSystem::scale_velocities(double factor) {
  if (keeps_losses_) {
    note_motion_losses(
        (0.5 * (1.0 - factor * factor)) *
        particles.mass.cwiseProduct(particles.v.colwise().squaredNorm().transpose()));
  }
  ProjectiveSystem::scale_velocities(factor);
}

void BlendedSystem::reset() {
  motion_losses_.resize(0);
  unfollowed = 0.0;
  counted_step = 0;
  ProjectiveSystem::reset();
  walls.clear();
}

void BlendedSystem::save(StateArchive& numbers) const {
  numbers.write_all(beta);
  numbers.write(unfollowed);
  numbers.write(counted_step);
  const Positions& listed = liquid.listed_positions();
  numbers.write(listed.cols() > 0 ? 1.0 : 0.0);
  numbers.write_all(listed);
  if (keeps_losses_) {
    numbers.write(motion_losses_.size() > 0 ? 1.0 : 0.0);
    numbers.write_all(motion_losses_);
  }
  ProjectiveSystem::save(numbers);
}

void BlendedSystem::load(StateArchive& numbers) {
  numbers.read_all(beta);
  unfollowed = numbers.read();
  counted_step = numbers.read();
  Positions listed(3, numbers.read_whole(0, 1) * particles.size());
  numbers.read_all(listed);
  if (!listed.allFinite()) throw InputError("the saved state has particles that are nowhere");
  liquid.list_at(listed);
  walls.clear();
  if (keeps_losses_) {
    motion_losses_.resize(numbers.read_whole(0, 1) * particles.size());
    numbers.read_all(motion_losses_);
  }
  ProjectiveSystem::load(numbers);
}

}  // namespace pliant
