#include "studio/document/recovery.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <sstream>
#include <system_error>
#include <utility>

#include "base/file/output_file.h"
#include "base/text/error.h"
#include "base/text/text.h"
#include "simulation/record/state_hash.h"

namespace koboshi::studio {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kMagic = "koboshi-recovery";
constexpr int kVersion = 1;
constexpr const char* kSuffix = ".recovery";
constexpr const char* kLockSuffix = ".lock";

fs::path with_suffix(const fs::path& stem, const char* suffix) { return stem.string() + suffix; }

// Returns the descriptor of the locked file; -1 if another program holds the lock.
int try_lock(const fs::path& file, int flags) {
  const int descriptor = ::open(file.c_str(), O_RDWR | O_CLOEXEC | flags, 0600);
  if (descriptor < 0) return -1;
  if (::flock(descriptor, LOCK_EX | LOCK_NB) == 0) return descriptor;
  ::close(descriptor);
  return -1;
}

bool is_open_elsewhere(const fs::path& lock_file) {
  std::error_code ignored;
  if (!fs::exists(lock_file, ignored)) return false;
  const int descriptor = try_lock(lock_file, 0);
  if (descriptor < 0) return true;
  ::close(descriptor);
  return false;
}

// The file: one line with version, hash, time and the sizes of path and text, then these two.
std::optional<Recovery> read_recovery(const fs::path& file) {
  std::string content;
  try {
    content = read_text_file(file, "a recovery file");
  } catch (const InputError&) {
    return std::nullopt;
  }
  const std::size_t line_end = content.find('\n');
  if (line_end == std::string::npos) return std::nullopt;
  std::istringstream line(content.substr(0, line_end));
  std::string magic;
  int version = 0;
  Recovery recovery{.recovery_file = file, .original = {}, .text = {}};
  std::size_t path_size = 0;
  std::size_t text_size = 0;
  line >> magic >> version >> recovery.base_hash >> recovery.time_unix_s >> path_size >> text_size;
  const std::size_t rest = content.size() - line_end - 1;
  if (!line || magic != kMagic || version != kVersion || path_size > rest || text_size != rest - path_size)
    return std::nullopt;
  recovery.original = content.substr(line_end + 1, path_size);
  recovery.text = content.substr(line_end + 1 + path_size);
  return recovery;
}

FileState state_of(const fs::path& file, std::string_view text) {
  return {.size = text.size(), .time = fs::last_write_time(file), .hash = hash_text(text)};
}

}  // namespace

std::uint64_t hash_text(std::string_view text) {
  simulation::StateHash hash;
  hash.add(std::as_bytes(std::span(text)));
  return hash.value();
}

ReadFile read_file_with_state(const fs::path& file) {
  ReadFile read{.text = read_text_file(file, "a motion file"), .state = {}};
  read.state = state_of(file, read.text);
  return read;
}

DiskChange compare_with_disk(const fs::path& file, const FileState& state) {
  std::error_code error;
  const std::uintmax_t size = fs::file_size(file, error);
  if (error) return DiskChange::kGone;
  const fs::file_time_type time = fs::last_write_time(file, error);
  if (error) return DiskChange::kGone;
  if (size == state.size && time == state.time) return DiskChange::kNone;
  if (size != state.size) return DiskChange::kChanged;
  try {
    const bool same = hash_text(read_text_file(file, "a motion file")) == state.hash;
    return same ? DiskChange::kNone : DiskChange::kChanged;
  } catch (const InputError&) {
    return DiskChange::kGone;
  }
}

fs::path default_recovery_folder() {
  const char* const state = std::getenv("XDG_STATE_HOME");
  if (state != nullptr && *state == '/') return fs::path(state) / "koboshi" / "recovery";
  const char* const home = std::getenv("HOME");
  return fs::path(home != nullptr ? home : "/") / ".local" / "state" / "koboshi" / "recovery";
}

RecoverySlot::RecoverySlot(const fs::path& folder, fs::path original) : original_(std::move(original)) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw WriteError(folder, error.value());
  constexpr int kMaxDocuments = 1000;  // with one path; more have no recovery
  for (int number = 1; number <= kMaxDocuments; ++number) {
    const fs::path stem = folder / fmt::format("{:016x}-{}", hash_text(original_.string()), number);
    file_ = with_suffix(stem, kSuffix);
    lock_file_ = with_suffix(stem, kLockSuffix);
    lock_ = try_lock(lock_file_, O_CREAT);
    if (lock_ >= 0 && !fs::exists(file_, error)) return;
    if (lock_ >= 0) ::close(lock_);  // what a crash has left is not overwritten
    if (lock_ < 0 && errno != EWOULDBLOCK) break;
    lock_ = -1;
  }
  throw WriteError(folder, errno != 0 ? errno : EEXIST);
}

RecoverySlot::~RecoverySlot() {
  std::error_code ignored;
  if (!keeps_) {
    fs::remove(file_, ignored);
    fs::remove(lock_file_, ignored);
  }
  ::close(lock_);
}

void RecoverySlot::write(std::string_view text, std::uint64_t base_hash, std::int64_t time_unix_s) {
  const std::string path = original_.string();
  write_whole_file(file_, fmt::format("{} {} {} {} {} {}\n{}{}", kMagic, kVersion, base_hash, time_unix_s,
                                      path.size(), text.size(), path, text));
}

void RecoverySlot::remove() {
  std::error_code ignored;
  fs::remove(file_, ignored);
}

std::vector<Recovery> find_recoveries(const fs::path& folder) {
  std::vector<Recovery> found;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (entry.path().extension() != kSuffix) continue;
    if (is_open_elsewhere(fs::path(entry.path()).replace_extension(kLockSuffix))) continue;
    if (auto recovery = read_recovery(entry.path())) found.push_back(std::move(*recovery));
  }
  std::ranges::sort(found, {}, &Recovery::recovery_file);
  return found;
}

void discard_recovery(const Recovery& recovery) {
  std::error_code ignored;
  fs::remove(recovery.recovery_file, ignored);
  fs::remove(fs::path(recovery.recovery_file).replace_extension(kLockSuffix), ignored);
}

}  // namespace koboshi::studio
