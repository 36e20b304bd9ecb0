#pragma once

#include <string>
#include <string_view>

namespace koboshi {

// Returns a text as one word of a command line of a POSIX shell: in single quotes if it has characters that
// the shell reads, such as a blank. For scripts, and for commands that a message or a page shows.
std::string shell_word(std::string_view text);

}  // namespace koboshi
