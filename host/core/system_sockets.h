// What is asked of the operating system about connections that a library made, by their numbers.
#pragma once
#include <cstdint>

namespace rosefusion {

/// What a socket has received; 0 where that is not known (other systems than Linux).
std::uint64_t bytesReceived(int connection);

/// The TCP port of this side of a connection, -1 when it has none: its number may be another file's by now.
int portOfThisSide(int connection);

/// Ends a connection both ways; its number stays taken until its owner closes it.
void shutDown(int connection);

}  // namespace rosefusion
