#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace koboshi::lab {

struct ChildResult {
  int status = 0;        // of the exit; 128 plus the signal's number, as in shells
  std::string output{};  // what it wrote to standard output, if it was captured
};

enum class ChildOutput { kCaptured, kShown };

// Runs a program, found like a shell finds it, and waits for it. An empty `directory` is the current one.
// Throws InputError, with `remedy` as what was expected, if there is no such program, and std::system_error.
[[nodiscard]] ChildResult run_child(const std::vector<std::string>& arguments, ChildOutput output,
                                    const std::string& remedy, const std::filesystem::path& directory = {});

}  // namespace koboshi::lab
