// A program of the build: prints C++ that asserts, for every struct that shaders share with C++, that both
// lay it out alike. assert_layouts NAME.spv...
#include <algorithm>
#include <cstdio>
#include <exception>
#include <fstream>
#include <iterator>
#include <set>
#include <string>
#include <vector>

#include "engine/reflection.h"

namespace {

using namespace rosefusion;

std::vector<std::uint32_t> wordsOf(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  const std::vector<char> bytes((std::istreambuf_iterator<char>(in)), {});
  std::vector<std::uint32_t> words(bytes.size() / 4);
  std::copy_n(bytes.data(), 4 * words.size(), reinterpret_cast<char*>(words.data()));
  return words;
}

void print(const ShaderStruct& s, std::set<std::string>& printed) {
  if (s.bytes == 0 || !printed.insert(s.name).second) return;
  const char* name = s.name.c_str();
  std::printf("static_assert(sizeof(%s) == %u, \"%s has other bytes in C++ than in GLSL (std430)\");\n", name,
              s.bytes, name);
  for (const ShaderMember& member : s.members)
    std::printf(
        "static_assert(offsetof(%s, %s) == %u, \"%s::%s lies elsewhere in C++ than in GLSL (std430)\");\n",
        name, member.name.c_str(), member.offset_bytes, name, member.name.c_str());
}

}  // namespace

int main(int count, char** arguments) try {
  std::set<std::string> printed;
  for (int i = 1; i < count; ++i) {
    const std::vector<std::uint32_t> words = wordsOf(arguments[i]);
    const ShaderInterface shader = reflect({arguments[i], words});
    print(shader.push, printed);
    for (const ShaderStruct& s : shader.structs) print(s, printed);
  }
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "assert_layouts: %s\n", error.what());
  return 1;
}
