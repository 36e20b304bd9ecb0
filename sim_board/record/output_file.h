#pragma once

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string_view>

namespace koboshi::sim {

// A file being written, with a buffer. Every failure, a full disk included, throws std::system_error that
// names the file.
class OutputFile {
 public:
  explicit OutputFile(const std::filesystem::path& file);

  void write(std::string_view bytes);
  // Hands over what is in the buffer, so that it stays when the program is killed.
  void flush();
  // Only after this is everything known to be written. Without it the destructor closes the file and says
  // nothing.
  void close();

 private:
  struct Close {
    void operator()(std::FILE* stream) const { std::fclose(stream); }
  };

  [[noreturn]] void fail() const;

  std::filesystem::path file_;
  std::unique_ptr<std::FILE, Close> stream_;
};

// Writes the text to a file beside and renames it, so that a reader finds the whole or nothing new. Throws
// std::system_error.
void write_whole_file(const std::filesystem::path& file, std::string_view text);

}  // namespace koboshi::sim
