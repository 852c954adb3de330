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
/// free to move and turn:
///   K_ij = δ_ij s_i 1 − Σ_k (D_k l_i)(D_k l_j)ᵀ.
/// All of its particles act on each other, so that it has as many blocks as their number squared.
struct SharedStiffness {
  static constexpr int kMotions = 6;
  using Motion = Eigen::Matrix<double, 3, 4>;
  struct Member {
    int particle;
    double own;            ///< s_i [N/m]
    Eigen::Vector4d load;  ///< l_i = (m q, m), q from the middle of the particles [kg m, kg]
  };

  Eigen::Matrix3d block(const Member& row, const Member& column) const {
    Eigen::Matrix3d result = Eigen::Matrix3d::Zero();
    if (&row == &column) result.diagonal().setConstant(row.own);
    for (const Motion& motion : motions) {
      result -=
          Eigen::Vector3d(motion * row.load) * Eigen::Vector3d(motion * column.load).transpose();
    }
    return result;
  }

  std::vector<Member> members;
  std::array<Motion, kMotions> motions;  ///< D_k
};

}  // namespace pliant
