// FastCaMo's packed .seq file: a 12-byte header, then all frames back to back, uncompressed.
#include <array>
#include <cstdint>
#include <fstream>

#include "host/core/error.h"
#include "host/datasets/listing.h"
#include "host/datasets/truth.h"

namespace rosefusion::datasets {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kHeaderBytes = 3 * sizeof(std::int32_t);

class PackedSequence : public Sequence {
 public:
  PackedSequence(const fs::path& file, const SequenceOptions& options)
      : in_(file, std::ios::binary), load_colour_(options.colour) {
    info_.format = "FastCaMo packed .seq";
    info_.path = file;
    info_.has_colour = true;
    std::array<std::int32_t, 3> header{};  // little-endian, as every device this runs on
    if (!in_ || !in_.read(reinterpret_cast<char*>(header.data()), kHeaderBytes))
      throw InputError(file.string() +
                       ": cannot be read or is shorter than its 12-byte header; copy it again.");
    const auto [frames, height, width] = header;
    if (frames <= 0 || height < 8 || width < 8 || height > 16384 || width > 16384)
      throw InputError(file.string() + ": the header says " + std::to_string(frames) + " frames of " +
                       std::to_string(width) + "x" + std::to_string(height) +
                       " pixels, so this is no FastCaMo .seq file.");
    pixels_ = static_cast<std::uint64_t>(height) * static_cast<std::uint64_t>(width);
    const std::uint64_t expected = kHeaderBytes + static_cast<std::uint64_t>(frames) * frameBytes();
    const std::uint64_t actual = fs::file_size(file);
    if (actual != expected)
      throw InputError(file.string() + ": is " + std::to_string(actual) + " bytes long where its header (" +
                       std::to_string(frames) + " frames of " + std::to_string(width) + "x" +
                       std::to_string(height) + ") needs " + std::to_string(expected) +
                       "; copy or download it again.");
    info_.frames = static_cast<std::size_t>(frames);
    info_.notes.push_back("the file has no time stamps; 30 frames per second assumed");
    const fs::path beside = file.parent_path();
    const fs::path named = beside / (file.stem().string() + ".txt");
    info_.truth = readTruth(fs::exists(named) ? named : beside / "groundtruth.txt", info_.warnings);
    chooseCamera({{640, 480, 320.0, 320.0, 319.5, 239.5}, "the FastCaMo convention", true}, 1000, true,
                 options, width, height, info_);
  }

  double timestamp(std::size_t index) const override { return static_cast<double>(index) / kFramesPerSecond; }

  bool read(std::size_t index, Frame& frame, std::string& problem) override {
    problem.clear();
    frame = {};
    frame.timestamp = timestamp(index);
    in_.clear();
    in_.seekg(static_cast<std::streamoff>(kHeaderBytes + index * frameBytes()));
    frame.depth.create(info_.intrinsics.height, info_.intrinsics.width, CV_16UC1);
    in_.read(reinterpret_cast<char*>(frame.depth.data), static_cast<std::streamsize>(2 * pixels_));
    if (in_ && load_colour_) {
      frame.colour.create(frame.depth.size(), CV_8UC3);
      in_.read(reinterpret_cast<char*>(frame.colour.data), static_cast<std::streamsize>(3 * pixels_));
    }
    if (in_) return true;
    frame = {};
    problem = info_.path.string() + ": frame " + std::to_string(index) + " cannot be read; check the disk.";
    return false;
  }

 private:
  std::uint64_t frameBytes() const { return 5 * pixels_; }

  std::ifstream in_;
  bool load_colour_;
  std::uint64_t pixels_ = 0;
};

}  // namespace

std::unique_ptr<Sequence> openPackedSeq(const fs::path& file, const SequenceOptions& options) {
  return std::make_unique<PackedSequence>(file, options);
}

}  // namespace rosefusion::datasets
