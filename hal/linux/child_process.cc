#include "hal/linux/child_process.h"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

extern char** environ;

namespace koboshi::hal {

int spawn(const std::vector<std::string>& arguments, const ChildSetup& setup, pid_t& child) {
  std::vector<std::string> texts = arguments;
  std::vector<char*> pointers;
  for (std::string& text : texts) pointers.push_back(text.data());
  pointers.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  for (const auto& [from, to] : {std::pair{setup.input, STDIN_FILENO}, std::pair{setup.output, STDOUT_FILENO},
                                 std::pair{setup.errors, STDERR_FILENO}}) {
    if (from >= 0) posix_spawn_file_actions_adddup2(&actions, from, to);
  }
  if (!setup.directory.empty()) posix_spawn_file_actions_addchdir_np(&actions, setup.directory.c_str());
  const int error = posix_spawnp(&child, pointers.front(), &actions, nullptr, pointers.data(),
                                 setup.environment != nullptr ? setup.environment : environ);
  posix_spawn_file_actions_destroy(&actions);
  return error;
}

int wait_for_child(pid_t child) {
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return status;
}

}  // namespace koboshi::hal
