// Embree 3 (Debian 12, Ubuntu 22.04) or 4 (later ones). They differ in the header's name and in how a ray is
// asked for.
#pragma once
#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace rosefusion {

/// The nearest hit of one ray, written to `query`. From any thread once the scene is committed.
inline void intersect(RTCScene scene, RTCRayHit& query) {
#if RTC_VERSION_MAJOR >= 4
  rtcIntersect1(scene, &query, nullptr);
#else
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(scene, &context, &query);
#endif
}

/// The same for four rays with much the same origin and direction; `valid` is -1 for each ray that counts,
/// 16-byte aligned.
inline void intersectCoherent(RTCScene scene, const int valid[4], RTCRayHit4& query) {
#if RTC_VERSION_MAJOR >= 4
  RTCIntersectArguments arguments;
  rtcInitIntersectArguments(&arguments);
  arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
  rtcIntersect4(valid, scene, &query, &arguments);
#else
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcIntersect4(valid, scene, &context, &query);
#endif
}

}  // namespace rosefusion
