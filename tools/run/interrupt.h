#pragma once

#include <csignal>
#include <optional>
#include <stdexcept>
#include <string>

namespace koboshi::tools {

// Thrown where a signal ended what had not come to its end. `what()` is one line.
class Interrupted : public std::runtime_error {
 public:
  Interrupted(int signal, const std::string& how_far) : std::runtime_error(how_far), signal_(signal) {}
  int signal() const { return signal_; }

 private:
  int signal_;
};

// Ctrl-C and a request to end, as something to ask for: what runs ends as if it had come to its end, and
// writes its files. For the thread that makes it and those that this thread starts afterwards.
class Interrupt {
 public:
  Interrupt();
  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

  // The signal that has come since the last time this was asked: SIGINT or SIGTERM.
  [[nodiscard]] std::optional<int> requested();

 private:
  sigset_t signals_;
  sigset_t before_;
};

}  // namespace koboshi::tools
