#include "host/swarm/template_file.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <string>
#include <string_view>

#include "host/core/error.h"
#include "host/core/file_io.h"
#include "host/core/system.h"

namespace rosefusion {
namespace {

// Layout, all little-endian: magic, u32 version, u64 seed, u32 candidates, u32 count, u32 levels, u32 size of
// each level; then per template f64 radius and its particles as 6 f32 each; then u64 FNV-1a of everything
// before.
constexpr std::string_view kMagic = "ROSEPST\n";
constexpr uint32_t kVersion =
    1;  // raise it when the sampling changes too: caches of older programs are then rebuilt

uint64_t checksum(std::string_view bytes) {
  uint64_t hash = 0xcbf29ce484222325u;
  for (char c : bytes) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
  return hash;
}

template <typename Unsigned>
void put(std::string& out, Unsigned value) {
  for (size_t i = 0; i < sizeof(value); ++i) out.push_back(static_cast<char>(value >> (8 * i) & 0xff));
}

class Reader {
 public:
  Reader(std::string_view bytes, std::string file) : bytes_(bytes), file_(std::move(file)) {}

  template <typename Unsigned>
  Unsigned take() {
    if (bytes_.size() < sizeof(Unsigned)) fail("is truncated");
    Unsigned value = 0;
    for (size_t i = 0; i < sizeof(value); ++i)
      value |= static_cast<Unsigned>(static_cast<Unsigned>(static_cast<unsigned char>(bytes_[i])) << (8 * i));
    bytes_.remove_prefix(sizeof(value));
    return value;
  }

  size_t left() const { return bytes_.size(); }

  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(file_ + ": the swarm template file " + what +
                     "; write a new one with 'rosefusion pst --out FILE'.");
  }

 private:
  std::string_view bytes_;
  std::string file_;
};

SwarmTemplate readTemplate(Reader& reader, int size) {
  SwarmTemplate swarm_template;
  swarm_template.radius = std::bit_cast<double>(reader.take<uint64_t>());
  swarm_template.particles.resize(static_cast<size_t>(size));
  for (Particle& particle : swarm_template.particles)
    for (float& x : particle) {
      x = std::bit_cast<float>(reader.take<uint32_t>());
      if (!(std::abs(x) <= 1)) reader.fail("holds a particle outside the unit ball");
    }
  if (swarm_template.particles[0] != Particle{}) reader.fail("lacks the zero move as particle 0");
  return swarm_template;
}

}  // namespace

void writeTemplates(const std::filesystem::path& file, const TemplateSet& set) {
  std::string bytes(kMagic);
  put(bytes, kVersion);
  put(bytes, set.options.seed);
  put(bytes, static_cast<uint32_t>(set.options.candidates));
  put(bytes, static_cast<uint32_t>(set.options.count));
  put(bytes, static_cast<uint32_t>(set.options.sizes.size()));
  for (int size : set.options.sizes) put(bytes, static_cast<uint32_t>(size));
  for (const auto& level : set.levels)
    for (const SwarmTemplate& swarm_template : level) {
      put(bytes, std::bit_cast<uint64_t>(swarm_template.radius));
      for (const Particle& particle : swarm_template.particles)
        for (float x : particle) put(bytes, std::bit_cast<uint32_t>(x));
    }
  put(bytes, checksum(bytes));
  writeFileAtomically(file, bytes);
}

TemplateSet readTemplates(const std::filesystem::path& file) {
  std::string bytes;
  if (const int code = readBytes(file, bytes))
    throw InputError(file.string() + ": there is no readable swarm template file (" + std::strerror(code) +
                     "); write one with 'rosefusion pst --out FILE'.");
  const std::string_view all(bytes);
  Reader reader(all.substr(std::min(kMagic.size(), all.size())), file.string());
  if (all.substr(0, kMagic.size()) != kMagic) reader.fail("does not start like one");
  if (const auto version = reader.take<uint32_t>(); version != kVersion)
    reader.fail("is of version " + std::to_string(version) + ", this program reads " +
                std::to_string(kVersion));
  constexpr size_t kSumBytes = sizeof(uint64_t);
  if (reader.left() < kSumBytes) reader.fail("is truncated");
  Reader tail(all.substr(all.size() - kSumBytes), file.string());
  // Before any size is believed: after this check only a file made wrong on purpose has wrong sizes.
  if (tail.take<uint64_t>() != checksum(all.substr(0, all.size() - kSumBytes)))
    reader.fail("is truncated or corrupt (its checksum differs)");

  TemplateSet set;
  set.options.seed = reader.take<uint64_t>();
  set.options.candidates = static_cast<int>(reader.take<uint32_t>());
  const auto count = reader.take<uint32_t>();
  const auto level_count = reader.take<uint32_t>();
  set.options.count = static_cast<int>(count);
  set.options.sizes.clear();
  uint64_t expected = kSumBytes;
  for (uint32_t i = 0; i < level_count; ++i) {
    const auto size = reader.take<uint32_t>();
    if (size == 0 || size > reader.left()) reader.fail("has a size that cannot be");
    set.options.sizes.push_back(static_cast<int>(size));
    expected += uint64_t{count} * (sizeof(double) + uint64_t{size} * sizeof(Particle));
  }
  if (count == 0 || level_count == 0 || expected != reader.left())
    reader.fail("has sizes that do not fit its length");
  for (int size : set.options.sizes) {
    auto& level = set.levels.emplace_back();
    for (uint32_t i = 0; i < count; ++i) level.push_back(readTemplate(reader, size));
  }
  return set;
}

}  // namespace rosefusion
