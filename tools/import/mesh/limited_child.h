#pragma once

#include <cstddef>
#include <functional>
#include <string>

namespace koboshi::tools {

struct ChildLimits {
  unsigned int processor_s = 5;
  std::size_t memory_bytes = std::size_t{1} << 30;
  // The limit for a child that waits for something that never comes. Far above `processor_s`, because a child
  // that a loaded machine runs for a thirtieth of the time must give the same result as on an idle one.
  unsigned int waiting_s = 600;
};

struct ChildResult {
  std::string output{};  // what the function returned
  std::string fault{};   // how the child ended otherwise: "took more than 5 s"; empty: it did not
};

// Runs a function in a child process with limits of time and memory, for libraries that may crash or hang on
// a file of a stranger. The child creates no file. Must be called in a process with one thread.
[[nodiscard]] ChildResult run_in_child(const ChildLimits& limits,
                                       const std::function<std::string()>& function);

}  // namespace koboshi::tools
