#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

namespace koboshi::hal {

// How a program is started. Streams are file descriptors of this process; -1: the child shares its own.
struct ChildSetup {
  int input = -1;
  int output = -1;
  int errors = -1;
  std::filesystem::path directory{};   // empty: the current one
  char* const* environment = nullptr;  // null: that of this process
};

// Starts a program, found as a shell finds it by the first of its arguments, and sets `child`. Returns 0, or
// errno: ENOENT if there is no such program.
[[nodiscard]] int spawn(const std::vector<std::string>& arguments, const ChildSetup& setup, pid_t& child);

// Waits for the end of a child, through signals. Returns its status as waitpid does.
int wait_for_child(pid_t child);

}  // namespace koboshi::hal
