// What a run wrote, read again.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "host/export/page.h"
#include "host/run/reconstruction.h"

namespace rosefusion {

struct RunResult {
  std::filesystem::path folder;
  std::filesystem::path recording;  ///< as the run was told; relative paths may lead nowhere now
  SequenceOptions opened_with;      ///< what the run was told of it, without colour
  std::optional<Intrinsics> camera;
  std::vector<PageFrame> frames;
};

/// From report.json and frames.csv. Throws InputError for a folder that holds no result.
RunResult readResult(const std::filesystem::path& folder);

/// A run's frames as its page shows them.
std::vector<PageFrame> pageFramesOf(const RunSummary& summary, double seconds_per_stamp);

/// The page of a result: without a camera (of older runs) one of 50 degrees.
PageContent pageContentOf(const std::string& title, TriangleMesh mesh, std::vector<PageFrame> frames,
                          const std::optional<Intrinsics>& camera);

}  // namespace rosefusion
