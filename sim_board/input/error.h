#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>

namespace koboshi::sim {

// Input that cannot be used. `what()` is one line, `FILE:LINE: found FOUND, expected EXPECTED`
// (without `:LINE` where the trouble is the file itself). The program prints it and exits with status 2.
class InputError : public std::runtime_error {
 public:
  // `limit` names what the input violates, without the value that was found, such as "the reach of the legs";
  // a search counts by it. Without one it is what was expected.
  InputError(const std::filesystem::path& file, int line, const std::string& found,
             const std::string& expected, const std::string& limit = {})
      : std::runtime_error(file.string() + (line > 0 ? ":" + std::to_string(line) : std::string()) +
                           ": found " + found + ", expected " + expected),
        limit_(limit.empty() ? expected : limit) {}

  const std::string& limit() const { return limit_; }

 private:
  std::string limit_;
};

}  // namespace koboshi::sim
