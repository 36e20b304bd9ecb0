#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/text/foreign_text.h"
#include "hal/port/can.h"
#include "sim_board/can/candump_line.h"

namespace koboshi::sim_board {

// The log format of `candump -L`, which canplayer, log2asc, Wireshark and SavvyCAN read, with simulated time:
//   (0000000012.345678) vcan0 210#0F00112233
// A remote frame is `#R`, followed by the requested size unless it is zero.

inline constexpr std::string_view kLogInterface = "vcan0";

// Maximum length of a line: 20 digits of seconds, and an interface name of 15 characters, Linux' maximum.
inline constexpr std::size_t kMaxLogLineBytes = 1 + 20 + 1 + 6 + 2 + 15 + 1 + 4 + 16 + 1;

// Writes the line with its newline and returns its length. Precondition: the interface's name has at most 15
// characters.
std::size_t format_log_line(std::span<char, kMaxLogLineBytes> line, const hal::CanFrame& frame,
                            std::uint64_t time_us, std::string_view interface = kLogInterface);

// Returns the line of any frame, with its newline.
std::string log_line(const LoggedFrame& logged);

// Reads a log of can-utils line by line: all that parse_log_line accepts, and
// - times since the first frame (candump -t z) or since the previous one (-t d, recognised by reading ahead);
// - a clock that was set back: the times go on from the last one. Frames in disorder by up to a second have
//   the time of the latest;
// - a last line without end, as after a crash: it is left out;
// - a byte order mark, and lines that end with CR.
class CandumpReader {
 public:
  // How to read the times: as they are (-t a, -t A, -t z), as differences (-t d), or as differences only if
  // the log begins at zero and its times then decrease or repeat, for which a pipe cannot be searched.
  enum class Times { kRecognised, kAbsolute, kDifferences };

  // Throws InputError if the file cannot be opened.
  explicit CandumpReader(const std::filesystem::path& file, Times times = Times::kRecognised);
  // Reads a stream, which must outlive the reader. `name`: for messages.
  CandumpReader(std::istream& stream, const std::filesystem::path& name, Times times = Times::kRecognised);

  // Returns the next frame, or nothing at the end. Throws InputError for a line that is neither a frame nor
  // a comment.
  std::optional<LoggedFrame> next();
  // Returns the remarks for the user on the part read so far, one line for each: FILE:LINE: TEXT. There is at
  // most one of each kind, and one more at the end of the log with the number of others.
  const std::vector<std::string>& remarks() const { return remarks_; }
  // Whether the last remark is that the last line has no end.
  bool is_cut_off() const { return cut_off_; }

 private:
  void remark(const std::string& text) { remark(line_number_, text); }
  void remark(int line, const std::string& text);
  void end();
  std::uint64_t time_of(const LogLine& line);
  std::uint64_t time_after_decrease(const LogLine& line);
  // Returns the line that shows that the times are differences; 0 if there is none.
  int line_of_differences(const std::string& first_interface);

  std::filesystem::path file_;
  std::unique_ptr<std::ifstream> opened_;
  std::istream& stream_;
  LineReader lines_;
  Times times_;
  std::string text_;
  int line_number_ = 0;
  std::vector<std::string> remarks_;
  bool begun_ = false;
  bool cut_off_ = false;
  bool relative_ = false;     // the first time is zero, padded to three digits
  bool differences_ = false;  // of times
  std::uint64_t last_us_ = 0;
  std::string last_interface_;   // of the frame with the latest time
  std::uint64_t offset_us_ = 0;  // of a clock that was set back
  std::uint64_t times_set_back_ = 0;
  int first_disorder_ = 0;  // line of the first frame with a time before one of the same interface
  std::uint64_t disordered_ = 0;
};

}  // namespace koboshi::sim_board
