#include "host/slam/baselines/pose_methods.h"

#include "host/slam/baselines/free_swarm_search.h"
#include "host/slam/baselines/icp.h"
#include "host/slam/tracking/tracker.h"

namespace rosefusion {
namespace {

class PstMethod : public PoseMethod {
 public:
  explicit PstMethod(SwarmSearch& search) : search_(search) {}
  TrackResult track(const DeviceFrame& frame, const Volume& volume, const TrackHistory& history, double,
                    const SearchObserver& observer) override {
    return search_.search(frame, volume, history.last, history.last, observer);
  }

 private:
  SwarmSearch& search_;
};

class FreeSwarmMethod : public PoseMethod {
 public:
  FreeSwarmMethod(Device& device, const Settings& settings, const Intrinsics& intrinsics,
                  const TemplateSet& templates)
      : search_(device, settings, intrinsics, templates) {}
  TrackResult track(const DeviceFrame& frame, const Volume& volume, const TrackHistory& history, double,
                    const SearchObserver& observer) override {
    return search_.search(frame, volume, history.last, history.last, observer);
  }

 private:
  FreeSwarmSearch search_;
};

class GaussNewtonMethod : public PoseMethod {
 public:
  GaussNewtonMethod(PoseRefiner& refiner, const RefineSettings& settings)
      : refiner_(refiner), settings_(settings) {}
  TrackResult track(const DeviceFrame& frame, const Volume& volume, const TrackHistory& history, double,
                    const SearchObserver&) override {
    TrackResult result;
    const Pose& last = history.last;
    const auto descend = [&](int stride, int iterations, const Pose& start) {
      refiner_.selectPixels(frame, stride);
      result.fit = refiner_.refine(volume, std::vector<Pose>{start}, iterations, last)[0];
      result.iterations += iterations;
    };
    descend(settings_.coarse_pixel_stride, settings_.coarse_iterations, last);
    descend(settings_.pixel_stride, settings_.iterations, result.fit->world_from_camera);
    result.world_from_camera = result.fit->world_from_camera;
    result.lookups = kVoxelsPerPoint * refiner_.takePointsRead();
    return result;
  }

 private:
  PoseRefiner& refiner_;
  const RefineSettings settings_;
};

class IcpMethod : public PoseMethod {
 public:
  IcpMethod(Device& device, const Settings& settings, const Intrinsics& intrinsics)
      : icp_(device, settings, intrinsics) {}
  TrackResult track(const DeviceFrame& frame, const Volume& volume, const TrackHistory& history, double,
                    const SearchObserver&) override {
    return icp_.align(frame, volume, history.last);
  }

 private:
  Icp icp_;
};

}  // namespace

std::unique_ptr<PoseMethod> makePoseMethod(Device& device, const Settings& settings,
                                           const Intrinsics& intrinsics, SwarmSearch& search,
                                           PoseRefiner& refiner) {
  switch (settings.tracking.method) {
    case TrackingMethod::Default:
      return std::make_unique<Tracker>(settings.refine, search, refiner);
    case TrackingMethod::Pst:
      return std::make_unique<PstMethod>(search);
    case TrackingMethod::Pfo:
    case TrackingMethod::Pso:
      return std::make_unique<FreeSwarmMethod>(device, settings, intrinsics, search.templates());
    case TrackingMethod::GaussNewton:
      return std::make_unique<GaussNewtonMethod>(refiner, settings.refine);
    case TrackingMethod::Icp:
      return std::make_unique<IcpMethod>(device, settings, intrinsics);
  }
  return nullptr;
}

}  // namespace rosefusion
