#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace pliant {

/// What particles of a cluster add to the constant matrix of projective dynamics,
///   A_ij = k (δ_ij m_i − m_i m_j / m),
/// with the mass m of all: entries between all of them, in rows that add up to nothing.
struct SharedEntries {
  struct Member {
    int particle;
    double mass;  ///< m_i [kg]
  };
  std::vector<Member> members;
  double mass = 0.0;       ///< m [kg]
  double stiffness = 0.0;  ///< k [1/s²]
};

/// The stiffness of particles whose common motions cost nothing, as those of a cluster that is
/// free to move and turn, with the mass m and the moment m q of each from the middle of all:
///   K_ij = δ_ij s_i 1 − d² m_i m_j 1 − Σ_k (T_k m_i q_i)(T_k m_j q_j)ᵀ.
/// All of its particles act on each other, so that it has as many blocks as their number squared.
struct SharedStiffness {
  static constexpr int kTurns = 3;
  struct Member {
    int particle;
    double own;            ///< s_i [N/m]
    Eigen::Vector4d load;  ///< m q [kg m] and m [kg]
  };
  /// What a member is to the others: d m [√(N/m)], and T_k m q in the columns [√(N/m)].
  struct Pulls {
    double move;
    Eigen::Matrix3d turns;
  };

  Pulls pulls(const Member& member) const {
    Pulls result;
    result.move = move * member.load[3];
    for (int k = 0; k < kTurns; ++k) {
      const Eigen::Matrix3d& turn = turns[static_cast<std::size_t>(k)];
      result.turns.col(k) = (turn.col(0) * member.load[0] + turn.col(1) * member.load[1]) +
                            turn.col(2) * member.load[2];
    }
    return result;
  }
  /// K_ij of two members; `own` is s_i of one and the same, and 0 of two.
  static Eigen::Matrix3d block(const Pulls& row, const Pulls& column, double own) {
    Eigen::Matrix3d result = Eigen::Matrix3d::Zero();
    result.diagonal().setConstant(own - row.move * column.move);
    for (int k = 0; k < kTurns; ++k) {
      for (int c = 0; c < 3; ++c) result.col(c) -= row.turns.col(k) * column.turns(c, k);
    }
    return result;
  }

  std::vector<Member> members;
  double move = 0.0;                          ///< d [√(N/m)/kg]
  std::array<Eigen::Matrix3d, kTurns> turns;  ///< T_k [√(N/m)/(kg m)]
};

}  // namespace pliant
