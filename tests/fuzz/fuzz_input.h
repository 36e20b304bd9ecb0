#pragma once

#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "base/text/error.h"

namespace koboshi::fuzz {

// A file with the fuzzer's bytes, for readers that take only files. One per process, in memory where Linux
// has /dev/shm.
class InputFile {
 public:
  explicit InputFile(std::string_view name)
      : folder_(base() / ("koboshi_fuzz_" + std::to_string(getpid()))), path_(folder_ / name) {
    std::filesystem::create_directories(folder_);
  }
  ~InputFile() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  // Replaces the contents.
  const std::filesystem::path& with(std::span<const std::uint8_t> bytes) {
    std::ofstream(path_, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    return path_;
  }

 private:
  static std::filesystem::path base() {
    const std::filesystem::path memory = "/dev/shm";
    return std::filesystem::is_directory(memory) ? memory : std::filesystem::temp_directory_path();
  }

  std::filesystem::path folder_;
  std::filesystem::path path_;
};

inline std::string_view text_of(std::span<const std::uint8_t> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

// Calls a reader, which may refuse its input by InputError and by nothing else: any other exception ends the
// fuzzer. Each message must be a single line, since the program prints it as one.
template <typename Reader>
auto read_or_refuse(Reader&& reader) -> std::optional<decltype(reader())> {
  try {
    return reader();
  } catch (const InputError& error) {
    const std::string_view message = error.what();
    if (message.empty() || message.find('\n') != std::string_view::npos) {
      std::fprintf(stderr, "not one line: \"%s\"\n", error.what());
      __builtin_trap();
    }
    return {};
  }
}

// Takes numbers from the front of the input; zeros after its end.
class Numbers {
 public:
  explicit Numbers(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  bool empty() const { return bytes_.empty(); }
  std::uint8_t byte() {
    if (bytes_.empty()) return 0;
    const std::uint8_t first = bytes_.front();
    bytes_ = bytes_.subspan(1);
    return first;
  }
  std::uint16_t u16() {
    const std::uint8_t low = byte();
    return static_cast<std::uint16_t>(low | byte() << 8);
  }
  std::span<const std::uint8_t> rest() const { return bytes_; }

 private:
  std::span<const std::uint8_t> bytes_;
};

}  // namespace koboshi::fuzz
