// Files of another library through the command line.
#include <gtest/gtest.h>

#include <cstring>
#include <fstream>

#include "pliant/geometry/io/tetrahedral_file.h"
#include "pliant/models/reduced/files/cub_model.h"
#include "pliant/models/reduced/files/reduced_file.h"
#include "unit/app/program.h"
#include "unit/models/reduced/stvk_examples.h"
#include "unit/scene/scene_files.h"

namespace pliant {
namespace {

template <class Number>
void append(std::string& bytes, Number value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// Uᵀ R(U q) as the library's loops write it, by differences of exact forces: a cubic polynomial
/// without constant is fixed by its values at ±a, ±2a of every direction that it needs.
class Polynomial {
 public:
  Polynomial(const ReducedModel& model, QuarticPotential::Workspace& space)
      : model_(model), space_(space) {}

  Eigen::VectorXd force(const Eigen::VectorXd& q) const {
    Eigen::VectorXd r;
    model_.potential.evaluate(q, r, space_);
    return r;
  }
  /// Part of degree 1, 2 or 3 at q: that of degree d grows as s^d.
  Eigen::VectorXd part(int degree, const Eigen::VectorXd& q) const {
    const Eigen::VectorXd plus = force(q), minus = force(-q), twice = force(2.0 * q);
    const Eigen::VectorXd even = 0.5 * (plus + minus), odd = 0.5 * (plus - minus);
    if (degree == 2) return even;
    const Eigen::VectorXd cubic = (twice - 4.0 * even - 2.0 * odd) / 6.0;
    return degree == 3 ? cubic : (odd - cubic).eval();
  }
  /// Coefficient of q_i q_j (q_k), of all components.
  Eigen::VectorXd coefficient(const std::vector<int>& indices) const {
    // Polarisation: sums over subsets with signs.
    const int n = static_cast<int>(indices.size());
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(model_.rank());
    for (int subset = 1; subset < 1 << n; ++subset) {
      Eigen::VectorXd q = Eigen::VectorXd::Zero(model_.rank());
      int chosen = 0;
      for (int k = 0; k < n; ++k) {
        if ((subset >> k & 1) == 0) continue;
        q[indices[static_cast<std::size_t>(k)]] += 1.0;
        ++chosen;
      }
      sum += ((n - chosen) % 2 == 0 ? 1.0 : -1.0) * part(n, q);
    }
    // n! times the symmetric coefficient, which stands once for each order of its indices.
    double repeats = 1.0;
    for (std::size_t k = 1, same = 1; k < indices.size(); ++k) {
      same = indices[k] == indices[k - 1] ? same + 1 : 1;
      repeats *= static_cast<double>(same);
    }
    return sum / repeats;
  }

 private:
  const ReducedModel& model_;
  QuarticPotential::Workspace& space_;
};

std::string cub_of(const ReducedModel& model) {
  QuarticPotential::Workspace space;
  const Polynomial polynomial(model, space);
  const int r = model.rank();
  std::vector<Eigen::VectorXd> degrees[3];
  for (int i = 0; i < r; ++i) {
    degrees[0].push_back(polynomial.coefficient({i}));
    for (int j = i; j < r; ++j) {
      degrees[1].push_back(polynomial.coefficient({i, j}));
      for (int k = j; k < r; ++k) degrees[2].push_back(polynomial.coefficient({i, j, k}));
    }
  }
  std::string bytes;
  append(bytes, static_cast<std::int32_t>(r));
  for (const auto& degree : degrees) append(bytes, static_cast<std::int32_t>(degree.size()));
  for (const auto& degree : degrees) {
    for (int l = 0; l < r; ++l) {
      for (const Eigen::VectorXd& one : degree) append(bytes, one[l]);
    }
  }
  return bytes;
}

std::string matrix_bytes(const Eigen::MatrixXd& matrix) {
  std::string bytes;
  append(bytes, static_cast<std::int32_t>(matrix.rows()));
  append(bytes, static_cast<std::int32_t>(matrix.cols()));
  bytes.append(reinterpret_cast<const char*>(matrix.data()),
               static_cast<std::size_t>(matrix.size()) * sizeof(double));
  return bytes;
}

class ReduceCub : public testing::Test {
 protected:
  ReduceCub()
      : model_(*reduce(cantilever({{1.0, 0.2, 0.2}, {6, 2, 2}}, {1e6, 0.3, 1000.0}), {2, 4}, "beam",
                       go_on)) {
    write_msh(files_.path("beam.msh"), model_.mesh);
    files_.write("beam.cub", cub_of(model_));
    files_.write("beam.U", matrix_bytes(model_.basis));
  }
  Outcome convert(const std::string& options) const {
    return run("reduce " + files_.path("beam.msh") + " --young 1e6 --overwrite --out " + out_ +
               " --basis " + files_.path("beam.U") + " --cub " + files_.path("beam.cub") + options);
  }
  void expect_refused(const std::string& options, const std::string& part) const {
    const Outcome outcome = convert(options);
    EXPECT_EQ(outcome.code, 2) << outcome.text;
    EXPECT_TRUE(holds(outcome.text, part)) << outcome.text;
  }
  SceneFiles files_;
  ReducedModel model_;
  const std::string out_ = files_.path("beam.prm");
};

TEST_F(ReduceCub, BecomesTheModelThatTheFilesAreOf) {
  const Outcome outcome = convert("");
  ASSERT_EQ(outcome.code, 0) << outcome.text;
  EXPECT_TRUE(holds(outcome.text, "force: differs from this mesh and material's by"));
  const ReducedModel read = read_reduced_model(out_);
  ASSERT_EQ(read.rank(), 4);
  EXPECT_EQ(read.fixed, model_.fixed);
  EXPECT_LT((read.potential.lambda() - model_.potential.lambda()).norm(),
            1e-9 * model_.potential.lambda().norm());
  EXPECT_LT(force_difference(read), 1e-9);
}

TEST_F(ReduceCub, SaysHowFarTheMaterialIsOff) {
  const Outcome outcome = convert(" --young 2e6");
  EXPECT_EQ(outcome.code, 2);  // given twice
  const ReducedModel read = make_cub_model(files_.path("beam.cub"), files_.path("beam.U"),
                                           model_.mesh, {2e6, 0.3, 1000.0}, "beam");
  EXPECT_NEAR(force_difference(read), 0.5, 1e-9);  // forces are in proportion to it
}

TEST_F(ReduceCub, RefusesWhatDoesNotFit) {
  expect_refused(" --density 1001", "not mass-orthonormal");
  expect_refused(" --rank 4", "belong to a reduction");
  files_.write("beam.U", matrix_bytes(model_.basis.leftCols(3)));
  expect_refused("", "3 numbers, but the mesh has");
  const std::string good = matrix_bytes(model_.basis);
  files_.write("beam.U", good.substr(0, good.size() - 8));
  expect_refused("", "bytes, but a matrix of");
  files_.write("beam.U", "ab");
  expect_refused("", "too few bytes");
  Eigen::MatrixXd bad = model_.basis;
  bad(0, 0) = std::nan("");
  files_.write("beam.U", matrix_bytes(bad));
  expect_refused("", "not finite");
  const Outcome alone = run("reduce " + files_.path("beam.msh") + " --out " + out_ + " --cub " +
                            files_.path("beam.cub"));
  EXPECT_EQ(alone.code, 2);
  EXPECT_TRUE(holds(alone.text, "--cub and --basis go together")) << alone.text;
}

}  // namespace
}  // namespace pliant
