// Built in place of the packing where stb is missing.
#include "host/export/texture/packing.h"

namespace rosefusion {

bool packingAvailable() {
  return false;
}

bool packed(std::vector<cv::Rect>&, int, int) {
  return false;
}

}  // namespace rosefusion
