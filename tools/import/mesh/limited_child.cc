#include "tools/import/mesh/limited_child.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <exception>
#include <new>
#include <string_view>
#include <system_error>

// AddressSanitizer reserves terabytes of addresses.
#if defined(__SANITIZE_ADDRESS__)
constexpr bool kLimitsMemory = false;
#else
constexpr bool kLimitsMemory = true;
#endif

namespace koboshi::tools {
namespace {

enum Status : int { kDone = 0, kNoMemory = 70, kException = 71 };

void set_limit(int resource, rlim_t value) {
  const rlimit limit{value, value};
  static_cast<void>(setrlimit(static_cast<__rlimit_resource>(resource), &limit));
}

void write_all(int descriptor, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return;
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
}

[[noreturn]] void run_child(const ChildLimits& limits, int output,
                            const std::function<std::string()>& function) {
  for (const int crash : {SIGSEGV, SIGABRT, SIGFPE, SIGBUS, SIGILL}) signal(crash, SIG_DFL);
  signal(SIGXFSZ, SIG_IGN);  // a log that a library tries to write fails, and no more
  set_limit(RLIMIT_CPU, limits.processor_s);
  set_limit(RLIMIT_CORE, 0);
  set_limit(RLIMIT_FSIZE, 0);  // pipes are not files
  if (kLimitsMemory) set_limit(RLIMIT_AS, limits.memory_bytes);
  alarm(limits.waiting_s);
  // The prints of a library must not become part of the program's output.
  const int null = open("/dev/null", O_RDWR);
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) dup2(null, stream);
  try {
    write_all(output, function());
    _exit(kDone);
  } catch (const std::bad_alloc&) {
    _exit(kNoMemory);
  } catch (...) {
    _exit(kException);
  }
}

std::string read_all(int descriptor) {
  std::string bytes;
  std::array<char, 65536> buffer;
  while (true) {
    const ssize_t count = ::read(descriptor, buffer.data(), buffer.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return bytes;
    bytes.append(buffer.data(), static_cast<std::size_t>(count));
  }
}

std::string fault_of(int status, const ChildLimits& limits) {
  if (WIFEXITED(status)) {
    if (WEXITSTATUS(status) == kDone) return {};
    return WEXITSTATUS(status) == kNoMemory ? "needed more memory than it may take" : "failed";
  }
  const int signal_number = WTERMSIG(status);
  if (signal_number == SIGALRM) return "waited for more than " + std::to_string(limits.waiting_s) + " s";
  if (signal_number == SIGXCPU || signal_number == SIGKILL)
    return "took more than " + std::to_string(limits.processor_s) + " s";
  return std::string("crashed (") + strsignal(signal_number) + ")";
}

}  // namespace

ChildResult run_in_child(const ChildLimits& limits, const std::function<std::string()>& function) {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) throw std::system_error(errno, std::generic_category(), "pipe");
  const pid_t child = fork();
  if (child < 0) throw std::system_error(errno, std::generic_category(), "fork");
  if (child == 0) {
    close(ends[0]);
    run_child(limits, ends[1], function);
  }
  close(ends[1]);
  ChildResult result{.output = read_all(ends[0])};
  close(ends[0]);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
  result.fault = fault_of(status, limits);
  return result;
}

}  // namespace koboshi::tools
