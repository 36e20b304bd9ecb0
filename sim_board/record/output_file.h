#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>

namespace koboshi::sim {

// A file that could not be written, such as on a full disk. `what()` is one line that names the file.
class WriteError : public std::system_error {
 public:
  // `error` is a value of errno.
  WriteError(const std::filesystem::path& file, int error)
      : std::system_error(error, std::generic_category(), "cannot write " + file.string()) {}
};

// A file that grows row by row, such as a table or a log, with a buffer. Only whole rows reach the file, so
// that whatever ends the program, its readers accept what is there. Every failure throws WriteError; the row
// that did not fit is cut off again.
class OutputFile {
 public:
  enum class Mode {
    kReplace,
    kAppend,  // the file is locked meanwhile (flock): rows of two programs do not mix
  };

  // Throws InputError when another program appends to the file.
  explicit OutputFile(const std::filesystem::path& file, Mode mode = Mode::kReplace);
  // Writes what is in the buffer as far as that goes: call `close` first, which reports errors.
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  // One or more whole rows.
  void write(std::string_view rows);
  // Writes the buffer to the file.
  void flush();
  // Only after this is everything known to be written. Nothing may be written afterwards.
  void close();

 private:
  static constexpr std::size_t kBuffer_bytes = std::size_t{1} << 16;

  std::filesystem::path file_;
  int descriptor_;
  std::string buffer_;
};

// Writes the text to a file beside and renames it, so that a reader finds the whole text or the file as it
// was. A symbolic link stays one. What is no regular file, such as a pipe or a terminal, is written directly.
// Throws WriteError.
void write_whole_file(const std::filesystem::path& file, std::string_view text);

}  // namespace koboshi::sim
