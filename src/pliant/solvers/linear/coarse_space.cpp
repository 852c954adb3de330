#include "pliant/solvers/linear/coarse_space.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "pliant/core/columns.h"

namespace pliant {
namespace {

// Particles of an aggregate, and how many aggregates a body has at the most: the factor of their
// matrix must cost little beside an iteration's product.
constexpr int kMembers = 8;
// A matrix has scalars where vertices act on others than their neighbours. Where rows have more of
// them than this on average, as those of plates do and those of hinges do not, small aggregates
// would all act on each other: so many more members for each scalar beyond.
constexpr int kFewScalars = 8;
constexpr double kMembersPerScalar = 1.0;
// For each particle of a shared stiffness, so that none reaches over many aggregates.
constexpr double kMembersPerShared = 1.0;
constexpr int kMostAggregates = 600;
// Aggregates that a thread takes at the least: of a product, and of the matrix.
constexpr int kGrain = 128, kAssembled = 8;
// Rows on more particles than these tie whole bodies together: a coarse space without them has one
// direction too many, which costs an iteration.
constexpr int kLocal = 16;

/// Aggregates of up to `most` particles, each grown around the lowest that none has yet.
class Growth {
 public:
  Growth(const BlockMatrix& matrix, const Particles& particles, int most)
      : matrix_(matrix),
        particles_(particles),
        most_(most),
        of_(static_cast<std::size_t>(matrix.size()), -1),
        shares_(of_.size(), 0) {
    for (int i = 0; i < matrix.size(); ++i) {
      if (is_free(i)) grow(i);
    }
  }
  std::vector<int> take() { return std::move(of_); }

 private:
  bool is_free(int i) const {
    return of_[static_cast<std::size_t>(i)] < 0 && !particles_.is_fixed(i);
  }

  void grow(int seed) {
    members_.assign(1, seed);
    of_[static_cast<std::size_t>(seed)] = count_;
    for (std::size_t k = 0; k < members_.size(); ++k) {
      const int member = members_[k];
      matrix_.for_columns(member, [&](int other) {
        if (static_cast<int>(members_.size()) == most_) return false;
        if (is_free(other)) {
          of_[static_cast<std::size_t>(other)] = count_;
          members_.push_back(other);
        }
        return true;
      });
    }
    take_sharing(seed);
    if (3 * static_cast<int>(members_.size()) < most_ && give_away()) return;
    ++count_;
  }

  /// Of those that share stiffnesses with `seed` the ones that share the most.
  void take_sharing(int seed) {
    candidates_.clear();
    const auto wanted = static_cast<std::size_t>(most_);
    if (members_.size() >= wanted) return;
    matrix_.shared().for_sharing(seed, [&](int other) {
      if (!is_free(other)) return true;
      if (shares_[static_cast<std::size_t>(other)]++ == 0) candidates_.push_back(other);
      return true;
    });
    const auto shares = [&](int i) { return shares_[static_cast<std::size_t>(i)]; };
    std::sort(candidates_.begin(), candidates_.end(), [&](int i, int j) {
      return std::make_pair(-shares(i), i) < std::make_pair(-shares(j), j);
    });
    for (const int candidate : candidates_) {
      shares_[static_cast<std::size_t>(candidate)] = 0;
      if (members_.size() == wanted) continue;
      of_[static_cast<std::size_t>(candidate)] = count_;
      members_.push_back(candidate);
    }
  }

  /// Members of an aggregate that found too few of them join their neighbours' aggregates.
  bool give_away() {
    int to = -1;
    const auto see = [&](int column) {
      const int other = of_[static_cast<std::size_t>(column)];
      if (other >= 0 && other != count_) to = other;
      return true;
    };
    for (const int i : members_) {
      matrix_.for_columns(i, see);
      matrix_.shared().for_sharing(i, see);
    }
    if (to < 0) return false;
    for (const int i : members_) of_[static_cast<std::size_t>(i)] = to;
    return true;
  }

  const BlockMatrix& matrix_;
  const Particles& particles_;
  int most_, count_ = 0;
  std::vector<int> of_, members_;
  std::vector<int> candidates_, shares_;  // of each particle with the seed
};

using Top = Eigen::Matrix<double, 3, 6>;

/// Pᵢᵀ T with P = (1, −[p]×) for the arm p of a particle.
BlockCholesky::Block with_torques(const Top& top, const Eigen::Vector3d& p) {
  BlockCholesky::Block block;
  block.topRows<3>() = top;
  for (int c = 0; c < 6; ++c) {
    block.col(c).tail<3>() = p.cross(Eigen::Vector3d(top.col(c)));
  }
  return block;
}

/// Pᵢᵀ K Pⱼ for the arms p and q of two particles: what their block K does between the pieces that
/// they belong to.
BlockCholesky::Block between(const Eigen::Matrix3d& k, const Eigen::Vector3d& p,
                             const Eigen::Vector3d& q) {
  Top top;
  top.leftCols<3>() = k;
  for (int c = 0; c < 3; ++c) {
    const int d = (c + 1) % 3, e = (c + 2) % 3;
    top.col(3 + c) = q[d] * k.col(e) - q[e] * k.col(d);
  }
  return with_torques(top, p);
}

/// Σ s Pⱼ of scalars s, from Σ s and Σ s q.
Top scalars_between(double sum, const Eigen::Vector3d& moment) {
  Top top = Top::Zero();
  for (int c = 0; c < 3; ++c) {
    const int d = (c + 1) % 3, e = (c + 2) % 3;
    top(c, c) = sum;
    top(e, 3 + c) = moment[d];
    top(d, 3 + c) = -moment[e];
  }
  return top;
}

}  // namespace

void CoarseSpace::prepare(const BlockMatrix& matrix, const Particles& particles) {
  const double scalars = double(matrix.scalars()) / std::max(1, matrix.size());
  const double more = kMembersPerScalar * std::max(0.0, scalars - kFewScalars);
  const SharedStiffnesses& shared = matrix.shared();
  const int tied = shared.members() / std::max(1, shared.count());
  const int most = std::max({kMembers + static_cast<int>(more), matrix.size() / kMostAggregates + 1,
                             static_cast<int>(kMembersPerShared * tied)});
  of_ = Growth(matrix, particles, most).take();
  const int count = of_.empty() ? 0 : *std::max_element(of_.begin(), of_.end()) + 1;
  begins_.assign(static_cast<std::size_t>(count) + 1, 0);
  for (const int a : of_) {
    if (a >= 0) ++begins_[static_cast<std::size_t>(a) + 1];
  }
  for (std::size_t a = 1; a < begins_.size(); ++a) begins_[a] += begins_[a - 1];
  members_.resize(static_cast<std::size_t>(begins_.back()));
  std::vector<int> next(begins_.begin(), begins_.end() - 1);
  Pairs pairs;
  for (int i = 0; i < matrix.size(); ++i) {
    const int a = of(i);
    if (a < 0) continue;
    members_[static_cast<std::size_t>(next[static_cast<std::size_t>(a)]++)] = i;
    matrix.for_columns(i, [&](int column) {
      const int b = of(column);
      if (b >= 0 && b < a) pairs.emplace(a, b);
      return true;
    });
  }
  for (int s = 0; s < matrix.shared().count(); ++s) {
    find_sharing(matrix.shared(), s);
    for (const int a : sharing_) {
      for (const int b : sharing_) {
        if (b < a) pairs.emplace(a, b);
      }
    }
  }
  tied_by_elements_.assign(pairs.begin(), pairs.end());
  factor_.analyze(count, tied_by_elements_);
  has_rows_ = false;
  row_scalars_.resize(static_cast<std::size_t>(count));
  arms_.resize(3, matrix.size());
  coarse_.resize(6, count);
}

void CoarseSpace::place(const Positions& x) {
  for (int a = 0; a < count(); ++a) {
    const int begin = begins_[static_cast<std::size_t>(a)];
    const int end = begins_[static_cast<std::size_t>(a) + 1];
    Eigen::Vector3d center = Eigen::Vector3d::Zero();
    for (int k = begin; k < end; ++k) center += x.col(members_[static_cast<std::size_t>(k)]);
    center /= end - begin;
    double squared = 0.0;
    for (int k = begin; k < end; ++k) {
      squared += (x.col(members_[static_cast<std::size_t>(k)]) - center).squaredNorm();
    }
    const double length = squared > 0.0 ? std::sqrt(squared / (end - begin)) : 1.0;
    for (int k = begin; k < end; ++k) {
      const int i = members_[static_cast<std::size_t>(k)];
      arms_.col(i) = (x.col(i) - center) / length;
    }
  }
}

void CoarseSpace::factor(const BlockMatrix& matrix, const HeldRows& rows, const Positions& x) {
  place(x);
  if (ties_rows_) find_pattern(rows);
  factor_.begin();
  // Each aggregate has places of its own in the matrix: those with earlier ones.
  parallel_for(0, count(), kAssembled, [&](int first, int last) {
    for (int a = first; a < last; ++a) add_members(matrix, a);
  });
  add_shared(matrix.shared());
  add_rows(rows);
  factor_.factor();
}

template <class Use>
void CoarseSpace::for_tied(const HeldRows& rows, const Use& use) const {
  const auto of_row = [&](int row) {
    if (rows.entries(row) > kLocal) return;
    for (const auto* e = rows.begin(row); e != rows.end(row); ++e) {
      for (const auto* f = rows.begin(row); f != e; ++f) {
        const int a = of(e->particle), b = of(f->particle);
        if (a >= 0 && b >= 0 && a != b) use(std::max(a, b), std::min(a, b));
      }
    }
  };
  rows.for_each(of_row, [&](const HeldRows::Block& block) { of_row(block.first); });
}

void CoarseSpace::begin_step(bool ties_rows) {
  ties_rows_ = ties_rows;
  // The order of a factor must not depend on what came before the step.
  if (has_rows_) factor_.analyze(count(), tied_by_elements_);
  has_rows_ = false;
}

void CoarseSpace::find_pattern(const HeldRows& rows) {
  bool has_all = true;
  for_tied(rows, [&](int a, int b) { has_all = has_all && factor_.has(a, b); });
  if (has_all) return;
  if (!has_rows_) pattern_ = tied_by_elements_;
  has_rows_ = true;
  for_tied(rows, [&](int a, int b) { pattern_.emplace_back(a, b); });
  std::sort(pattern_.begin(), pattern_.end());
  pattern_.erase(std::unique(pattern_.begin(), pattern_.end()), pattern_.end());
  factor_.analyze(count(), pattern_);
}

void CoarseSpace::add_members(const BlockMatrix& matrix, int a) {
  std::vector<RowScalars>& row = row_scalars_[static_cast<std::size_t>(a)];
  const int end = begins_[static_cast<std::size_t>(a) + 1];
  for (int k = begins_[static_cast<std::size_t>(a)]; k < end; ++k) {
    const int i = members_[static_cast<std::size_t>(k)];
    const Eigen::Vector3d arm = arms_.col(i);
    row.clear();
    matrix.for_entries(
        i,
        [&](int j, const Eigen::Matrix3d& block) {
          const int b = of(j);
          if (b >= 0 && b <= a) factor_.add(a, b, between(block, arm, arms_.col(j)));
        },
        [&](int j, double scalar) {
          const int b = of(j);
          if (b >= 0 && b <= a) add_row_scalar(row, b, scalar, arms_.col(j));
        });
    for (const RowScalars& own : row) {
      factor_.add(a, own.aggregate, with_torques(scalars_between(own.sum, own.moment), arm));
    }
  }
}

void CoarseSpace::find_sharing(const SharedStiffnesses& shared, int number) {
  sharing_.clear();
  for (int m = shared.begin(number); m < shared.end(number); ++m) {
    const int a = of(shared.member(m).particle);
    if (a >= 0) sharing_.push_back(a);
  }
  std::sort(sharing_.begin(), sharing_.end());
  sharing_.erase(std::unique(sharing_.begin(), sharing_.end()), sharing_.end());
}

void CoarseSpace::add_shared(const SharedStiffnesses& shared) {
  if (shared.count() == 0) return;
  for (std::size_t i = 0; i < of_.size(); ++i) {
    const double own = shared.own(static_cast<int>(i));
    if (of_[i] < 0 || own == 0.0) continue;
    const Eigen::Vector3d arm = arms_.col(static_cast<Eigen::Index>(i));
    factor_.add(of_[i], of_[i], with_torques(scalars_between(own, own * arm), arm));
  }
  for (int s = 0; s < shared.count(); ++s) {
    find_sharing(shared, s);
    shares_.assign(sharing_.size(), Block::Zero());
    for (int m = shared.begin(s); m < shared.end(s); ++m) {
      const SharedStiffnesses::Member& member = shared.member(m);
      const auto found = std::lower_bound(sharing_.begin(), sharing_.end(), of(member.particle));
      if (found == sharing_.end() || *found != of(member.particle)) continue;
      Block& share = shares_[static_cast<std::size_t>(found - sharing_.begin())];
      const Eigen::Vector3d arm = arms_.col(member.particle);
      const SharedStiffness::Pulls& pulls = shared.pulls(m);
      const Eigen::Vector3d moment = pulls.move * arm;
      for (int k = 0; k < 3; ++k) {
        const int next = (k + 1) % 3, last = (k + 2) % 3;
        share(k, k) += pulls.move;
        share(k, 3 + next) += moment[last];
        share(k, 3 + last) -= moment[next];
      }
      for (int k = 0; k < SharedStiffness::kTurns; ++k) {
        share.row(3 + k).head<3>() += pulls.turns.col(k);
        share.row(3 + k).tail<3>() += arm.cross(pulls.turns.col(k));
      }
    }
    for (std::size_t a = 0; a < sharing_.size(); ++a) {
      for (std::size_t b = 0; b <= a; ++b) {
        factor_.add(sharing_[a], sharing_[b], -(shares_[a].transpose() * shares_[b]));
      }
    }
  }
}

void CoarseSpace::add_row_scalar(std::vector<RowScalars>& row, int aggregate, double scalar,
                                 const Eigen::Vector3d& arm) {
  for (RowScalars& own : row) {
    if (own.aggregate != aggregate) continue;
    own.sum += scalar;
    own.moment += scalar * arm;
    return;
  }
  row.push_back({aggregate, scalar, scalar * arm});
}

void CoarseSpace::add_rows(const HeldRows& rows) {
  rows.for_each(
      [&](int row) {
        if (rows.entries(row) > kLocal) return;
        ties_rows_ ? add_row(rows, row) : bound_row(rows, row);
      },
      [&](const HeldRows::Block& block) {
        if (block.particles > kLocal) return;
        ties_rows_ ? add_block(rows, block) : bound_block(rows, block);
      });
}

int CoarseSpace::touched(const HeldRows& rows, int row) const {
  int count = 0;
  for (const auto* e = rows.begin(row); e != rows.end(row); ++e) {
    if (of(e->particle) >= 0 && is_first(rows, row, e)) ++count;
  }
  return count;
}

bool CoarseSpace::is_first(const HeldRows& rows, int row, const HeldRows::Entry* e) const {
  return std::none_of(rows.begin(row), e, [&](const HeldRows::Entry& before) {
    return of(before.particle) == of(e->particle);
  });
}

void CoarseSpace::bound_row(const HeldRows& rows, int row) {
  // (Σ gₐ)(Σ gₐ)ᵀ <= c Σ gₐ gₐᵀ over the c aggregates that it touches: a bound whose pattern is
  // that of the diagonal.
  const double scale = touched(rows, row) * rows.stiffness(row);
  for (const auto* e = rows.begin(row); e != rows.end(row); ++e) {
    const int a = of(e->particle);
    if (a < 0 || !is_first(rows, row, e)) continue;
    Vector6 motion = Vector6::Zero();
    for (const auto* f = e; f != rows.end(row); ++f) {
      if (of(f->particle) != a) continue;
      motion.head<3>() += f->gradient;
      motion.tail<3>() += Eigen::Vector3d(arms_.col(f->particle)).cross(f->gradient);
    }
    factor_.add(a, a, scale * motion * motion.transpose());
  }
}

void CoarseSpace::bound_block(const HeldRows& rows, const HeldRows::Block& block) {
  // The same bound, of all of its rows together.
  const double scale = touched(rows, block.first);
  for (int i = 0; i < block.particles; ++i) {
    const int row = rows.particle(block, i), a = of(row);
    for (int j = 0; a >= 0 && j < block.particles; ++j) {
      const int column = rows.particle(block, j);
      if (of(column) != a) continue;
      factor_.add(a, a,
                  between(scale * rows.stiffness(block, i, j), arms_.col(row), arms_.col(column)));
    }
  }
}

void CoarseSpace::add_row(const HeldRows& rows, int row) {
  const auto motion_of = [&](const HeldRows::Entry* e) {
    Vector6 motion;
    motion << e->gradient, Eigen::Vector3d(arms_.col(e->particle)).cross(e->gradient);
    return motion;
  };
  for (const auto* e = rows.begin(row); e != rows.end(row); ++e) {
    const int a = of(e->particle);
    if (a < 0) continue;
    const Vector6 pull = rows.stiffness(row) * motion_of(e);
    for (const auto* f = rows.begin(row); f != rows.end(row); ++f) {
      const int b = of(f->particle);
      if (b >= 0 && b <= a) factor_.add(a, b, pull * motion_of(f).transpose());
    }
  }
}

void CoarseSpace::add_block(const HeldRows& rows, const HeldRows::Block& block) {
  for (int i = 0; i < block.particles; ++i) {
    const int row = rows.particle(block, i), a = of(row);
    for (int j = 0; a >= 0 && j < block.particles; ++j) {
      const int column = rows.particle(block, j), b = of(column);
      if (b < 0 || b > a) continue;
      factor_.add(a, b, between(rows.stiffness(block, i, j), arms_.col(row), arms_.col(column)));
    }
  }
}

void CoarseSpace::solve(const Eigen::Matrix3Xd& r) {
  parallel_for(0, count(), kGrain, [&](int first, int last) {
    for (int a = first; a < last; ++a) {
      Vector6 sum = Vector6::Zero();
      const int end = begins_[static_cast<std::size_t>(a) + 1];
      for (int k = begins_[static_cast<std::size_t>(a)]; k < end; ++k) {
        const int i = members_[static_cast<std::size_t>(k)];
        sum.head<3>() += r.col(i);
        sum.tail<3>() += Eigen::Vector3d(arms_.col(i)).cross(Eigen::Vector3d(r.col(i)));
      }
      coarse_.col(a) = sum;
    }
  });
  factor_.solve(coarse_);
}

}  // namespace pliant
