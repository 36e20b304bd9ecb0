#pragma once

#include <sys/types.h>

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>

namespace koboshi::simulation {

// A QEMU process that runs the Cortex-M4 image, with two pipes for messages. QEMU never outlives this object:
// the destructor ends it. If this process dies, the kernel ends QEMU (PR_SET_PDEATHSIG), and the image
// detects the end of its pipe. The creating thread must live as long as the object.
class QemuProcess {
 public:
  // Time-out of an answer. QEMU normally answers within microseconds.
  static constexpr int kTimeout_ms = 30'000;

  // `timeout_ms` limits the time of an answer; `more` are additional arguments for QEMU. Throws
  // InputError if the image or QEMU is not found, and std::system_error if a system call fails.
  explicit QemuProcess(const std::filesystem::path& image, int timeout_ms = kTimeout_ms,
                       std::span<const std::string> more = {});
  ~QemuProcess();
  QemuProcess(const QemuProcess&) = delete;
  QemuProcess& operator=(const QemuProcess&) = delete;

  // Sends a message and waits for the answer. Returns the used part of `answer`. Throws std::runtime_error if
  // QEMU has ended or does not answer in time.
  std::span<const std::byte> ask(std::span<const std::byte> message, std::span<std::byte> answer);

  pid_t pid() const { return pid_; }

 private:
  [[noreturn]] void fail(const std::string& what) const;

  int timeout_ms_;
  int requests_ = -1;  // file descriptors
  int answers_ = -1;
  int complaints_ = -1;  // QEMU's standard error
  pid_t pid_ = -1;
};

}  // namespace koboshi::simulation
