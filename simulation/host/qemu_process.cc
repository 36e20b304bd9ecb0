#include "simulation/host/qemu_process.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <sstream>
#include <system_error>
#include <vector>

#include "base/text/error.h"

namespace koboshi::simulation {
namespace {

constexpr const char* kProgram = "qemu-system-arm";

[[noreturn]] void refuse(const char* what) { throw std::system_error(errno, std::generic_category(), what); }

std::filesystem::path find_program() {
  const char* const path = std::getenv("PATH");
  std::istringstream folders(path != nullptr ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');) {
    const std::filesystem::path candidate = std::filesystem::path(folder) / kProgram;
    if (access(candidate.c_str(), X_OK) == 0) return candidate;
  }
  throw InputError(kProgram, 0, "no such program on the PATH", "QEMU for Arm, which ./run target installs");
}

struct Pipe {
  Pipe() {
    if (pipe2(ends.data(), O_CLOEXEC) != 0) refuse("pipe");
  }
  int read_end() const { return ends[0]; }
  int write_end() const { return ends[1]; }
  std::array<int, 2> ends{};
};

// With -icount, each instruction takes 64 ns of virtual time, independent of the host, and virtual time stops
// while the image waits for a message. SysTick therefore counts instructions.
std::vector<std::string> command(const std::filesystem::path& program, const std::filesystem::path& image) {
  return {program,
          "-M",
          "mps2-an386",
          "-icount",
          "shift=6,sleep=off",
          "-display",
          "none",
          "-monitor",
          "none",
          "-nodefaults",
          "-nic",
          "none",
          "-semihosting-config",
          "enable=on,target=native",
          "-kernel",
          image};
}

// Runs in the child between fork and exec, where only system calls are safe.
[[noreturn]] void become(char* const* arguments, pid_t parent, int requests, int answers, int complaints) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(0);  // the parent has died already
  signal(SIGPIPE, SIG_DFL);
  // Descriptors may occupy each other's targets, so all are first moved to high numbers.
  const int nothing = fcntl(open("/dev/null", O_RDWR), F_DUPFD_CLOEXEC, 16);
  requests = fcntl(requests, F_DUPFD_CLOEXEC, 16);
  answers = fcntl(answers, F_DUPFD_CLOEXEC, 16);
  complaints = fcntl(complaints, F_DUPFD_CLOEXEC, 16);
  dup2(nothing, STDIN_FILENO);
  dup2(complaints, STDOUT_FILENO);
  dup2(complaints, STDERR_FILENO);
  dup2(requests, 3);  // wire::kRequestPath
  dup2(answers, 4);   // wire::kAnswerPath
  execv(arguments[0], arguments);
  _exit(127);
}

}  // namespace

QemuProcess::QemuProcess(const std::filesystem::path& image, int timeout_ms,
                         std::span<const std::string> more)
    : timeout_ms_(timeout_ms) {
  if (!std::filesystem::is_regular_file(image)) {
    throw InputError(image, 0, "no such file", "the Cortex-M4 image, which ./run target builds");
  }
  std::vector<std::string> words = command(find_program(), image);
  words.insert(words.end(), more.begin(), more.end());
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);

  signal(SIGPIPE, SIG_IGN);  // makes a write to a dead QEMU return an error
  const Pipe requests;
  const Pipe answers;
  complaints_ = memfd_create("qemu", MFD_CLOEXEC);
  requests_ = requests.write_end();
  answers_ = answers.read_end();
  const pid_t parent = getpid();
  pid_ = fork();
  if (pid_ < 0) refuse("fork");
  if (pid_ == 0) {
    become(arguments.data(), parent, requests.read_end(), answers.write_end(), complaints_);
  }
  close(requests.read_end());
  close(answers.write_end());
}

QemuProcess::~QemuProcess() {
  close(requests_);
  close(answers_);
  kill(pid_, SIGKILL);
  waitpid(pid_, nullptr, 0);
  close(complaints_);
}

std::span<const std::byte> QemuProcess::ask(std::span<const std::byte> message, std::span<std::byte> answer) {
  // Writes of up to PIPE_BUF bytes to a pipe are atomic.
  if (write(requests_, message.data(), message.size()) != static_cast<ssize_t>(message.size())) fail("ended");
  pollfd wait{.fd = answers_, .events = POLLIN, .revents = 0};
  if (poll(&wait, 1, timeout_ms_) == 0) fail("did not answer for " + std::to_string(timeout_ms_) + " ms");
  const ssize_t size = read(answers_, answer.data(), answer.size());
  if (size <= 0) fail("ended");
  return answer.first(static_cast<std::size_t>(size));
}

void QemuProcess::fail(const std::string& what) const {
  std::array<char, 200> said{};  // only the beginning: QEMU may dump all registers
  const ssize_t size = pread(complaints_, said.data(), said.size(), 0);
  std::string words(said.data(), size > 0 ? static_cast<std::size_t>(size) : 0);
  for (char& letter : words) letter = letter == '\n' ? ' ' : letter;
  throw std::runtime_error(std::string(kProgram) + " " + what + (words.empty() ? "" : ": " + words));
}

}  // namespace koboshi::simulation
