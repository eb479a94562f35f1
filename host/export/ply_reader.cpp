#include "host/export/ply_reader.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <sstream>
#include <string>

#include "host/core/error.h"
#include "host/core/file_io.h"
#include "host/core/number_text.h"

namespace rosefusion {
namespace {

enum class Type { Int8, Uint8, Int16, Uint16, Int32, Uint32, Float, Double, Unknown };

struct Property {
  std::string name;
  Type type = Type::Unknown;
  Type count_type = Type::Unknown;  // of a list; Unknown: a single value
};

struct Element {
  std::string name;
  std::size_t count = 0;
  std::vector<Property> properties;
};

Type typeNamed(const std::string& name) {
  const char* names[][2] = {{"char", "int8"},     {"uchar", "uint8"},   {"short", "int16"},
                            {"ushort", "uint16"}, {"int", "int32"},     {"uint", "uint32"},
                            {"float", "float32"}, {"double", "float64"}};
  for (int i = 0; i < 8; ++i)
    if (name == names[i][0] || name == names[i][1]) return static_cast<Type>(i);
  return Type::Unknown;
}

class PlyReader {
 public:
  explicit PlyReader(const std::filesystem::path& file) : name_(file.string()) { bytes_ = readFile(file); }

  TriangleMesh read() {
    readHeader();
    for (const Element& element : elements_) {
      if (element.name == "vertex")
        readVertices(element);
      else if (element.name == "face")
        readFaces(element);
      else
        for (std::size_t i = 0; i < element.count; ++i)
          for (const Property& p : element.properties) readProperty(p);
    }
    placeVertices();
    return std::move(mesh_);
  }

 private:
  /// The vertices as floats, after an origin in their middle was taken off where they lie far from their own.
  void placeVertices() {
    if (exact_.empty()) return;
    Eigen::Vector3d low = exact_[0], high = exact_[0];
    for (const Eigen::Vector3d& v : exact_) low = low.cwiseMin(v), high = high.cwiseMax(v);
    if (low.allFinite() && high.allFinite()) {
      const double diagonal = (high - low).norm(),
                   largest = std::max(low.cwiseAbs().maxCoeff(), high.cwiseAbs().maxCoeff());
      if (rounded_) requireFineFloats(name_, largest, diagonal);
      constexpr double kFine = 1e-5;  // metres; floats that are closer do no harm
      if (spacingOfFloats(largest) > kFine && largest > 4 * diagonal)
        mesh_.origin = ((low + high) / 2).array().round();
    }
    for (const Eigen::Vector3d& v : exact_) mesh_.vertices.emplace_back((v - mesh_.origin).cast<float>());
  }

  [[noreturn]] void damaged(const std::string& why) const {
    throw InputError(name_ + ": the PLY file is damaged (" + why + "); export or download it again.");
  }

  std::string headerLine() {
    const std::size_t end = bytes_.find('\n', at_);
    if (end == std::string::npos) damaged("its header does not end");
    std::string line = bytes_.substr(at_, end - at_);
    at_ = end + 1;
    if (!line.empty() && line.back() == '\r') line.pop_back();
    return line;
  }

  void readHeader() {
    if (headerLine() != "ply") damaged("it does not start with 'ply'");
    for (std::string line = headerLine(); line != "end_header"; line = headerLine()) {
      std::istringstream words(line);
      words.imbue(std::locale::classic());
      std::string word, second;
      words >> word >> second;
      if (word == "format") {
        if (second != "ascii" && second != "binary_little_endian" && second != "binary_big_endian")
          damaged("its format is unknown");
        text_ = second == "ascii";
        swap_ = second ==
                (std::endian::native == std::endian::little ? "binary_big_endian" : "binary_little_endian");
      } else if (word == "element") {
        elements_.push_back({second, 0, {}});
        // Each entry takes at least a byte, so that a larger count is damage, not a reason to reserve memory.
        if (!(words >> elements_.back().count) || elements_.back().count > bytes_.size())
          damaged("it names more entries than it can hold");
      } else if (word == "property" && !elements_.empty()) {
        Property p;
        if (second == "list") {
          std::string count_type;
          words >> count_type >> second;
          p.count_type = typeNamed(count_type);
          if (p.count_type == Type::Unknown) damaged("a property has an unknown type");
        }
        p.type = typeNamed(second);
        words >> p.name;
        if (p.type == Type::Unknown) damaged("a property has an unknown type");
        elements_.back().properties.push_back(p);
      }
    }
  }

  template <typename Value>
  double binaryValue() {
    char raw[sizeof(Value)];
    if (bytes_.size() - at_ < sizeof(Value)) damaged("it ends too early");
    std::memcpy(raw, bytes_.data() + at_, sizeof(Value));
    at_ += sizeof(Value);
    if (swap_) std::reverse(raw, raw + sizeof(Value));
    Value value;
    std::memcpy(&value, raw, sizeof(Value));
    return static_cast<double>(value);
  }

  double readValue(Type type) {
    if (text_) {
      std::string_view rest = std::string_view(bytes_).substr(at_);
      rest.remove_prefix(std::min(rest.find_first_not_of(" \t\r\n\f\v"), rest.size()));
      const std::optional<double> value = takeNumber(rest);
      if (!value) damaged("it ends too early or holds something that is no number");
      at_ = bytes_.size() - rest.size();
      return *value;
    }
    switch (type) {
      case Type::Int8:
        return binaryValue<std::int8_t>();
      case Type::Uint8:
        return binaryValue<std::uint8_t>();
      case Type::Int16:
        return binaryValue<std::int16_t>();
      case Type::Uint16:
        return binaryValue<std::uint16_t>();
      case Type::Int32:
        return binaryValue<std::int32_t>();
      case Type::Uint32:
        return binaryValue<std::uint32_t>();
      case Type::Float:
        return binaryValue<float>();
      default:
        return binaryValue<double>();
    }
  }

  /// A single value, or a list into list_.
  double readProperty(const Property& p) {
    if (p.count_type == Type::Unknown) return readValue(p.type);
    const double count = readValue(p.count_type);
    if (!(count >= 0) || count > static_cast<double>(bytes_.size()))
      damaged("a list has an impossible length");
    list_.clear();
    for (int i = 0; i < static_cast<int>(count); ++i) list_.push_back(readValue(p.type));
    return 0;
  }

  void readVertices(const Element& element) {
    const char* names[] = {"x", "y", "z", "nx", "ny", "nz", "red", "green", "blue"};
    std::vector<int> slot;
    int found[9] = {};
    double colour_scale = 1;
    for (const Property& p : element.properties) {
      const auto name = std::find(names, names + 9, p.name);
      slot.push_back(name == names + 9 ? 9 : static_cast<int>(name - names));
      if (slot.back() < 9) ++found[slot.back()];
      if (slot.back() < 3 && p.type == Type::Float && !text_) rounded_ = true;
      if (p.name == "red" && (p.type == Type::Float || p.type == Type::Double)) colour_scale = 255;
    }
    if (!found[0] || !found[1] || !found[2]) damaged("its vertices have no x, y and z");
    for (std::size_t i = 0; i < element.count; ++i) {
      double v[10];
      for (std::size_t p = 0; p < slot.size(); ++p) v[slot[p]] = readProperty(element.properties[p]);
      exact_.emplace_back(v[0], v[1], v[2]);
      if (found[3] && found[4] && found[5])
        mesh_.normals.emplace_back(Eigen::Vector3d(v[3], v[4], v[5]).cast<float>());
      if (!found[6] || !found[7] || !found[8]) continue;
      mesh_.colours.push_back({});
      for (int c = 0; c < 3; ++c)
        mesh_.colours.back()[c] = static_cast<std::uint8_t>(std::clamp(v[6 + c] * colour_scale, 0.0, 255.0));
    }
  }

  void readFaces(const Element& element) {
    const auto count = static_cast<double>(exact_.size());
    for (std::size_t i = 0; i < element.count; ++i)
      for (const Property& p : element.properties) {
        readProperty(p);
        if (p.name != "vertex_indices" && p.name != "vertex_index") continue;
        if (!std::all_of(list_.begin(), list_.end(),
                         [&](double index) { return index >= 0 && index < count; }))
          damaged("a face names a vertex that is not there");
        for (std::size_t k = 2; k < list_.size(); ++k)
          mesh_.triangles.push_back({static_cast<std::uint32_t>(list_[0]),
                                     static_cast<std::uint32_t>(list_[k - 1]),
                                     static_cast<std::uint32_t>(list_[k])});
      }
  }

  std::string name_, bytes_;
  std::size_t at_ = 0;
  bool text_ = true, swap_ = false;
  std::vector<Element> elements_;
  std::vector<double> list_;
  std::vector<Eigen::Vector3d> exact_;  // the vertices
  bool rounded_ = false;                // they are floats in the file
  TriangleMesh mesh_;
};

}  // namespace

double spacingOfFloats(double value) {
  return value * 0x1p-23;
}

void requireFineFloats(const std::string& name, double largest, double diagonal) {
  constexpr double kCoarse = 1e-3, kCoarseShare = 1e-5;  // metres, and of the mesh
  const double spacing = spacingOfFloats(largest);
  if (spacing > kCoarse && spacing > kCoarseShare * diagonal)
    throw InputError(
        printed("%s: its coordinates reach %.0f m and were rounded to 32-bit numbers, which lie %.2g m "
                "apart there; export it as PLY with double coordinates, or in local ones.",
                name.c_str(), largest, spacing));
}

TriangleMesh readPly(const std::filesystem::path& file) {
  return PlyReader(file).read();
}

}  // namespace rosefusion
