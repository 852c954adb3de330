#include "pliant/study/generated/generated_oracles.h"

namespace pliant {

SceneChoice shrink(const SceneChoice& choice, const SceneTest& fails) {
  SceneChoice smallest = choice;
  for (bool is_smaller = true; is_smaller;) {
    is_smaller = false;
    for (std::size_t f = 0; f < kFactorCount; ++f) {
      SceneChoice simpler = smallest;
      simpler[f] = 0;
      if (simpler == smallest || !is_possible(simpler) || !fails(simpler)) continue;
      smallest = simpler;
      is_smaller = true;
    }
  }
  return smallest;
}

}  // namespace pliant
