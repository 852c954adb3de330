#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace pliant {

/// What a generated scene is made of: one value of each factor. The first value of a factor is its
/// simplest one, to which a failing scene is shrunk.
enum Factor {
  kFactorModel,
  kFactorSolver,
  kFactorSurroundings,
  kFactorShape,
  kFactorFlags,
  kFactorStiffness,
  kFactorIterations,
  kFactorIntegration,
  kFactorStart,
  kFactorEffects,
  kFactorSelfContact,
  kFactorPlace,
  kFactorTilt,
  kFactorStep,
  kFactorSize,
  kFactorCount
};

/// Indices into the values of each factor.
using SceneChoice = std::array<int, kFactorCount>;

struct SceneFactor {
  std::string name;
  std::vector<std::string> values;
};

/// In the order of Factor.
const std::array<SceneFactor, kFactorCount>& scene_factors();
const std::string& value_of(const SceneChoice& choice, Factor factor);

/// Whether two values go together in principle: a solver with the model it moves. What is legal to
/// write and refused for another reason is left in: refusals are tested too.
bool go_together(Factor one, int value, Factor other, int other_value);
bool is_possible(const SceneChoice& choice);

/// "model: cloth, solver: xpbd, ..." with all factors, and back. Throws InputError for text that is
/// no such choice.
std::string choice_text(const SceneChoice& choice);
SceneChoice choice_of(const std::string& text, const std::string& where);

/// `count` scenes, always the same ones for a `seed`: every two values that go together stand in
/// one of the first few hundred, and again, among other company, in one of the next.
std::vector<SceneChoice> plan_scenes(int count, std::uint64_t seed);

}  // namespace pliant
