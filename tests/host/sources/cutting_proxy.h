// A network that fails: forwards TCP connections to a port of this machine and breaks them again and again.
#pragma once
#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <stdexcept>
#include <string>
#include <thread>

namespace rosefusion::testing {

inline sockaddr_in loopback(int port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  return address;
}

/// A connected socket; closed by the caller.
inline int connectTo(int port) {
  const int s = socket(AF_INET, SOCK_STREAM, 0);
  const sockaddr_in address = loopback(port);
  if (connect(s, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) return s;
  close(s);
  return -1;
}

inline int portOf(const std::string& endpoint) {
  return std::stoi(endpoint.substr(endpoint.rfind(':') + 1));
}

/// Every connection dies after `bytes` have gone from client to server, wherever in a message that is; the
/// first `cuts` of them, that is: later ones live.
class CuttingProxy {
 public:
  CuttingProxy(int target, std::size_t bytes, int cuts) : target_(target), bytes_(bytes), cuts_(cuts) {
    listener_ = socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address = loopback(0);
    socklen_t length = sizeof address;
    if (bind(listener_, reinterpret_cast<sockaddr*>(&address), length) != 0 || listen(listener_, 8) != 0 ||
        getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &length) != 0)
      throw std::runtime_error("the proxy cannot listen");
    port_ = ntohs(address.sin_port);
    thread_ = std::thread([this] { work(); });
  }
  ~CuttingProxy() {
    stop_ = true;
    thread_.join();
    close(listener_);
  }
  std::string endpoint() const { return "tcp://127.0.0.1:" + std::to_string(port_); }
  int cutsMade() const { return made_; }

 private:
  void work() {
    while (!stop_) {
      pollfd waiting{listener_, POLLIN, 0};
      if (poll(&waiting, 1, 20) <= 0) continue;
      const int client = accept(listener_, nullptr, nullptr), server = connectTo(target_);
      if (server >= 0) forward(client, server);
      // Reset rather than closed, so that what was on its way is lost.
      const linger abort{1, 0};
      for (const int s : {client, server}) {
        if (s < 0) continue;
        setsockopt(s, SOL_SOCKET, SO_LINGER, &abort, sizeof abort);
        close(s);
      }
    }
  }
  void forward(int client, int server) {
    std::size_t passed = 0;
    std::array<char, 4096> chunk;
    while (!stop_) {
      std::array<pollfd, 2> both{pollfd{client, POLLIN, 0}, pollfd{server, POLLIN, 0}};
      if (poll(both.data(), both.size(), 20) <= 0) continue;
      for (int i = 0; i < 2; ++i) {
        if (!both[i].revents) continue;
        const ssize_t n = recv(both[i].fd, chunk.data(), chunk.size(), 0);
        if (n <= 0 || ::send(both[1 - i].fd, chunk.data(), static_cast<std::size_t>(n), MSG_NOSIGNAL) != n)
          return;
        if (i == 0) passed += static_cast<std::size_t>(n);
      }
      if (passed > bytes_ && made_ < cuts_) {
        ++made_;
        return;
      }
    }
  }

  int target_, listener_ = -1, port_ = 0;
  std::size_t bytes_;
  int cuts_;
  std::atomic<int> made_{0};
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace rosefusion::testing
