#include "host/sources/key_check.h"

#include <algorithm>

namespace rosefusion::link {

void KeyCheck::listen(zmq::socket_t& receiver) {
  if (!keys_) return;
  receiver.set(zmq::sockopt::curve_server, true);
  receiver.set(zmq::sockopt::curve_secretkey, keys_.secret);
  receiver.set(zmq::sockopt::zap_domain, "rosefusion");
  socket_.bind("inproc://zeromq.zap.01");
}

void KeyCheck::answer(const std::function<void(const std::string&)>& refuse) {
  if (!keys_) return;
  zmq::message_t part;
  while (socket_.recv(part, zmq::recv_flags::dontwait)) {
    std::vector<zmq::message_t> request;
    request.push_back(std::move(part));
    while (request.back().more()) (void)socket_.recv(request.emplace_back(), zmq::recv_flags::none);
    constexpr std::size_t kRequestId = 1, kAddress = 3, kMechanism = 5, kKey = 6;
    const bool whole = request.size() > kKey && request[kMechanism].to_string_view() == "CURVE";
    const std::string key = whole ? z85(bytesOf(request[kKey])) : "";
    const bool allowed = std::count(keys_.peers.begin(), keys_.peers.end(), key) > 0;
    if (!allowed)
      refuse("refused a connection from " + (whole ? request[kAddress].to_string() : "somewhere") +
             ": its key is not among those allowed");
    socket_.send(zmq::str_buffer("1.0"), zmq::send_flags::sndmore);
    request.resize(std::max(request.size(), kRequestId + 1));
    socket_.send(request[kRequestId], zmq::send_flags::sndmore);
    socket_.send(allowed ? zmq::str_buffer("200") : zmq::str_buffer("400"), zmq::send_flags::sndmore);
    socket_.send(zmq::message_t(), zmq::send_flags::sndmore);  // text, user, metadata: nothing
    socket_.send(zmq::message_t(), zmq::send_flags::sndmore);
    socket_.send(zmq::message_t(), zmq::send_flags::none);
  }
}

}  // namespace rosefusion::link
