#include "host/core/system_sockets.h"

#ifdef _WIN32
#include <ws2tcpip.h>
#else
#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#endif
#ifdef __linux__
#include <linux/tcp.h>  // netinet/tcp.h does not know of tcpi_bytes_received
#endif

namespace rosefusion {

std::uint64_t bytesReceived(int connection) {
#ifdef __linux__
  tcp_info info{};
  socklen_t size = sizeof info;
  if (getsockopt(connection, IPPROTO_TCP, TCP_INFO, &info, &size) == 0) return info.tcpi_bytes_received;
#endif
  (void)connection;
  return 0;
}

int portOfThisSide(int connection) {
  sockaddr_storage address{};
  socklen_t size = sizeof address;
  if (getsockname(connection, reinterpret_cast<sockaddr*>(&address), &size) != 0) return -1;
  if (address.ss_family == AF_INET) return ntohs(reinterpret_cast<sockaddr_in&>(address).sin_port);
  if (address.ss_family == AF_INET6) return ntohs(reinterpret_cast<sockaddr_in6&>(address).sin6_port);
  return -1;
}

void shutDown(int connection) {
#ifdef _WIN32
  shutdown(connection, SD_BOTH);
#else
  shutdown(connection, SHUT_RDWR);
#endif
}

}  // namespace rosefusion
