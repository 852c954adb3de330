#include <gtest/gtest.h>

#include <map>

#include "pliant/models/reduced/reduced_model.h"
#include "unit/models/reduced/stvk_examples.h"

namespace pliant {
namespace {

TEST(Reduce, GoesOnFromWhatItsStoreHas) {
  const StvkBody body = cantilever({{1.0, 0.1, 0.12}, {6, 1, 1}}, {1e7, 0.3, 1000.0});
  const ReduceOptions options{3, 5};
  std::map<std::string, Eigen::MatrixXd> kept;
  int made = 0;
  const MatrixStore store = [&](const std::string& name, const auto& make) {
    if (kept.count(name) > 0) return kept[name];
    ++made;
    const Eigen::MatrixXd matrix = make();
    if (matrix.size() > 0) kept[name] = matrix;
    return matrix;
  };
  const auto stop_at = [](const std::string& last) {
    return [last](double, double, const std::string& what) { return what != last; };
  };
  EXPECT_FALSE(reduce(body, options, "beam", stop_at("modal derivatives"), store));
  EXPECT_EQ(kept.size(), 1u);
  EXPECT_FALSE(reduce(body, options, "beam", stop_at("force polynomial"), store));
  EXPECT_EQ(kept.size(), 2u);
  EXPECT_EQ(made, 3);
  const auto resumed = reduce(body, options, "beam", go_on, store);
  EXPECT_EQ(made, 3);
  const auto whole = reduce(body, options, "beam", go_on);
  ASSERT_TRUE(resumed && whole);
  EXPECT_EQ(resumed->basis, whole->basis);
  EXPECT_EQ(resumed->potential.coefficients(), whole->potential.coefficients());
}

}  // namespace
}  // namespace pliant
