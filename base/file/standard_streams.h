#pragma once

#include <string_view>
#include <utility>

#include <fmt/core.h>

namespace koboshi {

// Opens those of the descriptors 0 to 2 that the caller has closed, so that no other file takes their number.
// Reading and writing them still fails, with EBADF. Call it before any file is opened.
void reserve_standard_streams();

// Writes to standard error and ignores a failure, which could be reported nowhere: a message must not replace
// the exit status of the program.
void write_to_standard_error(std::string_view text);

// As fmt::print(stderr, ...), but never throws because of the stream.
template <typename... Arguments>
void print_error(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
  write_to_standard_error(fmt::format(format, std::forward<Arguments>(arguments)...));
}

}  // namespace koboshi
