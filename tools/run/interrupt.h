#pragma once

#include <csignal>

namespace koboshi::tools {

// Ctrl-C and a request to end, as something to ask for: what runs ends as if it had come to its end, and
// writes its files. For the thread that makes it and those that this thread starts afterwards.
class Interrupt {
 public:
  Interrupt();
  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

  // Whether one has come since the last time this was asked.
  [[nodiscard]] bool requested();

 private:
  sigset_t signals_;
  sigset_t before_;
};

}  // namespace koboshi::tools
