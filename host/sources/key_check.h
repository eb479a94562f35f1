// Who may connect to a receiver that has keys: ZeroMQ asks through a socket of its own [RFC 27]. Included by
// the receiver only.
#pragma once
#include "host/sources/zmq_link.h"

namespace rosefusion::link {

/// Without keys ZeroMQ asks nothing, and everybody may connect. One thread once listen() has returned.
class KeyCheck {
 public:
  /// Both must outlive it.
  KeyCheck(zmq::context_t& context, const Keys& keys)
      : keys_(keys), socket_(context, zmq::socket_type::rep) {}

  /// Asks `receiver`, before it is bound, to want keys. Throws zmq::error_t.
  void listen(zmq::socket_t& receiver);
  /// Can be read when something was asked.
  zmq::socket_t& socket() { return socket_; }
  /// Answers what was asked. `refuse` is told of each that may not connect, in a sentence.
  void answer(const std::function<void(const std::string&)>& refuse);

 private:
  const Keys& keys_;
  zmq::socket_t socket_;
};

}  // namespace rosefusion::link
