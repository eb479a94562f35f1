#include "engine/pool_bindings.h"

#include <map>
#include <optional>
#include <string>

namespace rosefusion {
namespace {

// SPIR-V's numbers, version 1.3.
enum Instruction : std::uint32_t { kName = 5, kTypePointer = 32, kVariable = 59, kDecorate = 71 };
constexpr std::uint32_t kBinding = 33;
constexpr std::size_t kHeaderWords = 5;

struct Chunk {
  std::string pool;
  char number;
};

std::optional<Chunk> chunkOf(const std::string& name) {
  constexpr std::string_view kEnd = "_block";
  if (!name.ends_with(kEnd) || name.size() < kEnd.size() + 2) return {};
  const std::size_t digit = name.size() - kEnd.size() - 1;
  if (name[digit] < '0' || name[digit] > '3' || name[digit - 1] != '_') return {};
  return Chunk{name.substr(0, digit), name[digit]};
}

/// Literal strings are null-terminated words, the first character in the lowest byte.
std::string textOf(std::span<const std::uint32_t> words) {
  std::string text;
  for (const std::uint32_t word : words)
    for (int shift = 0; shift < 32; shift += 8) {
      const char c = static_cast<char>(word >> shift & 0xFF);
      if (c == '\0') return text;
      text += c;
    }
  return text;
}

/// action(operation, all words of the instruction)
template <typename Words, typename Action>
void forEachInstruction(Words&& words, const Action& action) {
  for (std::size_t i = kHeaderWords; i < words.size();) {
    const std::size_t length = words[i] >> 16;
    if (length == 0 || i + length > words.size()) return;  // the driver and SPIRV-Cross will say so
    action(words[i] & 0xFFFF, std::span(words).subspan(i, length));
    i += length;
  }
}

}  // namespace

OnePoolModule withOnePool(const ShaderCode& code) {
  std::map<std::uint32_t, Chunk> blocks, pointers, variables;  // by id
  std::map<std::uint32_t, std::uint32_t> ids;                  // by binding
  std::map<std::string, std::uint32_t> firsts;                 // bindings of pools' first chunks
  forEachInstruction(code.words, [&](std::uint32_t operation, std::span<const std::uint32_t> words) {
    if (operation == kName) {
      if (const auto chunk = chunkOf(textOf(words.subspan(2)))) blocks.emplace(words[1], *chunk);
    } else if (operation == kDecorate && words[2] == kBinding) {
      ids[words[3]] = words[1];
    } else if (operation == kTypePointer) {
      if (const auto block = blocks.find(words[3]); block != blocks.end())
        pointers.emplace(words[1], block->second);
    } else if (operation == kVariable) {
      if (const auto pointer = pointers.find(words[1]); pointer != pointers.end())
        variables.emplace(words[2], pointer->second);
    }
  });
  OnePoolModule out{{code.words.begin(), code.words.end()}, {}};
  std::map<std::uint32_t, std::uint32_t> renumbered;
  for (const auto& [binding, id] : ids) {
    const auto chunk = variables.find(id);
    if (chunk != variables.end() && chunk->second.number != '0') {
      renumbered[binding] = firsts.at(chunk->second.pool);
      continue;
    }
    renumbered[binding] = static_cast<std::uint32_t>(out.kept.size());
    if (chunk != variables.end()) firsts[chunk->second.pool] = renumbered[binding];
    out.kept.push_back(binding);
  }
  forEachInstruction(out.words, [&](std::uint32_t operation, std::span<std::uint32_t> words) {
    if (operation == kDecorate && words[2] == kBinding) words[3] = renumbered[words[3]];
  });
  return out;
}

}  // namespace rosefusion
