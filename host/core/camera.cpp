#include "host/core/camera.h"

#include <cmath>
#include <sstream>

#include "host/core/error.h"
#include "host/core/number_text.h"

namespace rosefusion {

void requirePlausible(const Intrinsics& k, const std::string& source) {
  const auto reject = [&](const std::string& why) {
    TextStream text;
    text << source << ": implausible camera intrinsics (fx " << k.fx << ", fy " << k.fy << ", cx " << k.cx
         << ", cy " << k.cy << ", " << k.width << "x" << k.height << "): " << why;
    throw InputError(text.str());
  };
  if (k.width < 8 || k.height < 8 || k.width > 16384 || k.height > 16384)
    reject("the image must be 8 to 16384 pixels wide and high.");
  if (!std::isfinite(k.fx) || !std::isfinite(k.fy) || !std::isfinite(k.cx) || !std::isfinite(k.cy))
    reject("every value must be a finite number.");
  const double widths_x = k.fx / k.width, widths_y = std::abs(k.fy) / k.width;
  if (widths_x < 0.1 || widths_x > 10 || widths_y < 0.1 || widths_y > 10)
    reject("focal lengths are given in pixels, 0.1 to 10 image widths; check their unit and order.");
  if (k.cx < 0 || k.cx > k.width || k.cy < 0 || k.cy > k.height)
    reject(
        "the principal point (cx, cy) must lie inside the image; are the intrinsics (fx fy cx cy) those of "
        "another "
        "image size, or in another order?");
}

}  // namespace rosefusion
