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

// Messages for this socket that the kernel has thrown away since it was made, for want of room in its buffer
// or because its filter did not want them (SO_MEMINFO); 0 where the kernel does not tell.
inline std::uint64_t drops(const FileDescriptor& socket) {
  std::array<std::uint32_t, SK_MEMINFO_VARS> info{};
  socklen_t length = sizeof info;
  if (::getsockopt(socket.number(), SOL_SOCKET, SO_MEMINFO, info.data(), &length) != 0) return 0;
  return info[SK_MEMINFO_DROPS];
}

}  // namespace koboshi::hal
