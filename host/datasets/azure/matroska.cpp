// Matroska with libebml's finder of elements and libmatroska's names. The libraries' own readers of whole
// elements are left alone: on damaged files they recurse as deep as the file says and read laces beyond their
// buffers.
#include "host/datasets/azure/matroska.h"

#include <ebml/EbmlContexts.h>
#include <ebml/EbmlHead.h>
#include <ebml/EbmlStream.h>
#include <ebml/EbmlSubHead.h>
#include <ebml/StdIOCallback.h>
#include <matroska/KaxAttached.h>
#include <matroska/KaxAttachments.h>
#include <matroska/KaxBlock.h>
#include <matroska/KaxCluster.h>
#include <matroska/KaxClusterData.h>
#include <matroska/KaxContexts.h>
#include <matroska/KaxInfo.h>
#include <matroska/KaxInfoData.h>
#include <matroska/KaxSegment.h>
#include <matroska/KaxSemantic.h>
#include <matroska/KaxTag.h>
#include <matroska/KaxTags.h>
#include <matroska/KaxTracks.h>

#include <algorithm>
#include <cstddef>
#include <functional>
#include <memory>
#include <stdexcept>

#include "host/core/error.h"

namespace rosefusion::datasets {
namespace {

namespace fs = std::filesystem;
namespace ebml = libebml;
namespace mkv = libmatroska;

constexpr std::uint64_t kMostValueBytes = 16u << 20;  // of an attached file, a text or a codec's own data

constexpr std::uint64_t kNoEnd = std::uint64_t{1} << 62;  // elements may go on beyond a cut file's end

/// An element's data in the file. The end may lie beyond the file's.
struct Span {
  std::uint64_t begin = 0, end = 0;
};

template <typename Element>
bool is(const ebml::EbmlElement& element) {
  return ebml::EbmlId(element) == EBML_ID(Element);
}

/// Reads one file.
class Walk {
 public:
  explicit Walk(const fs::path& file)
      : size_(fs::file_size(file)), io_(file.string().c_str(), MODE_READ), stream_(io_) {}

  MatroskaFile read() {
    bool is_matroska = false;
    children(mkv::KaxMatroska_Context, {0, kNoEnd}, [&](const ebml::EbmlElement& e, Span& data) {
      if (is<ebml::EbmlHead>(e)) is_matroska = is_matroska || documentType(data) == "matroska";
      if (is<mkv::KaxSegment>(e)) data.end = segment(data);
    });
    if (!is_matroska) throw std::runtime_error("its head does not say that it is one");
    for (MatroskaBlock& block : out_.blocks)
      block.nanoseconds = static_cast<std::int64_t>(static_cast<std::uint64_t>(block.nanoseconds) * tick_);
    return std::move(out_);
  }

 private:
  using Visit = std::function<void(const ebml::EbmlElement&, Span&)>;

  /// Visits what an element holds. Where it ends: behind `data`, or at an element of a level above, which is
  /// what ends one of unknown size.
  std::uint64_t children(const ebml::EbmlSemanticContext& context, const Span& data, const Visit& visit) {
    std::uint64_t at = data.begin;
    while (at < std::min(data.end, size_)) {
      io_.setFilePointer(static_cast<std::int64_t>(at));
      int level = 0;
      const std::unique_ptr<ebml::EbmlElement> e(
          stream_.FindNextElement(context, level, data.end - at, false));
      if (!e) break;
      if (level > 0) return e->GetElementPosition();
      Span value{e->GetElementPosition() + e->HeadSize(), data.end};
      if (e->IsFiniteSize()) value.end = value.begin + e->GetSize();
      if (level < 0 && value.end > size_) {  // filling: random bytes look like it
        at = e->GetElementPosition() + 1;
        continue;
      }
      out_.cut = out_.cut || (e->IsFiniteSize() && value.end > size_);
      visit(*e, value);
      at = value.end;
    }
    return data.end;
  }

  std::string documentType(const Span& head) {
    std::string type;
    children(EBML_CLASS_CONTEXT(ebml::EbmlHead), head, [&](const ebml::EbmlElement& e, const Span& value) {
      if (is<ebml::EDocType>(e)) type = text(value);
    });
    return type;
  }

  std::uint64_t segment(const Span& data) {
    return children(EBML_CLASS_CONTEXT(mkv::KaxSegment), data, [&](const ebml::EbmlElement& e, Span& value) {
      if (is<mkv::KaxCluster>(e)) value.end = cluster(value);
      if (is<mkv::KaxInfo>(e))
        children(EBML_CLASS_CONTEXT(mkv::KaxInfo), value,
                 [&](const ebml::EbmlElement& part, const Span& of_part) {
                   if (is<mkv::KaxTimecodeScale>(part)) tick_ = number(of_part);
                 });
      if (is<mkv::KaxTracks>(e))
        children(EBML_CLASS_CONTEXT(mkv::KaxTracks), value,
                 [&](const ebml::EbmlElement& part, const Span& of_part) {
                   if (is<mkv::KaxTrackEntry>(part)) track(of_part);
                 });
      if (is<mkv::KaxAttachments>(e))
        children(EBML_CLASS_CONTEXT(mkv::KaxAttachments), value,
                 [&](const ebml::EbmlElement& part, const Span& of_part) {
                   if (is<mkv::KaxAttached>(part)) attachment(of_part);
                 });
      if (is<mkv::KaxTags>(e))
        children(EBML_CLASS_CONTEXT(mkv::KaxTags), value,
                 [&](const ebml::EbmlElement& part, const Span& of_part) {
                   if (is<mkv::KaxTag>(part)) tag(of_part);
                 });
    });
  }

  void track(const Span& data) {
    MatroskaTrack track;
    children(EBML_CLASS_CONTEXT(mkv::KaxTrackEntry), data,
             [&](const ebml::EbmlElement& e, const Span& value) {
               if (is<mkv::KaxTrackNumber>(e)) track.number = number(value);
               if (is<mkv::KaxTrackUID>(e)) track.uid = number(value);
               if (is<mkv::KaxTrackName>(e)) track.name = text(value);
               if (is<mkv::KaxCodecID>(e)) track.codec = text(value);
               if (is<mkv::KaxCodecPrivate>(e)) track.codec_private = bytes(value);
               if (is<mkv::KaxContentEncodings>(e)) track.encoded = true;
             });
    out_.tracks.push_back(std::move(track));
  }

  void attachment(const Span& data) {
    std::string name;
    std::vector<std::byte> content;
    children(EBML_CLASS_CONTEXT(mkv::KaxAttached), data, [&](const ebml::EbmlElement& e, const Span& value) {
      if (is<mkv::KaxFileName>(e)) name = text(value);
      if (is<mkv::KaxFileData>(e)) content = bytes(value);
    });
    out_.attachments.try_emplace(std::move(name), std::move(content));
  }

  void tag(const Span& data) {
    children(EBML_CLASS_CONTEXT(mkv::KaxTag), data, [&](const ebml::EbmlElement& e, const Span& simple) {
      std::string name, value;
      if (!is<mkv::KaxTagSimple>(e)) return;
      children(EBML_CLASS_CONTEXT(mkv::KaxTagSimple), simple,
               [&](const ebml::EbmlElement& part, const Span& of_part) {
                 if (is<mkv::KaxTagName>(part)) name = text(of_part);
                 if (is<mkv::KaxTagString>(part)) value = text(of_part);
               });
      out_.tags.try_emplace(std::move(name), std::move(value));
    });
  }

  std::uint64_t cluster(const Span& data) {
    std::uint64_t ticks = 0;
    return children(EBML_CLASS_CONTEXT(mkv::KaxCluster), data,
                    [&](const ebml::EbmlElement& e, const Span& value) {
                      if (is<mkv::KaxClusterTimecode>(e)) ticks = number(value);
                      if (is<mkv::KaxSimpleBlock>(e)) block(value, ticks);
                      if (is<mkv::KaxBlockGroup>(e))
                        children(EBML_CLASS_CONTEXT(mkv::KaxBlockGroup), value,
                                 [&](const ebml::EbmlElement& part, const Span& of_part) {
                                   if (is<mkv::KaxBlock>(part)) block(of_part, ticks);
                                 });
                    });
  }

  /// Its head: the track's number in one byte or two, ticks since the cluster's, flags. Nothing where it is
  /// cut or holds several frames, which no image does.
  void block(const Span& data, std::uint64_t cluster_ticks) {
    std::uint8_t head[5] = {};
    if (data.end > size_ || data.end - data.begin < sizeof(head)) return;
    io_.setFilePointer(static_cast<std::int64_t>(data.begin));
    if (io_.read(head, sizeof(head)) != sizeof(head) || head[0] < 0x40) return;
    const bool wide = head[0] < 0x80;
    const std::uint8_t* rest = head + (wide ? 2 : 1);
    const auto after = static_cast<std::int16_t>(rest[0] << 8 | rest[1]);
    constexpr int kLaced = 0x06;
    if (rest[2] & kLaced) return;
    MatroskaBlock block;
    block.track = wide ? (head[0] & 0x3Fu) << 8 | head[1] : head[0] & 0x7Fu;
    block.nanoseconds = static_cast<std::int64_t>(cluster_ticks + static_cast<std::uint64_t>(after));
    block.place = data.begin + (wide ? 5 : 4);
    block.bytes = data.end - block.place;
    out_.blocks.push_back(block);
  }

  std::vector<std::byte> bytes(const Span& value) {
    if (value.end > size_ || value.end - value.begin > kMostValueBytes) return {};
    std::vector<std::byte> out(value.end - value.begin);
    io_.setFilePointer(static_cast<std::int64_t>(value.begin));
    out.resize(io_.read(out.data(), out.size()));
    return out;
  }
  /// Texts may end in zeros.
  std::string text(const Span& value) {
    const auto raw = bytes(value);
    const std::string out(reinterpret_cast<const char*>(raw.data()), raw.size());
    return out.substr(0, out.find('\0'));
  }
  std::uint64_t number(const Span& value) {
    std::uint64_t out = 0;
    if (value.end - value.begin <= sizeof(out))
      for (const std::byte b : bytes(value)) out = out << 8 | std::to_integer<std::uint64_t>(b);
    return out;
  }

  MatroskaFile out_;
  std::uint64_t size_;
  ebml::StdIOCallback io_;
  ebml::EbmlStream stream_;
  std::uint64_t tick_ = 1'000'000;  ///< nanoseconds; this is Matroska's own default
};

}  // namespace

MatroskaFile readMatroska(const fs::path& file) {
  try {
    return Walk(file).read();
  } catch (const std::exception& error) {
    throw InputError(file.string() + ": is no Matroska file (.mkv), or cannot be read (" + error.what() +
                     "); copy it again.");
  }
}

}  // namespace rosefusion::datasets
