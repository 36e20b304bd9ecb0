#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>

#include "base/text/text.h"

namespace koboshi {

// An input error. `what()` is one line of UTF-8, `FILE:LINE: found FOUND, expected EXPECTED` (without `:LINE`
// if the error concerns the whole file). The program prints it and exits with status 2.
class InputError : public std::runtime_error {
 public:
  // `limit` names the violated limit without the value found, such as "the reach of the legs"; a search
  // counts errors by it. Default: `expected`.
  InputError(const std::filesystem::path& file, int line, const std::string& found,
             const std::string& expected, const std::string& limit = {})
      : std::runtime_error(utf8_line(file.string() + (line > 0 ? ":" + std::to_string(line) : std::string()) +
                                     ": found " + found + ", expected " + expected)),
        file_(file),
        line_(line),
        found_(found),
        expected_(expected),
        limit_(limit.empty() ? expected : limit) {}

  const std::filesystem::path& file() const { return file_; }  // or the option that names the source
  int line() const { return line_; }                           // 0: the file as a whole
  const std::string& found() const { return found_; }
  const std::string& expected() const { return expected_; }
  const std::string& limit() const { return limit_; }

 private:
  std::filesystem::path file_;
  int line_;
  std::string found_;
  std::string expected_;
  std::string limit_;
};

}  // namespace koboshi
