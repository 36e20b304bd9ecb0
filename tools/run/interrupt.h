#pragma once

#include <chrono>
#include <csignal>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>

#include "hal/linux/file_descriptor.h"

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
// Holds for the thread that makes it and the threads that this one starts afterwards. While it exists, a
// thread must wait by its functions only: any other wait would ignore the signals.
class Interrupt {
 public:
  Interrupt();
  ~Interrupt() { release(); }
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

  // Returns the signal that has come since the last call.
  [[nodiscard]] std::optional<int> requested();

  // Waits until this time. Returns at once when a signal has come, which `requested` then returns.
  void sleep_until(std::chrono::steady_clock::time_point due);
  // Waits until a descriptor is readable, its other side is gone, or this time has passed. Returns false,
  // and at once, when a signal has come.
  bool wait_for_input(int descriptor, std::uint64_t timeout_us);

  // Signals have their former effect again, also one that has come and was not requested. For the part of a
  // command that has nothing to save and waits for other programs.
  void release();

 private:
  sigset_t signals_;
  sigset_t before_;
  bool blocks_ = true;
  hal::FileDescriptor arrived_;  // readable while a signal waits
};

}  // namespace koboshi::tools
