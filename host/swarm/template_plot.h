// A picture of a swarm template, to see at a glance whether it covers the ball evenly.
#pragma once
#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <string>

#include "host/swarm/template_sampling.h"

namespace rosefusion {

/// The 15 projections of the ball on two of its axes, as one CV_8UC3 picture; `title` stands above them.
/// Particles within 0.35 of the projection's plane are drawn in full colour, the others behind them in grey.
cv::Mat plotTemplate(const SwarmTemplate& swarm_template, const std::string& title);

/// Writes the picture as PNG; throws InputError when the file cannot be written.
void writeTemplatePlot(const std::filesystem::path& png_file, const SwarmTemplate& swarm_template,
                       const std::string& title);

}  // namespace rosefusion
