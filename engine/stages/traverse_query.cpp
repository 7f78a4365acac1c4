// SPDX-License-Identifier: MIT
#include "stages/traverse_query.hpp"

#include <array>
#include <cstring>

#include "core/error.hpp"
#include "interface/push/push.h"

namespace sheaf {
namespace {
using Usage = vk::BufferUsageFlagBits;
constexpr auto structure_input = Usage::eShaderDeviceAddress | Usage::eAccelerationStructureBuildInputReadOnlyKHR;
constexpr std::uint64_t scratch_alignment =
    256;  // at least every device's minAccelerationStructureScratchOffsetAlignment
}  // namespace

TraverseQuery::TraverseQuery(const TraceContext& c) : context_(c) {
  if (!c.device.limits().ray_query)
    throw Error(ErrorKind::device,
                c.device.summary().name + ": --strategy rayquery: the device has no VK_KHR_ray_query");
  const std::array constants{SpecConstant{SPEC_TRANSFORM_ON_FETCH, c.plan.transform_on_fetch}};
  boxes_kernel_ = Kernel(c.device, "objects_boxes", constants);
  auto make = [&](bool any_hit) { return Kernel(c.device, "traverse_query", candidate_constants(c, any_hit)); };
  nearest_ = make(false);
  if (c.plan.shadows) any_ = make(true);
  boxes_ = Buffer(c.device, "triangle boxes", std::uint64_t{c.scene.triangles()} * 24, Buffer::Kind::device,
                  structure_input);
  instance_ = Buffer(c.device, "structure instance", sizeof(VkAccelerationStructureInstanceKHR), Buffer::Kind::upload,
                     structure_input);
}

void TraverseQuery::build(Recorder& recorder, Structure& structure,
                          const vk::AccelerationStructureGeometryKHR& geometry, vk::AccelerationStructureTypeKHR type,
                          std::uint32_t primitives) {
  vk::AccelerationStructureBuildGeometryInfoKHR info(type, vk::BuildAccelerationStructureFlagBitsKHR::ePreferFastTrace,
                                                     vk::BuildAccelerationStructureModeKHR::eBuild);
  info.setGeometries(geometry);
  const auto& device = context_.device.logical();
  if (!structure.storage) {
    const auto sizes =
        device.getAccelerationStructureBuildSizesKHR(vk::AccelerationStructureBuildTypeKHR::eDevice, info, primitives);
    structure.storage =
        Buffer(context_.device, "acceleration structure", sizes.accelerationStructureSize, Buffer::Kind::device,
               Usage::eAccelerationStructureStorageKHR | Usage::eShaderDeviceAddress);
    structure.scratch = Buffer(context_.device, "acceleration scratch", sizes.buildScratchSize + scratch_alignment,
                               Buffer::Kind::device, Usage::eShaderDeviceAddress);
    structure.handle = vk::raii::AccelerationStructureKHR(
        device, vk::AccelerationStructureCreateInfoKHR({}, structure.storage.handle(), 0,
                                                       sizes.accelerationStructureSize, type));
  }
  info.dstAccelerationStructure = *structure.handle;
  info.scratchData = (structure.scratch.address() + scratch_alignment - 1) / scratch_alignment * scratch_alignment;
  const vk::AccelerationStructureBuildRangeInfoKHR range(primitives);
  const vk::AccelerationStructureBuildRangeInfoKHR* ranges = &range;
  recorder.commands().buildAccelerationStructuresKHR(info, ranges);
  const vk::MemoryBarrier built(vk::AccessFlagBits::eAccelerationStructureWriteKHR,
                                vk::AccessFlagBits::eAccelerationStructureReadKHR);
  const auto build_stage = vk::PipelineStageFlagBits::eAccelerationStructureBuildKHR;
  recorder.commands().pipelineBarrier(build_stage, build_stage | vk::PipelineStageFlagBits::eComputeShader, {}, built,
                                      {}, {});
}

void TraverseQuery::objects_moved(Recorder& recorder, const Motion& motion) {
  if (motion.moved_instances == 0 || context_.scene.triangles() == 0) return;
  const std::uint32_t triangles = context_.scene.triangles();
  recorder.stage("objects");
  recorder.bind(ROLE_BOXES, boxes_);
  recorder.dispatch(boxes_kernel_, gpu::NoPush{}, (triangles + gpu::GROUP - 1) / gpu::GROUP);
  const vk::MemoryBarrier written(vk::AccessFlagBits::eShaderWrite,
                                  vk::AccessFlagBits::eShaderRead | vk::AccessFlagBits::eAccelerationStructureReadKHR);
  recorder.commands().pipelineBarrier(vk::PipelineStageFlagBits::eComputeShader,
                                      vk::PipelineStageFlagBits::eAccelerationStructureBuildKHR, {}, written, {}, {});

  vk::AccelerationStructureGeometryKHR boxes(vk::GeometryTypeKHR::eAabbs);
  boxes.geometry.aabbs =
      vk::AccelerationStructureGeometryAabbsDataKHR(vk::DeviceOrHostAddressConstKHR(boxes_.address()), 24);
  build(recorder, bottom_, boxes, vk::AccelerationStructureTypeKHR::eBottomLevel, triangles);

  VkAccelerationStructureInstanceKHR instance{};
  for (int axis = 0; axis < 3; ++axis) instance.transform.matrix[axis][axis] = 1;
  instance.mask = 0xFF;
  instance.accelerationStructureReference =
      context_.device.logical().getAccelerationStructureAddressKHR({*bottom_.handle});
  std::memcpy(instance_.mapped(), &instance, sizeof(instance));
  vk::AccelerationStructureGeometryKHR instances(vk::GeometryTypeKHR::eInstances);
  instances.geometry.instances =
      vk::AccelerationStructureGeometryInstancesDataKHR(VK_FALSE, vk::DeviceOrHostAddressConstKHR(instance_.address()));
  build(recorder, top_, instances, vk::AccelerationStructureTypeKHR::eTopLevel, 1);
  recorder.bind_structure(*top_.handle);
}

void TraverseQuery::trace(Recorder& recorder, const RayList& list, std::uint32_t kind, std::uint32_t) {
  recorder.stage("traverse");
  if (context_.scene.triangles() == 0) {  // no structure is built of nothing
    recorder.fill(list.hits, 0xFFFFFFFFU);
    if (list.optical_depth) recorder.fill(list.optical_depth, 0);
    return;
  }
  list.bind(recorder);
  recorder.dispatch_indirect(kind == gpu::KIND_SHADOW ? any_ : nearest_, gpu::KindPush{kind}, gpu::ARGS_RAYS);
}

}  // namespace sheaf
