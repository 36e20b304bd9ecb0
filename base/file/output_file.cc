#include "base/file/output_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <string>
#include <utility>

#include "base/text/error.h"

namespace koboshi {
namespace {

namespace fs = std::filesystem;

int open_to_write(const fs::path& file, int more_flags) {
  const int descriptor = ::open(file.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | more_flags, 0666);
  if (descriptor < 0) throw WriteError(file, errno);
  return descriptor;
}

// Returns the number of bytes written; if it is less than requested, errno gives the reason.
std::size_t write_bytes(int descriptor, std::string_view bytes) {
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t written = ::write(descriptor, bytes.data() + done, bytes.size() - done);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) break;
    done += static_cast<std::size_t>(written);
  }
  return done;
}

// Truncates the file after the last line feed of `written`. Files that cannot be truncated, such as pipes,
// stay as they are.
void cut_off_last_row(int descriptor, std::string_view written) {
  const std::size_t whole = written.rfind('\n') + 1;  // if there is none: npos + 1 is 0
  const off_t end = ::lseek(descriptor, 0, SEEK_CUR);
  if (end < 0) return;
  static_cast<void>(!::ftruncate(descriptor, end - static_cast<off_t>(written.size() - whole)));
}

bool is_special(const fs::path& file) {
  struct stat status {};
  return ::stat(file.c_str(), &status) == 0 && !S_ISREG(status.st_mode);
}

void write_and_close(int descriptor, const fs::path& file, std::string_view text) {
  const bool complete = write_bytes(descriptor, text) == text.size();
  const int error = complete ? 0 : errno;
  if (::close(descriptor) != 0 && complete) throw WriteError(file, errno);
  if (!complete) throw WriteError(file, error);
}

// Replaces the contents in place: the inode keeps its names, owner, mode and attributes. Reserves the space
// first, so that a full disk leaves the file as it was.
void overwrite(const fs::path& target, const fs::path& file, std::string_view text) {
  const int descriptor = open_to_write(target, 0);
  const auto size = static_cast<off_t>(text.size());
  struct stat old {};
  int error = ::fstat(descriptor, &old) == 0 ? 0 : errno;
  if (error == 0 && size > old.st_size) {
    error = ::posix_fallocate(descriptor, old.st_size, size - old.st_size);
    if (error != 0) static_cast<void>(!::ftruncate(descriptor, old.st_size));
  }
  if (error == 0 && (write_bytes(descriptor, text) != text.size() || ::ftruncate(descriptor, size) != 0))
    error = errno;
  if (::close(descriptor) != 0 && error == 0) error = errno;
  if (error != 0) throw WriteError(file, error);
}

// A new file in the folder of another one.
struct Beside {
  fs::path path;
  int descriptor = -1;  // below 0: errno gives the reason
};

// Opens a file of a name that is free. With `old`, it gets the owner and the mode of that file.
Beside open_beside(const fs::path& target, const struct stat* old) {
  constexpr int kMaxLeftBehind = 100;  // by programs that were killed
  Beside beside;
  for (int i = 1; beside.descriptor < 0 && i <= kMaxLeftBehind; ++i) {
    beside.path = target;
    beside.path += i == 1 ? ".part" : ".part" + std::to_string(i);
    beside.descriptor = ::open(beside.path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC,
                               old != nullptr ? mode_t{0600} : mode_t{0666});
    if (beside.descriptor < 0 && errno != EEXIST) return beside;
  }
  if (beside.descriptor < 0 || old == nullptr) return beside;
  // fchown() clears the set-user-ID bit, so it comes first.
  if (::fchown(beside.descriptor, old->st_uid, old->st_gid) == 0 &&
      ::fchmod(beside.descriptor, old->st_mode & 07777) == 0)
    return beside;
  const int error = errno;
  ::close(beside.descriptor);
  ::unlink(beside.path.c_str());
  errno = error;
  beside.descriptor = -1;
  return beside;
}

}  // namespace

OutputFile::OutputFile(const fs::path& file, Mode mode)
    : file_(file), descriptor_(open_to_write(file, mode == Mode::kAppend ? O_APPEND : O_TRUNC)) {
  if (mode == Mode::kAppend && ::flock(descriptor_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    ::close(descriptor_);
    throw InputError(file, 0, "a file to which another run is writing", "a file of its own for each run");
  }
  buffer_.reserve(kBuffer_bytes);
}

OutputFile::~OutputFile() {
  if (descriptor_ < 0) return;
  try {
    flush();
  } catch (const WriteError&) {
  }
  ::close(descriptor_);
}

void OutputFile::write(std::string_view rows) {
  if (buffer_.size() + rows.size() > kBuffer_bytes) flush();
  buffer_ += rows;
}

void OutputFile::flush() {
  const std::size_t written = write_bytes(descriptor_, buffer_);
  if (written == buffer_.size()) return buffer_.clear();
  const int error = errno;
  cut_off_last_row(descriptor_, std::string_view(buffer_).substr(0, written));
  buffer_.clear();
  throw WriteError(file_, error);
}

void OutputFile::close() {
  flush();
  if (::close(std::exchange(descriptor_, -1)) != 0) throw WriteError(file_, errno);
}

void write_whole_file(const fs::path& file, std::string_view text) {
  if (is_special(file)) return write_and_close(open_to_write(file, 0), file, text);
  std::error_code ignored;
  const fs::path target = fs::is_symlink(file, ignored) ? fs::weakly_canonical(file) : file;
  struct stat old {};
  const bool exists = ::stat(target.c_str(), &old) == 0;
  // A read-only file stays as it is, although its folder would permit to replace it.
  if (exists && ::access(target.c_str(), W_OK) != 0) throw WriteError(file, errno);
  if (exists && old.st_nlink > 1) return overwrite(target, file, text);
  const Beside beside = exists ? open_beside(target, &old) : open_beside(target, nullptr);
  if (beside.descriptor < 0) {
    const int error = errno;
    if (exists) return overwrite(target, file, text);
    throw WriteError(file, error);
  }
  try {
    write_and_close(beside.descriptor, file, text);
    if (std::rename(beside.path.c_str(), target.c_str()) != 0) throw WriteError(file, errno);
  } catch (...) {
    fs::remove(beside.path, ignored);
    throw;
  }
}

}  // namespace koboshi
