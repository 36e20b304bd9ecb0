#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>

namespace koboshi::sim {

// An input error. `what()` is one line, `FILE:LINE: found FOUND, expected EXPECTED` (without `:LINE` if the
// error concerns the whole file). The program prints it and exits with status 2.
class InputError : public std::runtime_error {
 public:
  // `limit` names the violated limit without the value found, such as "the reach of the legs"; a search
  // counts errors by it. Default: `expected`.
  InputError(const std::filesystem::path& file, int line, const std::string& found,
             const std::string& expected, const std::string& limit = {})
      : std::runtime_error(file.string() + (line > 0 ? ":" + std::to_string(line) : std::string()) +
                           ": found " + found + ", expected " + expected),
        line_(line),
        found_(found),
        expected_(expected),
        limit_(limit.empty() ? expected : limit) {}

  int line() const { return line_; }
  const std::string& found() const { return found_; }
  const std::string& expected() const { return expected_; }
  const std::string& limit() const { return limit_; }

 private:
  int line_;
  std::string found_;
  std::string expected_;
  std::string limit_;
};

}  // namespace koboshi::sim
