// The files of host/export/page, embedded when the library is built.
#pragma once
#include <string_view>

namespace rosefusion {

std::string_view pageTemplate();
std::string_view pageViewer();

}  // namespace rosefusion
