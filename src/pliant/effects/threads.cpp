#include "pliant/effects/threads.h"

#include <Eigen/LU>

#include "pliant/elements/coloring.h"
#include "pliant/elements/spring_set.h"
#include "pliant/elements/triangle_strain_set.h"

namespace pliant {
namespace {

/// Springs along threads, or null.
const SpringSet* springs_along_threads(const ElementSet& set) {
  const auto* springs = dynamic_cast<const SpringSet*>(&set);
  return springs != nullptr && springs->name() == "stretch" ? springs : nullptr;
}

void take(const SpringSet& springs, std::vector<Thread>& threads) {
  for (const Spring& s : springs.springs()) {
    threads.push_back({{s.i, s.j, s.i}, {-1.0, 1.0, 0.0}, s.rest_length});
  }
}

void take(const TriangleStrainSet& triangles, std::vector<Thread>& threads) {
  for (const Simplex<2>& t : triangles.simplices().elements) {
    for (int k = 0; k < 2; ++k) {
      // Weights of at most 1 make it a length.
      const double length = 1.0 / t.shape.row(k).cwiseAbs().maxCoeff();
      const Eigen::RowVector3d w = length * t.shape.row(k);
      threads.push_back({t.vertices, {w[0], w[1], w[2]}, length});
    }
  }
}

Threads color(const std::vector<Thread>& threads, int particles) {
  std::vector<int> vertices, begins = {0};
  for (const Thread& thread : threads) {
    const auto count =
        thread.weights[2] == 0.0 && thread.particles[2] == thread.particles[0] ? 2 : 3;
    vertices.insert(vertices.end(), thread.particles.begin(), thread.particles.begin() + count);
    begins.push_back(static_cast<int>(vertices.size()));
  }
  const Coloring coloring = color_elements(vertices, begins, particles);
  Threads sorted;
  sorted.begins = coloring.begins;
  sorted.all.reserve(threads.size());
  for (const int t : coloring.order) sorted.all.push_back(threads[static_cast<std::size_t>(t)]);
  return sorted;
}

}  // namespace

Threads find_threads(const std::vector<std::unique_ptr<ElementSet>>& elements, int particles) {
  std::vector<Thread> threads;
  for (const auto& set : elements) {
    if (const SpringSet* springs = springs_along_threads(*set)) take(*springs, threads);
  }
  for (const auto& set : elements) {
    const auto* triangles = dynamic_cast<const TriangleStrainSet*>(set.get());
    if (triangles != nullptr) take(*triangles, threads);
  }
  return color(threads, particles);
}

std::vector<ClothEdge> find_ways(const std::vector<std::unique_ptr<ElementSet>>& elements) {
  std::vector<ClothEdge> ways;
  for (const auto& set : elements) {
    if (const SpringSet* springs = springs_along_threads(*set)) {
      for (const Spring& s : springs->springs()) ways.push_back({s.i, s.j, s.rest_length});
    }
    const auto* triangles = dynamic_cast<const TriangleStrainSet*>(set.get());
    if (triangles == nullptr) continue;
    for (const Simplex<2>& t : triangles->simplices().elements) {
      Eigen::Matrix<double, 2, 3> corners;  // along warp and weft [m]
      corners << Eigen::Vector2d::Zero(), t.shape.rightCols<2>().transpose().inverse();
      for (int k = 0; k < 3; ++k) {
        const int next = (k + 1) % 3;
        ways.push_back({t.vertices[static_cast<std::size_t>(k)],
                        t.vertices[static_cast<std::size_t>(next)],
                        (corners.col(next) - corners.col(k)).lpNorm<1>()});
      }
    }
  }
  return ways;
}

}  // namespace pliant
