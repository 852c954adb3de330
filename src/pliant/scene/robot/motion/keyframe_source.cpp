#include <fmt/format.h>

#include "pliant/math/error.h"
#include "pliant/scene/robot/motion/keyframes.h"
#include "pliant/scene/yaml/place_error.h"

namespace pliant {
namespace {

class KeyframeSource final : public JointSource {
 public:
  KeyframeSource(Keyframes keyframes, std::vector<std::size_t> indices)
      : keyframes_(std::move(keyframes)), indices_(std::move(indices)) {}

  void positions(double time, std::vector<double>& positions) override {
    for (std::size_t j = 0; j < indices_.size(); ++j) {
      positions[indices_[j]] = keyframes_.position(static_cast<int>(j), time);
    }
  }

 private:
  Keyframes keyframes_;
  std::vector<std::size_t> indices_;  // of the robot's joints
};

}  // namespace

std::shared_ptr<JointSource> make_keyframe_source(const Keyframes& keyframes, const Robot& robot,
                                                  const std::string& where) {
  std::vector<std::size_t> indices;
  for (std::size_t j = 0; j < keyframes.joints().size(); ++j) {
    const std::string& joint = keyframes.joints()[j];
    const int index = with_place(where, [&] { return robot.find_joint(joint); });
    indices.push_back(static_cast<std::size_t>(index));
    if (robot.limit_rule() != JointLimitRule::kRefuse) continue;
    // Interpolation stays between keyframes, so that these are all that has to be in range.
    const Robot::Limits limits = robot.limits(index);
    const KeyframeSamples& samples = keyframes.samples();
    for (Eigen::Index k = 0; k < samples.positions.cols(); ++k) {
      const double position = samples.positions(static_cast<Eigen::Index>(j), k);
      if (position >= limits.lower && position <= limits.upper) continue;
      throw InputError(fmt::format(
          "{}: keyframes[{}] puts joint '{}' at {}, but its limits are {:g} to {:g} [m or rad]; "
          "'limits: clamp' or 'limits: warn' of the robot takes it all the same",
          where, samples.keyframes[static_cast<std::size_t>(k)], joint, position, limits.lower,
          limits.upper));
    }
  }
  return std::make_shared<KeyframeSource>(keyframes, std::move(indices));
}

}  // namespace pliant
