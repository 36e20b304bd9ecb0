#pragma once

#include <termios.h>

#include <string>
#include <vector>

namespace koboshi::tools {

// The terminal of this process in raw mode, with its alternate screen. Ctrl-C remains a signal. Keys that
// would stop or kill the process without restoring the terminal (Ctrl-Z, Ctrl-\) or block the run (Ctrl-S)
// are off. The destructor restores the terminal.
class Terminal {
 public:
  // Returns whether standard input and output are a terminal.
  [[nodiscard]] static bool is_there();

  // Throws std::system_error.
  Terminal();
  ~Terminal();
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  // Returns the bytes that have been typed, without waiting.
  [[nodiscard]] std::string read();
  // Whether the terminal has been closed.
  bool closed() const { return closed_; }
  // Draws these lines.
  void show(const std::vector<std::string>& lines);

 private:
  termios before_{};
  bool closed_ = false;
};

}  // namespace koboshi::tools
