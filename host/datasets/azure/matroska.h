// What a Matroska file holds: tracks, where their blocks lie, attached files and tags. No block is read.
#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace rosefusion::datasets {

struct MatroskaTrack {
  std::uint64_t number = 0, uid = 0;
  std::string name;   ///< such as DEPTH
  std::string codec;  ///< such as V_MS/VFW/FOURCC
  std::vector<std::byte> codec_private;
  bool encoded = false;  ///< its blocks are compressed or encrypted once more
};

struct MatroskaBlock {
  std::uint64_t track = 0;
  std::int64_t nanoseconds = 0;
  std::uint64_t place = 0, bytes = 0;  ///< of its data in the file
};

struct MatroskaFile {
  std::vector<MatroskaTrack> tracks;
  std::vector<MatroskaBlock> blocks;                          ///< in the file's order
  std::map<std::string, std::vector<std::byte>> attachments;  ///< by file name
  std::map<std::string, std::string> tags;  ///< simple ones with a text; the first of a name
  bool cut = false;                         ///< an element would go on beyond the file's end
};

/// Walks over the whole file and reads the heads of its elements. A cut or damaged file gives what is whole.
/// Throws InputError where it is no Matroska file, cannot be read, or where the program was built without the
/// library.
MatroskaFile readMatroska(const std::filesystem::path& file);

}  // namespace rosefusion::datasets
