#include "base/file/output_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <system_error>

#include "base/text/error.h"

namespace koboshi {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSummary = "summary.json";
constexpr std::array kStreams{"trace.csv", "can.log"};

bool is_stream(const fs::path& file) {
  return std::ranges::find(kStreams, file.filename()) != kStreams.end();
}

bool left_by_a_run(const fs::path& folder) {
  return fs::exists(folder / kSummary) ||
         std::ranges::all_of(kStreams, [&](const char* stream) { return fs::exists(folder / stream); });
}

// Throws if the nearest existing parent is not a folder.
void check_parents(const fs::path& folder) {
  for (fs::path parent = fs::absolute(folder).parent_path(); !parent.empty(); parent = parent.parent_path()) {
    if (fs::is_directory(parent)) return;
    if (fs::exists(parent)) throw InputError(parent, 0, "a file", "a folder to make the run's folder in");
  }
}

const fs::path& checked_and_made(const fs::path& folder) {
  check_output_folder(folder);
  fs::create_directories(folder);
  return folder;
}

}  // namespace

void check_output_folder(const fs::path& folder) {
  if (folder.empty()) throw InputError(folder, 0, "an empty path", "a folder for the run");
  if (!fs::exists(folder)) return check_parents(folder);
  if (!fs::is_directory(folder)) throw InputError(folder, 0, "a file", "a folder for the run");
  if (fs::is_empty(folder)) return;
  if (!left_by_a_run(folder)) {
    throw InputError(folder, 0, "a folder with other files",
                     "a new or empty folder, or one of an earlier run");
  }
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (entry.is_directory() && entry.path().filename() != "figures") {
      throw InputError(entry.path(), 0, "a folder",
                       "nothing but an earlier run in a folder that is to be replaced");
    }
  }
}

FolderLock::FolderLock(const fs::path& folder)
    : descriptor_(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  if (descriptor_ < 0) throw std::system_error(errno, std::generic_category(), folder.string());
  if (::flock(descriptor_, LOCK_EX | LOCK_NB) == 0) return;
  const int error = errno;
  ::close(descriptor_);
  if (error != EWOULDBLOCK) throw std::system_error(error, std::generic_category(), folder.string());
  throw InputError(folder, 0, "a folder to which another run is writing", "a folder of its own for each run");
}

FolderLock::~FolderLock() { ::close(descriptor_); }

OutputFolder::OutputFolder(const fs::path& folder) : lock_(checked_and_made(folder)) {
  check_output_folder(folder);  // another process may have written between the check and the lock
  // Removes the file that marks a run as complete first, and the files that mark the folder as a run's last.
  fs::remove(folder / kSummary);
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (!is_stream(entry.path())) fs::remove_all(entry.path());
  }
  for (const char* const stream : kStreams) fs::remove(folder / stream);
}

}  // namespace koboshi
