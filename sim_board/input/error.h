#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>

namespace koboshi::sim {

// Input that cannot be used. `what()` is one line, `FILE:LINE: found FOUND, expected EXPECTED`
// (without `:LINE` where the trouble is the file itself). The program prints it and exits with status 2.
class InputError : public std::runtime_error {
 public:
  InputError(const std::filesystem::path& file, int line, const std::string& found,
             const std::string& expected)
      : std::runtime_error(file.string() + (line > 0 ? ":" + std::to_string(line) : std::string()) +
                           ": found " + found + ", expected " + expected) {}
};

}  // namespace koboshi::sim
