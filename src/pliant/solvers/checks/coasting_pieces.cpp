#include "pliant/solvers/checks/coasting_pieces.h"

#include <cmath>

namespace pliant {

void CoastingPieces::begin(int pieces) {
  speed_.setZero(3, pieces);
  gone_.setZero(3, pieces);
}

void CoastingPieces::begin(int pieces, const Eigen::VectorXd& mass, const Eigen::Matrix3Xd& gained,
                           const std::vector<int>& piece_of) {
  begin(pieces);
  mass_.setZero(pieces);
  for (std::size_t i = 0; i < piece_of.size(); ++i) {
    const auto particle = static_cast<Eigen::Index>(i);
    if (piece_of[i] < 0) continue;
    mass_[piece_of[i]] += mass[particle];
    speed_.col(piece_of[i]) += mass[particle] * gained.col(particle);
  }
  for (int k = 0; k < pieces; ++k) {
    if (mass_[k] > 0.0) speed_.col(k) /= mass_[k];
  }
}

void CoastingPieces::go_on(int piece, double steps) {
  if (knows(piece)) gone_.col(piece) += steps * speed_.col(piece);
}

void CoastingPieces::go_on(int piece, double steps, const HeldDirections& held, double resting) {
  if (!knows(piece)) return;
  const Eigen::Vector3d open = held.open_part(piece, speed_.col(piece));
  const double left = std::exp(-steps / resting);
  gone_.col(piece) += resting * (1.0 - left) * open;
  speed_.col(piece) = left * open;
}

Eigen::Vector3d CoastingPieces::gone(int piece) const {
  return knows(piece) ? Eigen::Vector3d(gone_.col(piece)) : Eigen::Vector3d::Zero();
}

void CoastingPieces::save(StateArchive& numbers) const {
  numbers.write(static_cast<double>(gone_.cols()));
  numbers.write_all(speed_);
  numbers.write_all(gone_);
}

void CoastingPieces::load(StateArchive& numbers) {
  const double size = numbers.read();
  begin(0);
  // That of a solver that saved less is no number.
  if (!(size > 0.0 && size < static_cast<double>(numbers.size()))) return;
  begin(static_cast<int>(size));
  numbers.read_all(speed_);
  numbers.read_all(gone_);
}

}  // namespace pliant
