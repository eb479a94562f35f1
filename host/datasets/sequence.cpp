#include "host/datasets/sequence.h"

#include <algorithm>
#include <array>

#include "host/core/error.h"
#include "host/core/number_text.h"
#include "host/datasets/file_bytes.h"
#include "host/datasets/image_sequence.h"
#include "host/datasets/text_table.h"

namespace rosefusion {
namespace {

namespace fs = std::filesystem;
using namespace datasets;

/// The first that matches reads the folder, so the more special layouts come first; TUM takes any association
/// file.
const std::array<const Reader*, 10> kReaders{
    &kPngFolderReader,   &kEth3dReader,   &kIclNuimReader, &kFastCaMoReader, &kTumReader,
    &kSevenScenesReader, &kReplicaReader, &kStrayReader,   &kScanNetReader,  &kOpen3dReader};

const Reader* findReader(const fs::path& folder) {
  const auto found = std::find_if(kReaders.begin(), kReaders.end(),
                                  [&](const Reader* reader) { return reader->matches(folder); });
  return found == kReaders.end() ? nullptr : *found;
}

using OpenRecording = std::unique_ptr<Sequence> (*)(const fs::path&, const SequenceOptions&);

/// As Matroska files begin, whatever their name.
bool isEbml(const fs::path& file) {
  constexpr std::byte kMagic[] = {std::byte{0x1A}, std::byte{0x45}, std::byte{0xDF}, std::byte{0xA3}};
  return FileBytes(file).beginsWith(kMagic);
}

/// What reads a file of this kind; null: nothing does.
OpenRecording openerOf(const fs::path& file) {
  const std::string ending = lowered(file.extension().string());
  if (ending == ".seq") return openPackedSeq;
  if (ending == ".sens") return openSens;
  if (ending == ".klg") return openKlg;
  if (ending == ".r3d") return openRecord3d;
  if (ending == ".mkv" || isEbml(file)) return openAzureRecording;
  if (ending == ".bag" || ending == ".db3" || ending == ".mcap") return openRosRecording;
  return nullptr;
}

constexpr const char* kRecordings =
    "a recording in one file (.bag, .db3, .mcap, .mkv, .sens, .klg, .r3d, FastCaMo's .seq)";

std::vector<fs::path> recordingsIn(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.is_regular_file() && openerOf(entry.path()) && !isHidden(entry.path()))
      files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

/// Data sets are often unpacked one folder deeper than expected: a subfolder that would open, or empty.
fs::path usableSubfolder(const fs::path& folder) {
  std::vector<fs::path> found;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.is_directory() && !isHidden(entry.path()) && findReader(entry.path()))
      found.push_back(entry.path());
  return found.empty() ? fs::path() : *std::min_element(found.begin(), found.end());
}

[[noreturn]] void refuseUnknown(const fs::path& folder) {
  if (const fs::path inner = usableSubfolder(folder); !inner.empty())
    throw InputError(folder.string() + ": holds no sequence itself; give a folder in it, such as " +
                     inner.string() + ".");
  std::string looked_for = kRecordings;
  for (const Reader* reader : kReaders) looked_for += std::string(", ") + reader->looks_for;
  throw InputError(folder.string() + ": no known sequence layout; looked for " + looked_for +
                   "; write a sequence.yaml beside the images to use other layouts.");
}

}  // namespace

std::unique_ptr<Sequence> openSequence(const fs::path& path, const SequenceOptions& options) {
  try {
    if (!fs::exists(path)) throw InputError(path.string() + ": no such file or folder; check the path.");
    if (!fs::is_directory(path)) {
      if (const OpenRecording open = openerOf(path)) return open(path, options);
      throw InputError(path.string() + ": is a file of an unknown kind; give the sequence's folder, or " +
                       kRecordings + ".");
    }
    if (fs::is_empty(path))
      throw InputError(path.string() + ": the folder is empty; check that the data was unpacked here.");
    if (const Reader* reader = findReader(path))
      return std::make_unique<ImageSequence>(reader->list(path), options);
    const std::vector<fs::path> recordings = recordingsIn(path);
    if (recordings.size() > 1)
      throw InputError(path.string() + ": holds " + std::to_string(recordings.size()) +
                       " recordings; give one of them, such as " + recordings[0].string() + ".");
    if (recordings.size() == 1) return openerOf(recordings[0])(recordings[0], options);
  } catch (const fs::filesystem_error& error) {
    throw InputError(path.string() + ": cannot be read (" + error.code().message() +
                     "); check the permissions.");
  }
  refuseUnknown(path);
}

}  // namespace rosefusion
