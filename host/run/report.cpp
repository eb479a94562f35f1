#include "host/run/report.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

#include "host/core/number_text.h"
#include "host/evaluation/report_json.h"

namespace rosefusion {
namespace {

using Json = nlohmann::ordered_json;

/// Value below which `share` of the values lie (nearest rank); null without values.
Json quantile(std::vector<double> values, double share) {
  if (values.empty()) return nullptr;
  std::sort(values.begin(), values.end());
  const auto rank = static_cast<std::size_t>(std::ceil(share * values.size()));
  return values[std::clamp<std::size_t>(rank, 1, values.size()) - 1];
}

Json medianAndP95(const std::vector<double>& values) {
  return {{"median", quantile(values, 0.5)}, {"p95", quantile(values, 0.95)}};
}

template <typename Get>
std::vector<double> collect(const RunSummary& summary, bool searched_only, Get get) {
  std::vector<double> values;
  for (const RunFrame& f : summary.frames)
    if (!f.skipped && (!searched_only || f.result.iterations > 0))
      values.push_back(static_cast<double>(get(f.result)));
  return values;
}

const char* toString(RunEnd end) {
  return end == RunEnd::Finished      ? "finished"
         : end == RunEnd::Interrupted ? "interrupted"
                                      : "device memory full";
}

/// The figures without those that so few common poses cannot tell.
Json errorFigures(const TrajectoryErrors& errors) {
  Json figures = toJson(errors);
  if (errors.common_poses < kFewestCommonPoses)
    for (auto& [name, value] : figures.items())
      if (name.starts_with("ate_") || name.starts_with("rpe_")) value = nullptr;
  return figures;
}

std::string csvQuoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + "\"";
}

}  // namespace

std::optional<TrajectoryErrors> errorsOf(const RunSummary& summary, const SequenceInfo& info) {
  if (info.truth.empty()) return std::nullopt;
  TrajectoryErrorOptions options;
  options.sequence_frames = summary.frames.size();
  options.seconds_per_stamp = info.seconds_per_stamp;
  return measureTrajectory(trajectoryOf(summary), info.truth, options);
}

Json reportJson(const RunSummary& summary, const SequenceInfo& info, Pipeline& pipeline) {
  const auto milliseconds = [&](double StageMilliseconds::*stage, bool searched) {
    return medianAndP95(
        collect(summary, searched, [&](const FrameResult& r) { return r.milliseconds.*stage; }));
  };
  const DeviceInfo& device = pipeline.device().info();
  Json report;
  report["sequence"] = {{"path", info.path.string()}, {"format", info.format}};
  if (info.seconds_per_stamp != 1) report["sequence"]["seconds_per_stamp"] = info.seconds_per_stamp;
  Json& given = report["sequence"]["given"] = Json::object();  // which opens it again
  if (const auto& k = info.opened_with.intrinsics) given["intrinsics"] = {k->fx, k->fy, k->cx, k->cy};
  if (const auto& units = info.opened_with.depth_units_per_metre) given["depth_units_per_metre"] = *units;
  if (!info.opened_with.topic.empty()) given["topic"] = info.opened_with.topic;
  if (given.empty()) report["sequence"].erase("given");
  const Intrinsics& k = info.intrinsics;
  report["camera"] = {{"width", k.width}, {"height", k.height}, {"fx", k.fx},
                      {"fy", k.fy},       {"cx", k.cx},         {"cy", k.cy}};
  report["device"] = {{"name", device.name}, {"driver", device.driver}, {"type", toString(device.type)}};
  report["end"] = toString(summary.end);
  report["frames"] = summary.frames.size();
  if (summary.began_anew_with) report["began_anew_with"] = *summary.began_anew_with;
  report["tracked"] = summary.count(TrackingStatus::Tracked);
  report["uncertain"] = summary.count(TrackingStatus::Uncertain);
  report["relocalised"] = summary.count(TrackingStatus::Relocalised);
  report["lost"] = summary.count(TrackingStatus::Lost);
  report["skipped"] = summary.skipped();
  report["dropped"] = summary.dropped();
  report["maps"] = Json::array();
  for (const MapFrames& map : mapsOf(summary)) {
    Json one = {
        {"map", map.map}, {"frames", map.frames}, {"first_frame", map.first}, {"last_frame", map.last}};
    if (map.map > 1) one["joined_at"] = map.joined_at ? Json(*map.joined_at) : Json(nullptr);
    report["maps"].push_back(one);
  }
  if (const double readout = pipeline.readoutSeconds(); readout != 0) report["readout_seconds"] = readout;
  report["seconds"] = summary.seconds;
  report["milliseconds"] = {{"total", milliseconds(&StageMilliseconds::total, false)},
                            {"preprocess", milliseconds(&StageMilliseconds::preprocess, false)},
                            {"track", milliseconds(&StageMilliseconds::track, true)},
                            {"integrate", milliseconds(&StageMilliseconds::integrate, false)}};
  report["iterations"] =
      medianAndP95(collect(summary, true, [](const FrameResult& r) { return r.iterations; }));
  report["lookups_per_frame"] = {
      {"median", quantile(collect(summary, true, [](const FrameResult& r) { return r.lookups; }), 0.5)}};
  report["memory_bytes"] = {{"volume", pipeline.volume().memoryBytes()},
                            {"device", pipeline.device().allocatedBytes()}};
  report["blocks"] = pipeline.volume().blockCount();
  if (const auto& loops = summary.loops) {
    report["milliseconds"]["loops"] = milliseconds(&StageMilliseconds::loops, false);
    report["loops"] = {
        {"closures", loops->closures},      {"contradictions", loops->contradictions},
        {"checks", loops->checks},          {"agreements", loops->agreements},
        {"keyframes", loops->keyframes},    {"keyframes_with_images", loops->keyframes_with_images},
        {"image_bytes", loops->image_bytes}};
  }
  if (const auto errors = errorsOf(summary, info)) report.update(errorFigures(*errors));
  return report;
}

std::string framesCsv(const RunSummary& summary) {
  TextStream out;
  out << "frame,timestamp_s,status,reason,iterations,lookups,residual_truncations,overlap_share,valid_share,"
         "fit_cost,fit_usable,fit_close,fit_constraint,deviation_m,deviation_rad,intruding_share,fused,map,"
         "tx_m,ty_m,tz_m,"
         "qx,qy,qz,qw,total_ms,preprocess_ms,track_ms,integrate_ms,loops_ms,loop_to_s,loop_shift_m,loop_turn_"
         "rad\n";
  for (const RunFrame& f : summary.frames) {
    const FrameResult& r = f.result;
    const Eigen::Vector3d t = r.world_from_camera.translation();
    const Eigen::Quaterniond q = canonical(Eigen::Quaterniond(r.world_from_camera.linear()));
    out << f.index << ',' << std::fixed << std::setprecision(6) << r.timestamp << ','
        << (f.skipped ? "skipped" : toString(r.status)) << ',' << csvQuoted(f.reason()) << ',' << r.iterations
        << ',' << r.lookups << ',' << r.score.residual << ',' << r.score.overlap << ','
        << r.score.valid_share;
    if (f.fit)
      out << ',' << f.fit->cost << ',' << f.fit->observed_ratio << ',' << f.fit->inlier_ratio << ','
          << f.fit->observability << ',' << f.fit->shift_deviation << ',' << f.fit->turn_deviation;
    else
      out << ",,,,,,";
    out << ',' << r.intruding << ',' << (r.fused ? 1 : 0) << ','
        << (r.detached_map ? *r.detached_map
            : r.number     ? 1
                           : 0);
    out << ',' << t.x() << ',' << t.y() << ',' << t.z() << ',' << q.x() << ',' << q.y() << ',' << q.z() << ','
        << q.w() << std::setprecision(3) << ',' << r.milliseconds.total << ',' << r.milliseconds.preprocess
        << ',' << r.milliseconds.track << ',' << r.milliseconds.integrate << ',' << r.milliseconds.loops
        << ',';
    if (r.loop)
      out << std::setprecision(6) << r.loop->timestamp << ',' << r.loop->shift << ',' << r.loop->turn;
    else
      out << ",,";
    out << '\n';
  }
  return out.str();
}

}  // namespace rosefusion
