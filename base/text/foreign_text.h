#pragma once

#include <cstddef>
#include <filesystem>
#include <istream>
#include <string>
#include <string_view>

namespace koboshi {

// Text files as other systems write them: lines that end with LF, CR LF or CR, a byte order mark of UTF-8 at
// the beginning, and extensions in capitals.

// Returns the text without a byte order mark, and with LF at the end of each line.
std::string with_line_feeds(std::string_view text);

// Returns the extension of a file in lower case, with its dot: ".asc" for WALK.ASC.
std::string extension_of(const std::filesystem::path& file);

// Reads the lines of a stream, which must outlive it. Never waits for the byte after a CR.
class LineReader {
 public:
  static constexpr std::size_t kMaxBytes = 65'536;  // a longer line is read in parts

  explicit LineReader(std::istream& stream) : stream_(stream) {}

  // Reads the next line, without its end. Returns false at the end of the stream, and after a read error,
  // which sets the stream's badbit.
  bool next(std::string& line);
  // Returns whether the line read last had an end.
  bool has_end() const { return has_end_; }

 private:
  void read(std::string& line);

  std::istream& stream_;
  bool is_first_ = true;
  bool has_end_ = false;
  bool after_return_ = false;  // an LF that follows belongs to the CR
};

}  // namespace koboshi
