// Every parser of bytes from outside, for libFuzzer: $ROSEFUSION_FUZZ names one of kParsers. Bad input may
// end in an InputError and in nothing else. tests/fuzz.sh builds and runs them.
#include <stdlib.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "host/core/error.h"
#include "host/core/trajectory.h"
#include "host/datasets/association.h"
#include "host/datasets/camera_source.h"
#include "host/datasets/image_file.h"
#include "host/datasets/sequence.h"
#include "host/datasets/text_table.h"
#include "host/datasets/truth.h"
#include "host/export/ply_reader.h"
#include "host/settings/settings.h"
#include "host/sources/image_codec.h"
#include "host/sources/stream.h"
#include "host/sources/wire.h"
#include "host/sources/zmq_link.h"
#include "host/swarm/template_file.h"

namespace {

using namespace rosefusion;
using Bytes = std::span<const std::byte>;

/// In memory where the system has such a folder, and gone at the end.
class Scratch {
 public:
  Scratch() {
    std::string pattern =
        (std::filesystem::exists("/dev/shm") ? "/dev/shm" : std::filesystem::temp_directory_path().string()) +
        "/rosefusion-fuzz-XXXXXX";
    if (!mkdtemp(pattern.data())) std::abort();
    path_ = pattern;
  }
  ~Scratch() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  std::filesystem::path write(const std::string& name, Bytes bytes) const {
    std::ofstream(path_ / name, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    return path_ / name;
  }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

Scratch& scratch() {
  static Scratch folder;
  return folder;
}

std::string text(Bytes bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// The first frames of whatever sequence the path is.
void readSequence(const std::filesystem::path& path) {
  SequenceOptions options;
  options.colour = true;
  const auto sequence = openSequence(path, options);
  Frame frame;
  std::string problem;
  for (std::size_t i = 0; i < std::min<std::size_t>(sequence->size(), 2); ++i)
    sequence->read(i, frame, problem);
}

void settings(Bytes bytes) {
  static const Settings preset = loadSettings("default");
  Settings of = preset;
  applyYamlText(of, text(bytes), "settings.yaml");
  requireConsistent(of);
}
void assignment(Bytes bytes) {
  static const Settings preset = loadSettings("paper");
  Settings of = preset;
  applyAssignment(of, text(bytes));
}
void trajectory(Bytes bytes) {
  const auto file = scratch().write("trajectory.txt", bytes);
  std::vector<std::string> skipped;
  bool unsorted = false;
  readTumTrajectory(file, &unsorted, &skipped);
  datasets::readTruth(file, skipped);
  readTumTrajectory(file);
}
void calibration(Bytes bytes) {
  scratch().write("calibration.txt", bytes);
  std::vector<std::string> warnings;
  datasets::readCalibration(scratch().path(), warnings);
}
void list(Bytes bytes) {
  const auto file = scratch().write("depth.txt", bytes);
  std::vector<std::string> warnings;
  try {
    datasets::readStampedFiles(file, warnings);
  } catch (const InputError&) {
  }
  datasets::readAssociations(file, warnings);
}
void sequenceYaml(Bytes bytes) {
  scratch().write("sequence.yaml", bytes);
  static const bool has_images =
      cv::imwrite((scratch().path() / "1.png").string(), cv::Mat(6, 8, CV_16UC1, cv::Scalar(1500)));
  if (!has_images) std::abort();
  readSequence(scratch().path());
}
void png(Bytes bytes) {
  const auto file = scratch().write("image.png", bytes);
  cv::Mat image;
  std::string problem;
  datasets::readDepthImage(file, {}, image, problem);
  datasets::readColourImage(file, {32, 24}, image, problem);
}
void packedSeq(Bytes bytes) {
  readSequence(scratch().write("recording.seq", bytes));
}
void rosBag(Bytes bytes) {
  readSequence(scratch().write("recording.bag", bytes));
}
void rosDatabase(Bytes bytes) {
  readSequence(scratch().write("recording.db3", bytes));
}
void mcap(Bytes bytes) {
  readSequence(scratch().write("recording.mcap", bytes));
}
void mkv(Bytes bytes) {
  readSequence(scratch().write("recording.mkv", bytes));
}
void ply(Bytes bytes) {
  readPly(scratch().write("mesh.ply", bytes));
}
void templates(Bytes bytes) {
  readTemplates(scratch().write("templates.bin", bytes));
}
void wireMessage(Bytes bytes) {
  std::string problem;
  wire::parseAnswer(bytes, 7);
  const auto message = wire::parse(bytes, problem);
  if (!message) return;
  static ImageCodec codec;
  const cv::Size size(static_cast<int>(message->header.width), static_cast<int>(message->header.height));
  if (size.area() > 640 * 480) return;  // checked already; only the time is saved
  cv::Mat depth, colour;
  codec.decompressDepth(message->depth, size, depth);
  codec.decompressColour(message->colour, size, colour);
}
void codec(Bytes bytes) {
  static ImageCodec of;
  cv::Mat image;
  of.decompressDepth(bytes, {32, 24}, image);
  of.decompressColour(bytes, {32, 24}, image);
}
void keys(Bytes bytes) {
  StreamOptions options;
  options.secret_key = scratch().write("key.secret", bytes);
  options.peer_keys = options.secret_key;
  rosefusion::link::readKeys(options);
}

constexpr struct {
  std::string_view name;
  void (*parse)(Bytes);
} kParsers[] = {{"settings", settings},
                {"assignment", assignment},
                {"trajectory", trajectory},
                {"calibration", calibration},
                {"list", list},
                {"sequence_yaml", sequenceYaml},
                {"png", png},
                {"seq", packedSeq},
                {"bag", rosBag},
                {"db3", rosDatabase},
                {"mcap", mcap},
                {"mkv", mkv},
                {"ply", ply},
                {"templates", templates},
                {"wire", wireMessage},
                {"codec", codec},
                {"keys", keys}};

void (*chosen)(Bytes) = nullptr;

}  // namespace

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  const char* name = std::getenv("ROSEFUSION_FUZZ");
  for (const auto& parser : kParsers)
    if (name && parser.name == name) chosen = parser.parse;
  if (chosen) return 0;
  std::fprintf(stderr, "fuzz_parsers: set ROSEFUSION_FUZZ to one of:");
  for (const auto& parser : kParsers) std::fprintf(stderr, " %s", std::string(parser.name).c_str());
  std::fprintf(stderr, "\n");
  std::exit(2);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    chosen({reinterpret_cast<const std::byte*>(data), size});
  } catch (const InputError&) {
  }
  return 0;
}
