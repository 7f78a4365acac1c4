// SPDX-License-Identifier: MIT
// Embree 3.13 and 4 under one set of names: their query functions take their options differently.
#pragma once

#if BENCH_EMBREE_MAJOR >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace bench {

/// What a query is given beside its rays.
class Query {
 public:
  explicit Query(bool coherent) {
#if BENCH_EMBREE_MAJOR >= 4
    rtcInitIntersectArguments(&nearest_);
    rtcInitOccludedArguments(&any_);
    nearest_.flags = any_.flags = coherent ? RTC_RAY_QUERY_FLAG_COHERENT : RTC_RAY_QUERY_FLAG_INCOHERENT;
#else
    rtcInitIntersectContext(&context_);
    context_.flags = coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
#endif
  }

#if BENCH_EMBREE_MAJOR >= 4
  void nearest(RTCScene scene, RTCRayHit& ray) { rtcIntersect1(scene, &ray, &nearest_); }
  void nearest(RTCScene scene, const int* valid, RTCRayHit16& rays) { rtcIntersect16(valid, scene, &rays, &nearest_); }
  void any(RTCScene scene, RTCRay& ray) { rtcOccluded1(scene, &ray, &any_); }
  void any(RTCScene scene, const int* valid, RTCRay16& rays) { rtcOccluded16(valid, scene, &rays, &any_); }

 private:
  RTCIntersectArguments nearest_;
  RTCOccludedArguments any_;
#else
  void nearest(RTCScene scene, RTCRayHit& ray) { rtcIntersect1(scene, &context_, &ray); }
  void nearest(RTCScene scene, const int* valid, RTCRayHit16& rays) { rtcIntersect16(valid, scene, &context_, &rays); }
  void any(RTCScene scene, RTCRay& ray) { rtcOccluded1(scene, &context_, &ray); }
  void any(RTCScene scene, const int* valid, RTCRay16& rays) { rtcOccluded16(valid, scene, &context_, &rays); }

 private:
  RTCIntersectContext context_;
#endif
};

}  // namespace bench
