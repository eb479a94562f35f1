// Frames over ZeroMQ, from the machine with the camera (StreamSender) to the one that reconstructs
// (StreamReceiver). The receiver binds, the sender connects. Recordings arrive whole, through any number of
// broken connections: the sender keeps each frame until its arrival is acknowledged. Of a live camera the
// newest frame matters, and older ones are dropped. Messages: host/sources/wire.h.
#pragma once
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "host/sources/frame_source.h"

namespace rosefusion {

struct StreamOptions {
  /// Curve keys encrypt the stream and let both ends know each other; both files or neither. Made by
  /// makeKeys().
  std::filesystem::path secret_key;  ///< this side's
  std::filesystem::path
      peer_keys;      ///< the other side's public key; for a receiver one a line, all of them allowed
  bool live = false;  ///< sender: frames that cannot be sent in time are dropped
  /// Receiver: a stream that is silent for so many seconds has ended; 0: it is waited for.
  double silence_limit = 0;
};

/// Whether the text means a network stream rather than a file: it begins with "tcp://".
bool isStreamEndpoint(const std::string& text);
/// Whether this program was built with ZeroMQ and zstd. Without them the classes below throw InputError.
bool streamsAvailable();

/// Writes NAME.secret, readable by the user only, and NAME.public. Throws InputError; nothing is replaced.
void makeKeys(const std::filesystem::path& name);

/// One thread at a time.
class StreamSender {
 public:
  struct Counts {
    std::uint64_t frames = 0, dropped = 0, resent = 0;
    std::uint64_t raw_bytes = 0, sent_bytes = 0;   ///< of each frame once, whether it arrived or not
    std::uint64_t arrived = 0, arrived_bytes = 0;  ///< frames that the receiver acknowledged
    double compress_seconds = 0;
  };
  /// Connects in the background, now and whenever the connection breaks. Throws InputError for an endpoint or
  /// keys that cannot be used.
  StreamSender(const std::string& endpoint, const SequenceInfo& info, const StreamOptions& options);
  ~StreamSender();

  /// Compresses and sends. A recording: waits while the receiver has no room; false when stopped. Live: at
  /// once. Throws InputError when the receiver refuses the stream, with its reason.
  bool send(const Frame& frame, const StopQuestion& stop);
  /// Says that there are no more frames and waits until all have arrived. False when stopped: a recording at
  /// once, a live stream once the receiver answers no more.
  bool finish(const StopQuestion& stop);
  const Counts& counts() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Takes one stream; refuses everything else that comes, says why, and goes on. Receiving and decompressing
/// happen on a thread of its own, at most a few frames ahead.
class StreamReceiver : public FrameSource {
 public:
  /// Binds; "tcp://*:5555" listens on all interfaces. Throws InputError when that cannot be done.
  StreamReceiver(const std::string& endpoint, const StreamOptions& options);
  ~StreamReceiver() override;

  /// Waits until a sender is there; info() is complete then. False when stopped.
  bool waitForStream(const StopQuestion& stop);
  const SequenceInfo& info() const override;
  SourceState next(SourceFrame& out, const StopQuestion& stop) override;

  /// What it listens on, with the port that was chosen for "tcp://127.0.0.1:*".
  const std::string& endpoint() const;
  /// What was refused so far, each sentence once.
  std::vector<std::string> refusals() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rosefusion
