// SPDX-License-Identifier: MIT
// Strategy `rayquery`: VK_KHR_ray_query over the triangles' boxes, rebuilt when something moved.
#pragma once

#include "stages/tracer.hpp"
#include "vulkan/kernel.hpp"

namespace sheaf {

class TraverseQuery final : public Tracer {
 public:
  /// Throws Error{device} where the device has no ray query.
  explicit TraverseQuery(const TraceContext& context);
  void objects_moved(Recorder& recorder, const Motion& motion) override;
  void trace(Recorder& recorder, const RayList& list, std::uint32_t kind, std::uint32_t generation) override;

 private:
  struct Structure {
    Buffer storage, scratch;
    vk::raii::AccelerationStructureKHR handle{nullptr};
  };
  void build(Recorder& recorder, Structure& structure, const vk::AccelerationStructureGeometryKHR& geometry,
             vk::AccelerationStructureTypeKHR type, std::uint32_t primitives);

  TraceContext context_;
  Kernel boxes_kernel_, nearest_, any_;
  Buffer boxes_, instance_;
  Structure bottom_, top_;
};

}  // namespace sheaf
