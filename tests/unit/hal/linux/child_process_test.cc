#include "hal/linux/child_process.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <string>

#include "hal/linux/file_descriptor.h"

namespace koboshi::hal {
namespace {

FileDescriptor memory() { return FileDescriptor(checked(::memfd_create("stream", MFD_CLOEXEC), "memory")); }

std::string content_of(const FileDescriptor& file) {
  std::array<char, 200> text{};
  const ssize_t size = ::pread(file.number(), text.data(), text.size(), 0);
  return {text.data(), static_cast<std::size_t>(size)};
}

TEST(Spawn, ConnectsTheStreamsAndReturnsTheStatus) {
  const FileDescriptor input = memory();
  ASSERT_EQ(::pwrite(input.number(), "given\n", 6, 0), 6);
  const FileDescriptor output = memory();
  const FileDescriptor errors = memory();
  pid_t child = 0;
  ASSERT_EQ(spawn({"sh", "-c", "cat; echo said >&2; exit $0", "3"},
                  {.input = input.number(), .output = output.number(), .errors = errors.number()}, child),
            0);
  const int status = wait_for_child(child);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 3);
  EXPECT_EQ(content_of(output), "given\n");
  EXPECT_EQ(content_of(errors), "said\n");
}

TEST(Spawn, SetsTheDirectoryAndTheEnvironment) {
  const FileDescriptor output = memory();
  std::string variable = "KOBOSHI_SPAWNED=yes";
  char* const environment[] = {variable.data(), nullptr};
  pid_t child = 0;
  ASSERT_EQ(spawn({"sh", "-c", "pwd; echo $KOBOSHI_SPAWNED"},
                  {.output = output.number(), .directory = "/usr", .environment = environment}, child),
            0);
  EXPECT_EQ(wait_for_child(child), 0);
  EXPECT_EQ(content_of(output), "/usr\nyes\n");
}

TEST(Spawn, NamesAProgramThatIsNotThere) {
  pid_t child = 0;
  EXPECT_EQ(spawn({"koboshi-no-such-program"}, {}, child), ENOENT);
}

TEST(Spawn, ReturnsTheSignalThatEndedTheChild) {
  pid_t child = 0;
  ASSERT_EQ(spawn({"sh", "-c", "kill -TERM $$"}, {}, child), 0);
  const int status = wait_for_child(child);
  ASSERT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(WTERMSIG(status), SIGTERM);
}

}  // namespace
}  // namespace koboshi::hal
