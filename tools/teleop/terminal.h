#pragma once

#include <termios.h>

#include <string>
#include <vector>

namespace koboshi::tools {

// The terminal of this process while keys are taken from it one by one and its screen is drawn over. Ctrl-C
// stays the signal that it is; what would stop or kill the process without giving the terminal back
// (Ctrl-Z, Ctrl-\) or hold the run up (Ctrl-S) is off. Gives it back as it was.
class Terminal {
 public:
  // Whether both standard input and output are one.
  [[nodiscard]] static bool is_there();

  // Throws std::system_error.
  Terminal();
  ~Terminal();
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  // What has been typed; does not wait.
  [[nodiscard]] std::string read();
  // Whoever was at it has gone.
  bool closed() const { return closed_; }
  // Draws these lines.
  void show(const std::vector<std::string>& lines);

 private:
  termios before_{};
  bool closed_ = false;
};

}  // namespace koboshi::tools
