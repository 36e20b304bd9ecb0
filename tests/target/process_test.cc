#include "simulation/host/qemu_process.h"

#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <optional>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/text/error.h"
#include "hal/cortex_m/mps2/wire.h"
#include "simulation/host/qemu_host.h"

namespace koboshi::tools {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;
namespace wire = cortex_m::wire;

// Waits for the end of a process that is a child of this one, or has become so. Returns false if it does not
// end.
bool ends(pid_t pid) {
  using namespace std::chrono_literals;
  for (int i = 0; i < 500; ++i) {
    if (waitpid(pid, nullptr, WNOHANG) == pid) return true;
    std::this_thread::sleep_for(10ms);
  }
  return false;
}

// Starts a host in a child process, which reports the id of its QEMU.
[[noreturn]] void be_a_host(int pipe) {
  const simulation::QemuHost host(KOBOSHI_IMAGE, {});
  const pid_t qemu = host.pid();
  static_cast<void>(write(pipe, &qemu, sizeof qemu));
  for (;;) pause();
}

TEST(QemuProcess, DoesNotOutliveAHostThatIsKilled) {
  prctl(PR_SET_CHILD_SUBREAPER, 1);  // makes this process the parent of the orphan
  std::array<int, 2> said{};
  ASSERT_EQ(pipe(said.data()), 0);
  const pid_t host = fork();
  ASSERT_GE(host, 0);
  if (host == 0) be_a_host(said[1]);
  pid_t qemu = 0;
  ASSERT_EQ(read(said[0], &qemu, sizeof qemu), static_cast<ssize_t>(sizeof qemu));
  ASSERT_EQ(kill(qemu, 0), 0);
  kill(host, SIGKILL);
  EXPECT_TRUE(ends(host));
  EXPECT_TRUE(ends(qemu));
}

TEST(QemuProcess, EndsWithItsOwner) {
  std::optional<simulation::QemuHost> host(std::in_place, KOBOSHI_IMAGE, std::span<const std::byte>());
  const pid_t qemu = host->pid();
  ASSERT_EQ(kill(qemu, 0), 0);
  host.reset();
  EXPECT_EQ(kill(qemu, 0), -1);
  EXPECT_EQ(errno, ESRCH);
}

TEST(QemuProcess, ReportsWhenQemuEnds) {
  simulation::QemuHost host(KOBOSHI_IMAGE, {});
  kill(host.pid(), SIGKILL);
  hal::BatchOutput output;
  EXPECT_THAT([&] { host.exchange({}, output); },
              ThrowsMessage<std::runtime_error>(HasSubstr("qemu-system-arm ended")));
}

TEST(QemuProcess, ReportsWhenQemuDoesNotAnswer) {
  simulation::QemuProcess process(KOBOSHI_IMAGE, 200);
  kill(process.pid(), SIGSTOP);
  std::array<std::byte, wire::kMaxMessageBytes> message{};
  const std::size_t size = wire::put_header(message, wire::Kind::kStart, 0);
  std::array<std::byte, wire::kMaxMessageBytes> answer{};
  EXPECT_THAT([&] { process.ask(std::span(message).first(size), answer); },
              ThrowsMessage<std::runtime_error>(HasSubstr("did not answer for 200 ms")));
}

TEST(QemuProcess, RejectsAMissingImage) {
  EXPECT_THAT(
      [] { simulation::QemuProcess("no/such.elf"); },
      ThrowsMessage<InputError>(
          "no/such.elf: found no such file, expected the Cortex-M4 image, which ./run target builds"));
}

TEST(QemuProcess, RejectsAMissingQemu) {
  const std::string path = getenv("PATH");
  setenv("PATH", "/nowhere:", 1);
  EXPECT_THAT([] { simulation::QemuProcess(KOBOSHI_IMAGE); },
              ThrowsMessage<InputError>(HasSubstr("which ./run target installs")));
  setenv("PATH", path.c_str(), 1);
}

// QEMU rejects a text file as a program, and the error repeats QEMU's message.
TEST(QemuProcess, ForwardsErrorsOfQemu) {
  simulation::QemuProcess process(KOBOSHI_SOURCE_DIR "/README.md");
  std::array<std::byte, wire::kMaxMessageBytes> buffer{};
  EXPECT_THAT([&] { process.ask(std::span(buffer).first(3), buffer); },
              ThrowsMessage<std::runtime_error>(HasSubstr("Lockup")));
}

}  // namespace
}  // namespace koboshi::tools
