#include "host/export/page.h"

#include <zlib.h>

#include <cmath>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "host/export/decimation.h"
#include "host/export/mesh_formats.h"
#include "host/export/page_text.h"
#include "host/export/upright.h"

namespace rosefusion {
namespace {

using Json = nlohmann::ordered_json;

std::string base64(const std::string& bytes) {
  constexpr const char* kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve(bytes.size() / 3 * 4 + 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t three = 0;
    for (std::size_t k = 0; k < 3; ++k)
      three = three << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k)
      out += k <= bytes.size() - i ? kDigits[three >> (18 - 6 * k) & 63] : '=';
  }
  return out;
}

std::string deflated(const std::string& bytes) {
  uLongf size = compressBound(bytes.size());
  std::string out(size, '\0');
  if (compress2(reinterpret_cast<Bytef*>(out.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()),
                bytes.size(), 6) != Z_OK)  // 9 takes ten times as long for 3 %
    throw std::runtime_error("zlib could not compress a page's model");
  out.resize(size);
  return out;
}

/// Positions in 65535 steps of the longest side, colours, and indices as differences, which deflate well.
std::string packed(const TriangleMesh& mesh, Json& head) {
  Eigen::Vector3f low = mesh.vertices[0], high = low;
  for (const Eigen::Vector3f& v : mesh.vertices) low = low.cwiseMin(v), high = high.cwiseMax(v);
  const float step = std::max((high - low).maxCoeff(), 1e-6f) / 65535;
  head = {{"vertices", mesh.vertices.size()},
          {"triangles", mesh.triangles.size()},
          {"low", {low.x(), low.y(), low.z()}},
          {"step", step},
          {"coloured", !mesh.colours.empty()}};
  std::string bytes;
  const auto add = [&](const void* data, std::size_t size) {
    bytes.append(static_cast<const char*>(data), size);
  };
  for (const Eigen::Vector3f& v : mesh.vertices)
    for (int i = 0; i < 3; ++i) {
      const auto steps =
          static_cast<std::uint16_t>(std::clamp(std::lround((v[i] - low[i]) / step), 0l, 65535l));
      add(&steps, 2);
    }
  for (const auto& colour : mesh.colours) add(colour.data(), 3);
  bytes.resize((bytes.size() + 3) / 4 * 4, '\0');
  std::uint32_t before = 0;
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t index : triangle) {
      const std::uint32_t difference = index - before;
      add(&difference, 4);
      before = index;
    }
  return deflated(bytes);
}

double rounded(double value) {
  return std::round(value * 1e5) / 1e5;
}

Json framesOf(const std::vector<PageFrame>& frames, const Eigen::Matrix3d& turned, Json& reasons) {
  std::map<std::string, std::size_t> known;
  Json out = Json::array();
  for (const PageFrame& frame : frames) {
    const auto [reason, is_new] = known.try_emplace(frame.reason, known.size());
    if (is_new) reasons.push_back(frame.reason);
    Json row = {rounded(frame.seconds), frame.status, reason->second};
    if (frame.placed) {
      const Eigen::Vector3d p = turned * frame.world_from_camera.translation();
      const Eigen::Quaterniond q(turned * frame.world_from_camera.linear());
      for (const double value : {p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w()})
        row.push_back(rounded(value));
    }
    out.push_back(row);
  }
  return out;
}

/// Nothing in it ends the script that it stands in.
std::string insideScript(const Json& json) {
  std::string text = json.dump(-1, ' ', true, Json::error_handler_t::replace), out;
  for (const char c : text) out += c == '<' ? std::string("\\u003c") : std::string(1, c);
  return out;
}

std::string insideHtml(const std::string& text) {
  std::string out;
  for (const char c : text)
    out += c == '<' ? std::string("&lt;") : c == '&' ? std::string("&amp;") : std::string(1, c);
  return out;
}

/// The page's text with what belongs at its marks.
std::string filled(const std::map<std::string, std::string>& parts) {
  std::string_view text = pageTemplate();
  std::string out;
  while (true) {
    const std::size_t open = text.find("{{"), close = text.find("}}");
    out += text.substr(0, open);
    if (open == text.npos) return out;
    out += parts.at(std::string(text.substr(open + 2, close - open - 2)));
    text.remove_prefix(close + 2);
  }
}

}  // namespace

std::string pageOf(PageContent content) {
  std::vector<Pose> poses;
  for (const PageFrame& frame : content.frames)
    if (frame.placed) poses.push_back(frame.world_from_camera);
  const Eigen::Vector3d held = meanUp(poses);
  const Eigen::Matrix3d turned = rotationToAxis(floorNormal(content.mesh, held).value_or(held), UpAxis::Y);
  turn(content.mesh, turned);
  if (!hasColours(content.mesh)) content.mesh.colours.clear();  // it is shown in a light instead
  for (Eigen::Vector3f& v : content.mesh.vertices) v += content.mesh.origin.cast<float>();

  Json reasons = Json::array(), numbers = Json::array();
  Json data = {{"frames", framesOf(content.frames, turned, reasons)}};
  for (const PageFrame& frame : content.frames) numbers.push_back(frame.number);
  data["numbers"] = numbers;
  data["reasons"] = reasons;
  data["fov"] = content.field_of_view;
  data["aspect"] = content.aspect;

  // As many as a phone still turns smoothly; fewer would blur the colours, which are those of vertices.
  for (std::size_t most = 300'000;; most /= 2) {
    std::string model;
    if (!content.mesh.triangles.empty()) {
      if (content.mesh.triangles.size() > most) content.mesh = decimated(content.mesh, {1, most});
      if (content.mesh.triangles.empty()) break;
      model = base64(packed(content.mesh, data["model"]));
    }
    std::string page = filled({{"title", insideHtml(content.title)},
                               {"data", insideScript(data)},
                               {"model", model},
                               {"viewer", std::string(pageViewer())}});
    if (page.size() <= kMostPageBytes || model.empty()) return page;
  }
  content.mesh = {};
  return pageOf(std::move(content));
}

}  // namespace rosefusion
