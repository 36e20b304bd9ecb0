#include "lab/cluster/child.h"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <system_error>

#include "base/text/error.h"
#include "hal/linux/child_process.h"
#include "hal/linux/file_descriptor.h"

namespace koboshi::lab {
namespace {

std::string read_to_end(int descriptor) {
  std::string text;
  std::array<char, 4096> buffer{};
  for (;;) {
    const ssize_t count = ::read(descriptor, buffer.data(), buffer.size());
    if (count > 0) {
      text.append(buffer.data(), static_cast<std::size_t>(count));
    } else if (count == 0 || errno != EINTR) {
      return text;
    }
  }
}

}  // namespace

ChildResult run_child(const std::vector<std::string>& arguments, ChildOutput output,
                      const std::string& remedy, const std::filesystem::path& directory) {
  std::array<int, 2> pipe{};
  if (::pipe2(pipe.data(), O_CLOEXEC) != 0) throw std::system_error(errno, std::generic_category(), "pipe");
  const hal::FileDescriptor from(pipe[0]);
  hal::FileDescriptor into(pipe[1]);
  hal::ChildSetup setup{.directory = directory};
  if (output == ChildOutput::kCaptured) setup.output = into.number();
  pid_t child = 0;
  const int error = hal::spawn(arguments, setup, child);
  if (error == ENOENT) throw InputError(arguments.front(), 0, "no such program", remedy);
  if (error != 0) throw std::system_error(error, std::generic_category(), arguments.front());
  into = hal::FileDescriptor();
  ChildResult result;
  result.output = read_to_end(from.number());
  const int status = hal::wait_for_child(child);
  result.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return result;
}

}  // namespace koboshi::lab
