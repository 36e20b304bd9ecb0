#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>

namespace koboshi {

// A failed write, for example to a full disk. `what()` is one line that names the file.
class WriteError : public std::system_error {
 public:
  // `error` is a value of errno.
  WriteError(const std::filesystem::path& file, int error)
      : std::system_error(error, std::generic_category(), "cannot write " + file.string()) {}
};

// A buffered file that grows by rows, such as a table or a log. Only complete rows reach the file, so it is
// readable even if the program crashes. Every failure throws WriteError, and an incomplete row is truncated.
class OutputFile {
 public:
  enum class Mode {
    kReplace,
    kAppend,  // locks the file (flock), so that rows of two programs do not mix
  };

  // Throws InputError if another program appends to the file.
  explicit OutputFile(const std::filesystem::path& file, Mode mode = Mode::kReplace);
  // Writes the buffer and ignores errors: call `close` first to detect them.
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  // Writes one or more complete rows.
  void write(std::string_view rows);
  // Writes the buffer to the file.
  void flush();
  // Closes the file; only then is it known that all data were written. No writes are permitted afterwards.
  void close();

 private:
  static constexpr std::size_t kBuffer_bytes = std::size_t{1} << 16;

  std::filesystem::path file_;
  int descriptor_;
  std::string buffer_;
};

// Replaces a file atomically: writes a temporary file next to it and renames it. Owner and mode stay, and a
// symbolic link stays one. A file with several names (hard links), and one whose folder or owner forbids a
// replacement, is overwritten in place, after its space has been reserved. Special files, such as pipes or
// terminals, are written directly. Throws WriteError, also for a file that is read-only; the file is then
// unchanged.
void write_whole_file(const std::filesystem::path& file, std::string_view text);

}  // namespace koboshi
