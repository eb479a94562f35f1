#include "host/export/texture/packing.h"

#define STB_RECT_PACK_IMPLEMENTATION
#define STBRP_STATIC
#if __has_include(<stb/stb_rect_pack.h>)
#include <stb/stb_rect_pack.h>
#else
#include <stb_rect_pack.h>
#endif

namespace rosefusion {

bool packingAvailable() {
  return true;
}

bool packed(std::vector<cv::Rect>& rectangles, int width, int height) {
  std::vector<stbrp_rect> rects(rectangles.size());
  for (std::size_t i = 0; i < rects.size(); ++i) {
    if (rectangles[i].width > width || rectangles[i].height > height) return false;
    rects[i].id = static_cast<int>(i);
    rects[i].w = rectangles[i].width;
    rects[i].h = rectangles[i].height;
  }
  std::vector<stbrp_node> nodes(static_cast<std::size_t>(width));
  stbrp_context context;
  stbrp_init_target(&context, width, height, nodes.data(), width);
  if (!stbrp_pack_rects(&context, rects.data(), static_cast<int>(rects.size()))) return false;
  for (const stbrp_rect& r : rects) {
    rectangles[static_cast<std::size_t>(r.id)].x = r.x;
    rectangles[static_cast<std::size_t>(r.id)].y = r.y;
  }
  return true;
}

}  // namespace rosefusion
