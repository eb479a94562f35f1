// What a network stream costs: the frames of a recording sent to this very process, one at a time.
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "host/datasets/sequence.h"

namespace rosefusion {

struct NetworkReport {
  std::string sequence;
  std::size_t frames = 0;
  double frame_bytes = 0;  ///< mean, as they are sent
  double compression = 0;  ///< bytes of the images over bytes sent
  double added_ms = 0;     ///< median over the frames: from handing one to the sender to having it received
  double added_p95_ms = 0;
  double added_cpu_ms = 0;  ///< mean CPU time of both ends together, which other programs hardly change
  double compress_ms = 0;   ///< mean; the sender's part of added_ms
};

/// Streams up to `frames` frames, read beforehand, over loopback. Throws InputError when nothing can be read,
/// or in a program without streams; std::runtime_error when a frame does not arrive as it was.
NetworkReport benchNetwork(Sequence& sequence, std::size_t frames);

nlohmann::ordered_json networkJson(const NetworkReport& report);
/// A table for people.
std::string networkTable(const NetworkReport& report);

}  // namespace rosefusion
