#pragma once

#include <memory>
#include <vector>

#include "cuda/core/upload.h"
#include "pliant/geometry/distance/mesh_shape.h"

namespace pliant {

/// Sampled distances of meshes in an executor's memory, uploaded once as long as they are in use.
template <class Executor>
class DeviceGrids {
 public:
  /// Samples of the mesh `shape`; null of any other.
  const float* samples(Executor& executor, const std::shared_ptr<const Shape>& shape) {
    const auto* mesh = as<MeshShape>(*shape);
    if (mesh == nullptr) return nullptr;
    for (const auto& held : held_) {
      if (held->shape == shape) return held->samples.data();
    }
    held_.push_back(std::make_unique<Held>());
    held_.back()->shape = shape;
    upload_all(executor, held_.back()->samples, mesh->grid().samples);
    return held_.back()->samples.data();
  }

 private:
  struct Held {
    std::shared_ptr<const Shape> shape;  // so that no other takes its address
    typename Executor::template Array<float> samples;
  };
  std::vector<std::unique_ptr<Held>> held_;
};

}  // namespace pliant
