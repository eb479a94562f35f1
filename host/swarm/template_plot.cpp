#include "host/swarm/template_plot.h"

#include <array>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <vector>

#include "host/core/file_io.h"
#include "host/core/number_text.h"

namespace rosefusion {
namespace {

constexpr std::array<const char*, 6> kAxisNames = {"x [m]", "y [m]", "z [m]", "qx", "qy", "qz"};
constexpr double kSliceHalfWidth = 0.35;

const cv::Scalar kPaper(255, 255, 255), kInk(40, 40, 40), kFrame(200, 200, 200), kFar(222, 214, 206),
    kNear(150, 70, 20), kRed(40, 40, 200);

constexpr int kPanel = 300;  // pixels of a plotted square
constexpr int kLeft = 64, kRight = 16, kTop = 14, kBottom = 56, kTitle = 84;
constexpr int kColumns = 5, kRows = 3;
constexpr int kFraction = 4;  // bits below the pixel in OpenCV's drawing coordinates

void putText(cv::Mat& image, const std::string& text, cv::Point at, double size,
             const cv::Scalar& colour = kInk, int thickness = 1) {
  cv::putText(image, text, at, cv::FONT_HERSHEY_SIMPLEX, size, colour, thickness, cv::LINE_AA);
}

void putTextCentred(cv::Mat& image, const std::string& text, cv::Point centre, double size) {
  int baseline = 0;
  const cv::Size extent = cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, size, 1, &baseline);
  putText(image, text, {centre.x - extent.width / 2, centre.y + extent.height / 2}, size);
}

void putTextUpwards(cv::Mat& image, const std::string& text, cv::Point centre, double size) {
  cv::Mat label(24, 100, CV_8UC3, kPaper), turned;
  putTextCentred(label, text, {50, 12}, size);
  cv::rotate(label, turned, cv::ROTATE_90_COUNTERCLOCKWISE);
  turned.copyTo(image(cv::Rect(centre.x - 12, centre.y - 50, 24, 100)));
}

// One projection; `origin` is the plotted square's top left corner.
class Panel {
 public:
  Panel(cv::Mat& image, cv::Point origin, size_t horizontal, size_t vertical)
      : image_(image), origin_(origin), horizontal_(horizontal), vertical_(vertical) {}

  void drawFrame() {
    cv::rectangle(image_, cv::Rect(origin_, cv::Size(kPanel, kPanel)), kFrame, 1);
    for (const double tick : {-1.0, -0.5, 0.0, 0.5, 1.0}) {
      const int x = position(tick, -1.1).x >> kFraction, y = position(-1.1, tick).y >> kFraction;
      cv::line(image_, {x, origin_.y + kPanel}, {x, origin_.y + kPanel + 5}, kInk, 1);
      cv::line(image_, {origin_.x - 5, y}, {origin_.x, y}, kInk, 1);
      const std::string text = tick == 0 ? "0" : printed("%.1f", tick);
      putTextCentred(image_, text, {x, origin_.y + kPanel + 15}, 0.36);
      putTextCentred(image_, text, {origin_.x - 20, y}, 0.36);
    }
    putTextCentred(image_, kAxisNames[horizontal_], {origin_.x + kPanel / 2, origin_.y + kPanel + 35}, 0.48);
    putTextUpwards(image_, kAxisNames[vertical_], {origin_.x - 47, origin_.y + kPanel / 2}, 0.48);
    cv::circle(image_, position(0, 0), static_cast<int>(scale() * (1 << kFraction)), kFrame, 1, cv::LINE_AA,
               kFraction);
  }

  void drawParticles(const std::vector<Particle>& particles, bool near) {
    for (const Particle& particle : particles)
      if (isNear(particle) == near)
        cv::circle(image_, position(particle[horizontal_], particle[vertical_]),
                   static_cast<int>((near ? 2.0 : 1.2) * (1 << kFraction)), near ? kNear : kFar, cv::FILLED,
                   cv::LINE_AA, kFraction);
  }

  void drawZeroMove() { cv::circle(image_, position(0, 0), 5 << kFraction, kRed, 2, cv::LINE_AA, kFraction); }

 private:
  static constexpr double scale() { return kPanel / 2.2; }

  cv::Point position(double x, double y) const {
    constexpr double kOne = 1 << kFraction;
    return {static_cast<int>(std::lround((origin_.x + kPanel / 2.0 + x * scale()) * kOne)),
            static_cast<int>(std::lround((origin_.y + kPanel / 2.0 - y * scale()) * kOne))};
  }

  bool isNear(const Particle& particle) const {
    double squared = 0;
    for (size_t d = 0; d < particle.size(); ++d)
      if (d != horizontal_ && d != vertical_) squared += particle[d] * particle[d];
    return squared < kSliceHalfWidth * kSliceHalfWidth;
  }

  cv::Mat& image_;
  cv::Point origin_;
  size_t horizontal_, vertical_;
};

}  // namespace

cv::Mat plotTemplate(const SwarmTemplate& swarm_template, const std::string& title) {
  constexpr int kWidth = kLeft + kPanel + kRight, kHeight = kTop + kPanel + kBottom;
  cv::Mat image(kTitle + kRows * kHeight, kColumns * kWidth, CV_8UC3, kPaper);
  putText(image, title, {kLeft, 36}, 0.85, kInk, 2);
  putText(image,
          printed("Unit ball of candidate moves, projected on pairs of axes. Blue: within %.2f of the "
                  "plane; grey: the "
                  "others; red ring: particle 0, the zero move.",
                  kSliceHalfWidth),
          {kLeft, 66}, 0.5);
  int panel_index = 0;
  for (size_t vertical = 1; vertical < kAxisNames.size(); ++vertical)
    for (size_t horizontal = 0; horizontal < vertical; ++horizontal, ++panel_index) {
      const cv::Point origin(panel_index % kColumns * kWidth + kLeft,
                             kTitle + panel_index / kColumns * kHeight + kTop);
      Panel panel(image, origin, horizontal, vertical);
      panel.drawFrame();
      panel.drawParticles(swarm_template.particles, false);
      panel.drawParticles(swarm_template.particles, true);
      panel.drawZeroMove();
    }
  return image;
}

void writeTemplatePlot(const std::filesystem::path& png_file, const SwarmTemplate& swarm_template,
                       const std::string& title) {
  std::vector<unsigned char> png;
  if (!cv::imencode(".png", plotTemplate(swarm_template, title), png))
    throw std::runtime_error("the plot of a swarm template cannot be encoded");
  writeFileAtomically(png_file, {reinterpret_cast<const char*>(png.data()), png.size()});
}

}  // namespace rosefusion
