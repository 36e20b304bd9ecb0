#pragma once

#include <sys/types.h>

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>

namespace koboshi::simulation {

// QEMU with the Cortex-M4 image in it, and the two pipes to talk with it. It never outlives its owner: the
// destructor ends it, and when this process dies without one, the kernel does (PR_SET_PDEATHSIG) and the
// image finds its pipe at the end. The thread that makes the object must live as long.
class QemuProcess {
 public:
  // QEMU answers a message within microseconds; this long, it hangs.
  static constexpr int kTimeout_ms = 30'000;

  // `timeout_ms` is how long an answer may take, `more` are arguments for QEMU besides those it needs. Throws
  // sim::InputError when there is no image, or no QEMU on the PATH; std::system_error when the system
  // refuses.
  explicit QemuProcess(const std::filesystem::path& image, int timeout_ms = kTimeout_ms,
                       std::span<const std::string> more = {});
  ~QemuProcess();
  QemuProcess(const QemuProcess&) = delete;
  QemuProcess& operator=(const QemuProcess&) = delete;

  // Sends a message and waits for the answer. Returns the part of `answer` that holds it. Throws
  // std::runtime_error when QEMU has ended, or does not answer in time.
  std::span<const std::byte> ask(std::span<const std::byte> message, std::span<std::byte> answer);

  pid_t pid() const { return pid_; }

 private:
  [[noreturn]] void fail(const std::string& what) const;

  int timeout_ms_;
  int requests_ = -1;  // file descriptors
  int answers_ = -1;
  int complaints_ = -1;  // what QEMU says on its standard error
  pid_t pid_ = -1;
};

}  // namespace koboshi::simulation
