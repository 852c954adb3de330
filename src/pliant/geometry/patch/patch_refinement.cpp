#include "pliant/geometry/patch/patch_refinement.h"

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "pliant/geometry/patch/patch_polygons.h"
#include "pliant/math/error.h"

namespace pliant {
namespace {

using Eigen::Vector3d;

constexpr int kLevel = 10;  // of the grid of points of a patch
constexpr int kSteps = 20;  // tried; of large bodies fewer
constexpr int kFewest = 4;
constexpr double kMostPoints = 1e6;  // looked at
constexpr double kGain = 3e-3;       // of the measure, below which a step is the last
constexpr int kFree = 8;         // numbers of a quadric that leave its edge's ends where they are
constexpr double kFirst = 1e-3;  // damping, of the samples of an edge
constexpr double kMost = 1e3;
constexpr double kSharp = 30.0;  // weight of the greatest distance against a small one

using Row = Eigen::Matrix<double, 1, 10>;

/// The coordinates of an edge's quadric: its monomials about the edge's middle, over its length,
/// in the eight directions that are zero at both ends.
struct EdgeFrame {
  Vector3d middle;
  double length;
  Eigen::Matrix<double, 10, kFree> free;
  Row at(const Vector3d& p) const { return monomials((p - middle) / length); }
};

std::vector<EdgeFrame> frames_of(const PatchBody& body) {
  std::vector<EdgeFrame> frames;
  for (const auto& [a, b] : body.edges) {
    const Vector3d from = body.base.vertices.col(a), to = body.base.vertices.col(b);
    EdgeFrame frame{0.5 * (from + to), (to - from).norm(), {}};
    Eigen::Matrix<double, 10, 2> ends;
    ends << frame.at(from).transpose(), frame.at(to).transpose();
    const Eigen::HouseholderQR<Eigen::Matrix<double, 10, 2>> qr(ends);
    const Eigen::Matrix<double, 10, 10> q = qr.householderQ();
    frame.free = q.rightCols<kFree>();
    frames.push_back(frame);
  }
  return frames;
}

/// A point of the surface, how far it is from the mesh, and by what that changes.
struct Sample {
  int patch;
  PatchSurface::PointMotion motion;
  double distance;  // signed where it can be [m]
  Vector3d slope;   // of the distance
};

class Refinement {
 public:
  Refinement(const PatchBody& body, const NearestTriangle& to_mesh)
      : to_mesh_(to_mesh), frames_(frames_of(body)), body_(body) {
    for (int t = 0; t < body.base.triangles.cols(); ++t) {
      std::array<std::size_t, 3> own{};
      for (int e = 0; e < 3; ++e) {
        std::array<int, 2> ends = {body.base.triangles((e + 1) % 3, t),
                                   body.base.triangles((e + 2) % 3, t)};
        if (ends[0] > ends[1]) std::swap(ends[0], ends[1]);
        const auto place = std::lower_bound(body.edges.begin(), body.edges.end(), ends);
        own[static_cast<std::size_t>(e)] = static_cast<std::size_t>(place - body.edges.begin());
      }
      edges_of_.push_back(own);
    }
    // Q is about a steepness times the signed distance, as fit_quadrics() makes it.
    double steepness = 0.0, free = 0.0;
    for (std::size_t e = 0; e < body.edges.size(); ++e) {
      is_free_.push_back(body.quadrics[e].isZero(0.0) ? 0 : 1);
      if (is_free_[e] == 0) continue;
      steepness += gradient(body.quadrics[e], frames_[e].middle).norm();
      free += 1.0;
    }
    for (const EdgeFrame& frame : frames_) {
      scales_.push_back(free > 0.0 ? steepness / free * frame.length : 0.0);
    }
  }

  PatchBody run() {
    samples_ = look(body_);
    if (!samples_) return body_;
    double damping = kFirst;
    const double steps = kMostPoints / static_cast<double>(samples_->size());
    const int most = static_cast<int>(std::clamp<double>(steps, kFewest, kSteps));
    for (int step = 0; step < most && damping <= kMost; ++step) {
      weigh();
      if (greatest_ == 0.0) break;
      const std::optional<PatchBody> next = stepped(damping);
      std::optional<std::vector<Sample>> there = next ? look(*next) : std::nullopt;
      const double before = measure(*samples_), after = there ? measure(*there) : before;
      if (after < before) {
        body_ = *next;
        samples_ = std::move(there);
        if (after > (1.0 - kGain) * before) break;
        damping = std::max(0.2 * damping, 1e-6);
      } else {
        damping *= 6.0;
      }
    }
    return body_;
  }

 private:
  static constexpr int kPatch = 3 * kFree;

  /// None where the surface is none.
  std::optional<std::vector<Sample>> look(const PatchBody& body) const {
    std::vector<Sample> samples;
    try {
      const PatchSurface surface(body);
      const PatchPolygons polygons = polygonise(surface, kLevel);
      for (int v = static_cast<int>(body.base.vertices.cols()); v < polygons.patch.size(); ++v) {
        Sample sample{polygons.patch[v],
                      surface.motion(polygons.patch[v], polygons.barycentric.col(v)),
                      0.0,
                      {}};
        const Vector3d p = sample.motion.point;
        const NearestTriangle::Result nearest = to_mesh_(p);
        const auto t = to_mesh_.mesh().triangles.col(nearest.triangle);
        const auto& x = to_mesh_.mesh().vertices;
        const Vector3d normal =
            (x.col(t[1]) - x.col(t[0])).cross(x.col(t[2]) - x.col(t[0])).normalized();
        const Vector3d apart = p - nearest.point;
        const double side = apart.dot(normal) < 0.0 ? -1.0 : 1.0;
        sample.distance = side * nearest.distance;
        sample.slope = nearest.distance > 0.0 ? Vector3d(side / nearest.distance * apart) : normal;
        samples.push_back(sample);
      }
    } catch (const InputError&) {
      return std::nullopt;
    }
    return samples;
  }

  void weigh() {
    greatest_ = 0.0;
    for (const Sample& s : *samples_) greatest_ = std::max(greatest_, std::abs(s.distance));
  }
  double weight(double distance) const {
    const double share = distance / greatest_;
    return 1.0 + kSharp * std::pow(share, 4);
  }
  /// ∫ of the weighted distance, which the weights make.
  double measure(const std::vector<Sample>& samples) const {
    double sum = 0.0;
    for (const Sample& s : samples) {
      const double share = s.distance / greatest_, square = share * share;
      sum += square + kSharp / 3.0 * square * square * square;
    }
    return sum;
  }

  std::optional<PatchBody> stepped(double damping) const {
    const auto unknowns = static_cast<Eigen::Index>(kFree * frames_.size());
    Eigen::VectorXd right = Eigen::VectorXd::Zero(unknowns);
    std::vector<Eigen::Matrix<double, kPatch, kPatch>> blocks(
        edges_of_.size(), Eigen::Matrix<double, kPatch, kPatch>::Zero());
    Eigen::VectorXd counts = Eigen::VectorXd::Zero(unknowns);
    for (const Sample& sample : *samples_) {
      const auto& own = edges_of_[static_cast<std::size_t>(sample.patch)];
      Eigen::Matrix<double, 1, kPatch> row = Eigen::Matrix<double, 1, kPatch>::Zero();
      const double along = sample.slope.dot(sample.motion.direction);
      for (std::size_t e = 0; e < 3; ++e) {
        if (is_free_[own[e]] == 0) continue;
        const EdgeFrame& frame = frames_[own[e]];
        row.segment<kFree>(static_cast<Eigen::Index>(kFree * e)) =
            along * sample.motion.rates[e] * scales_[own[e]] * frame.at(sample.motion.point) *
            frame.free;
      }
      const double w = weight(sample.distance);
      blocks[static_cast<std::size_t>(sample.patch)] += w * row.transpose() * row;
      for (std::size_t e = 0; e < 3; ++e) {
        right.segment<kFree>(static_cast<Eigen::Index>(kFree * own[e])) -=
            w * sample.distance * row.segment<kFree>(static_cast<Eigen::Index>(kFree * e));
      }
    }
    return solved(blocks, right, damping);
  }

  std::optional<PatchBody> solved(const std::vector<Eigen::Matrix<double, kPatch, kPatch>>& blocks,
                                  const Eigen::VectorXd& right, double damping) const {
    std::vector<Eigen::Triplet<double>> entries;
    const auto place = [&](std::size_t t, int k) {
      return static_cast<int>(kFree * edges_of_[t][static_cast<std::size_t>(k / kFree)]) +
             k % kFree;
    };
    for (std::size_t t = 0; t < blocks.size(); ++t) {
      for (int i = 0; i < kPatch; ++i) {
        for (int j = 0; j < kPatch; ++j) {
          entries.emplace_back(place(t, i), place(t, j), blocks[t](i, j));
        }
      }
    }
    for (std::size_t e = 0; e < frames_.size(); ++e) {
      const double length = frames_[e].length;
      for (int k = 0; k < kFree; ++k) {
        const int at = static_cast<int>(kFree * e) + k;
        entries.emplace_back(at, at, damping * kLevel * kLevel * length * length);
      }
    }
    Eigen::SparseMatrix<double> system(right.size(), right.size());
    system.setFromTriplets(entries.begin(), entries.end());
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(system);
    if (factor.info() != Eigen::Success) return std::nullopt;
    const Eigen::VectorXd change = factor.solve(right);
    if (!change.allFinite()) return std::nullopt;
    PatchBody next = body_;
    for (std::size_t e = 0; e < frames_.size(); ++e) {
      if (is_free_[e] == 0) continue;
      const Eigen::Matrix<double, 10, 1> own =
          frames_[e].free * change.segment<kFree>(static_cast<Eigen::Index>(kFree * e));
      next.quadrics[e] += scales_[e] * placed(own, frames_[e].middle, frames_[e].length);
    }
    return next;
  }

  const NearestTriangle& to_mesh_;
  std::vector<EdgeFrame> frames_;
  PatchBody body_;
  std::vector<std::array<std::size_t, 3>> edges_of_;
  std::vector<char> is_free_;
  std::vector<double> scales_;  // of a quadric's numbers: |grad Q| times the edge's length
  std::optional<std::vector<Sample>> samples_;
  double greatest_ = 1.0;
};

}  // namespace

PatchBody refine_quadrics(const PatchBody& body, const NearestTriangle& to_mesh) {
  return Refinement(body, to_mesh).run();
}

}  // namespace pliant
