#pragma once

#include <string>
#include <vector>

#include "pliant/core/world.h"
#include "pliant/scene/robot/wrenches.h"
#include "pliant/scene/yaml/scene_value.h"

namespace pliant {

/// The text of scenes.csv: a row a scene, body and recorded step.
class BatchRows {
 public:
  /// `first`: whose obstacles and links have columns; those of other scenes are found by name.
  BatchRows(const World& first, const std::vector<std::string>& paths);

  const std::string& header() const { return header_; }
  const std::vector<Wrench>& wrench_names() const { return names_; }
  /// Of all bodies of a scene, for its last step; `values`: what was varied.
  std::string rows(std::size_t scene, const std::vector<SceneValue>& values, const World& world,
                   const std::string& failure) const;
  /// Of a scene that was refused.
  std::string refused(std::size_t scene, const std::vector<SceneValue>& values,
                      const std::string& refusal) const;
  /// What bodies did to links and obstacles in a world's last step, in the order of the columns.
  std::vector<Wrench> wrenches_of(const World& world) const;

 private:
  static std::string begin_of_row(std::size_t scene, const std::vector<SceneValue>& values);

  std::vector<Wrench> names_;
  std::string header_;
};

}  // namespace pliant
