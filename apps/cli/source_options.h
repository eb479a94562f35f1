// The options by which run and send are told where frames come from.
#pragma once
#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "host/sources/open_source.h"

namespace rosefusion::cli {

struct SourceArguments {
  std::string source;
  std::vector<double> intrinsics;  ///< fx fy cx cy, or empty
  double depth_scale = 0;
  std::string topic;
  bool realtime = false;
  RunOptions selection;
  StreamOptions stream;

  /// Adds the positional SOURCE and the options.
  void addTo(CLI::App& command);
  /// `colour`: whether colour images are wanted.
  SourceOptions options(bool colour) const;
};

struct OpenedSource {
  std::unique_ptr<FrameSource> frames;  ///< null when interrupted while waiting
  std::vector<Finding> findings;        ///< what looks wrong with a recording
};

/// Opens it, with warnings about what was assumed and what looks wrong. `limits`: depths that are used.
OpenedSource openSource(const SourceArguments& arguments, bool colour, const DepthLimits& limits = {});

}  // namespace rosefusion::cli
