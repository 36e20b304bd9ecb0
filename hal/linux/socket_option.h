#pragma once

#include <sys/socket.h>

#include "hal/linux/file_descriptor.h"

namespace koboshi::hal {

// setsockopt(2). Throws std::system_error.
template <typename T>
void set_option(const FileDescriptor& socket, int level, int option, const T& value) {
  checked(::setsockopt(socket.number(), level, option, &value, sizeof value), "an option of a socket");
}

}  // namespace koboshi::hal
