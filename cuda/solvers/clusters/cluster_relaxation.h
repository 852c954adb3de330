#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "cuda/elements/cluster_list.h"
#include "pliant/elements/attachment_set.h"
#include "pliant/elements/clusters/cluster_set.h"
#include "pliant/solvers/iterations/relaxation.h"

namespace pliant {

/// How far a Jacobi iteration may go on a system of clusters and attachments alone, without its
/// matrix: that has a million entries for a thousand members, and many clusters have many.
struct ClusterRelaxation {
  Relaxation relaxation;
  Eigen::VectorXd diagonal;  ///< of A = M/h² + Σ k (diag(m) − m mᵀ/M) + attachments [N/m]

  /// False, and nothing set, where the system has other elements. The bounds need no search:
  /// without the m mᵀ/M the matrix is diagonal, and larger; without all but M/h², smaller.
  bool set(const ProjectiveSystem& system, double dt) {
    const Particles& particles = system.particles;
    Eigen::VectorXd most = particles.mass / (dt * dt);
    diagonal = most;
    for (const auto& set : system.elements) {
      const ClusterSet* clusters = nullptr;
      if (is_cluster_set(*set, clusters)) {
        if (clusters != nullptr) add(clusters->shapes(), most);
      } else if (const AttachmentSet* attachments = as<AttachmentSet>(*set)) {
        for (const auto& attachment : attachments->attachments()) {
          diagonal[attachment.particle] += attachment.stiffness;
          most[attachment.particle] += attachment.stiffness;
        }
      } else {
        return false;
      }
    }
    double largest = 0.0, least = std::numeric_limits<double>::infinity();
    for (int i = 0; i < particles.size(); ++i) {
      if (particles.is_fixed(i)) continue;
      largest = std::max(largest, most[i] / diagonal[i]);
      least = std::min(least, particles.mass[i] / (dt * dt) / diagonal[i]);
    }
    if (largest == 0.0) largest = least = 1.0;  // all are fixed
    relaxation.largest_eigenvalue = largest;
    relaxation.gamma = std::min(kShare * 2.0 / largest, 2.0 / (largest + least));
    relaxation.mobility = relaxation.gamma * free_mobility(diagonal, particles);
    return true;
  }

 private:
  static constexpr double kShare = 0.9;  // as make_relaxation()

  void add(const ClusterShapes& shapes, Eigen::VectorXd& most) {
    for (int c = 0; c < shapes.size(); ++c) {
      const ClusterShapes::Shape& shape = shapes.shape(c);
      if (shape.mass == 0.0) continue;
      for (int k = shape.begin; k < shape.end; ++k) {
        const ClusterShapes::Member& m = shapes.member(k);
        most[m.particle] += shape.stiffness * m.mass;
        diagonal[m.particle] += shape.stiffness * m.mass * (1.0 - m.mass / shape.mass);
      }
    }
  }
};

}  // namespace pliant
