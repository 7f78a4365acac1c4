// SPDX-License-Identifier: MIT
#include "embree_tracer.hpp"

#include <cstring>
#include <stdexcept>
#if ORACLE_EMBREE_MAJOR >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace oracle {
namespace {

void check(RTCDevice device, const char* what) {
  if (rtcGetDeviceError(device) != RTC_ERROR_NONE) throw std::runtime_error(std::string("Embree: ") + what);
}

void intersect(RTCScene scene, RTCRayHit& ray) {
#if ORACLE_EMBREE_MAJOR >= 4
  rtcIntersect1(scene, &ray);
#else
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(scene, &context, &ray);
#endif
}

}  // namespace

struct EmbreeTracer::Objects {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  ~Objects() {
    if (scene != nullptr) rtcReleaseScene(scene);
    if (device != nullptr) rtcReleaseDevice(device);
  }
};

EmbreeTracer::EmbreeTracer(std::span<const Triangle> triangles) : objects_(std::make_unique<Objects>()) {
  objects_->device = rtcNewDevice("threads=1");
  check(objects_->device, "no device");
  objects_->scene = rtcNewScene(objects_->device);
  rtcSetSceneFlags(objects_->scene, RTC_SCENE_FLAG_ROBUST);
  if (!triangles.empty()) {
    RTCGeometry geometry = rtcNewGeometry(objects_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* corners = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                                sizeof(glm::vec3), triangles.size() * 3));
    auto* indices = static_cast<unsigned*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                                   3 * sizeof(unsigned), triangles.size()));
    check(objects_->device, "no memory for the triangles");
    std::memcpy(corners, triangles.data(), triangles.size_bytes());
    for (std::size_t i = 0; i < triangles.size() * 3; ++i) indices[i] = static_cast<unsigned>(i);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(objects_->scene, geometry);
    rtcReleaseGeometry(geometry);
  }
  rtcCommitScene(objects_->scene);
  check(objects_->device, "the scene could not be built");
}

EmbreeTracer::~EmbreeTracer() = default;

Hit EmbreeTracer::nearest(const Ray& ray) const {
  RTCRayHit r{};
  r.ray = {};
  r.ray.org_x = ray.origin.x;
  r.ray.org_y = ray.origin.y;
  r.ray.org_z = ray.origin.z;
  r.ray.tnear = ray.tmin;
  r.ray.dir_x = ray.direction.x;
  r.ray.dir_y = ray.direction.y;
  r.ray.dir_z = ray.direction.z;
  r.ray.tfar = ray.tmax;
  r.ray.mask = ~0U;
  r.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  intersect(objects_->scene, r);
  if (r.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {ray.tmax, -1, 0, 0};
  return {r.ray.tfar, static_cast<std::int32_t>(r.hit.primID), r.hit.u, r.hit.v};
}

std::string EmbreeTracer::version() { return RTC_VERSION_STRING; }

}  // namespace oracle
