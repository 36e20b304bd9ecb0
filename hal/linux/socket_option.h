#pragma once

#include <linux/sock_diag.h>
#include <sys/socket.h>

#include <array>
#include <cstdint>

#include "hal/linux/file_descriptor.h"

namespace koboshi::hal {

// setsockopt(2). Throws std::system_error.
template <typename T>
void set_option(const FileDescriptor& socket, int level, int option, const T& value) {
  checked(::setsockopt(socket.number(), level, option, &value, sizeof value), "an option of a socket");
}

// Returns the number of messages for this socket that the kernel has dropped so far, because the buffer was
// full or the filter did not match (SO_MEMINFO); 0 if the kernel does not support it.
inline std::uint64_t drops(const FileDescriptor& socket) {
  std::array<std::uint32_t, SK_MEMINFO_VARS> info{};
  socklen_t length = sizeof info;
  if (::getsockopt(socket.number(), SOL_SOCKET, SO_MEMINFO, info.data(), &length) != 0) return 0;
  return info[SK_MEMINFO_DROPS];
}

}  // namespace koboshi::hal
