#include "base/file/standard_streams.h"

#include <fcntl.h>
#include <unistd.h>

#include <cstdio>

namespace koboshi {

// open() returns the lowest free descriptor. The wrong direction of access makes each use fail.
void reserve_standard_streams() {
  for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(descriptor, F_GETFD) >= 0) continue;
    if (::open("/dev/null", descriptor == STDIN_FILENO ? O_WRONLY : O_RDONLY) != descriptor) return;
  }
}

void write_to_standard_error(std::string_view text) {
  static_cast<void>(std::fwrite(text.data(), 1, text.size(), stderr));
}

}  // namespace koboshi
