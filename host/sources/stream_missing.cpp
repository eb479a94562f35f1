// Built in place of the network streams where ZeroMQ or zstd is missing.
#include "host/core/error.h"
#include "host/sources/stream.h"

namespace rosefusion {
namespace {

[[noreturn]] void refuse() {
  throw InputError(
      "This rosefusion was built without network streams; install libzmq3-dev, cppzmq-dev and libzstd-dev "
      "('bash "
      "apps/install_packages.sh --live') and build it again.");
}

}  // namespace

struct StreamSender::Impl {};
struct StreamReceiver::Impl {};

bool isStreamEndpoint(const std::string& text) {
  return text.starts_with("tcp://");
}
bool streamsAvailable() {
  return false;
}
void makeKeys(const std::filesystem::path&) {
  refuse();
}

StreamSender::StreamSender(const std::string&, const SequenceInfo&, const StreamOptions&) {
  refuse();
}
StreamSender::~StreamSender() = default;
bool StreamSender::send(const Frame&, const StopQuestion&) {
  refuse();
}
bool StreamSender::finish(const StopQuestion&) {
  refuse();
}
const StreamSender::Counts& StreamSender::counts() const {
  refuse();
}

StreamReceiver::StreamReceiver(const std::string&, const StreamOptions&) {
  refuse();
}
StreamReceiver::~StreamReceiver() = default;
bool StreamReceiver::waitForStream(const StopQuestion&) {
  refuse();
}
const SequenceInfo& StreamReceiver::info() const {
  refuse();
}
SourceState StreamReceiver::next(SourceFrame&, const StopQuestion&) {
  refuse();
}
const std::string& StreamReceiver::endpoint() const {
  refuse();
}
std::vector<std::string> StreamReceiver::refusals() const {
  refuse();
}

}  // namespace rosefusion
