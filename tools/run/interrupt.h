#pragma once

#include <csignal>
#include <optional>
#include <stdexcept>
#include <string>

namespace koboshi::tools {

// A signal ended the run before its end. `what()` is one line.
class Interrupted : public std::runtime_error {
 public:
  Interrupted(int signal, const std::string& how_far) : std::runtime_error(how_far), signal_(signal) {}
  int signal() const { return signal_; }

 private:
  int signal_;
};

// Blocks SIGINT (Ctrl-C) and SIGTERM, so that a run can poll for them, end in order and write its files.
// Holds for the thread that makes it and the threads that this one starts afterwards.
class Interrupt {
 public:
  Interrupt();
  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

  // Returns the signal that has come since the last call.
  [[nodiscard]] std::optional<int> requested();

 private:
  sigset_t signals_;
  sigset_t before_;
};

}  // namespace koboshi::tools
