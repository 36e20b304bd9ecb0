#include "sim_board/record/output_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <utility>

#include "sim_board/input/error.h"

namespace koboshi::sim {
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
  fs::path beside = target;
  beside += ".part";
  try {
    write_and_close(open_to_write(beside, O_TRUNC), file, text);
    if (std::rename(beside.c_str(), target.c_str()) != 0) throw WriteError(file, errno);
  } catch (...) {
    fs::remove(beside, ignored);
    throw;
  }
}

}  // namespace koboshi::sim
