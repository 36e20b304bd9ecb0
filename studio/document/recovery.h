#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace koboshi::studio {

// XXH3, 64 bits.
[[nodiscard]] std::uint64_t hash_text(std::string_view text);

// State of a file on disk, to notice changes by other programs.
struct FileState {
  std::uint64_t size = 0;
  std::filesystem::file_time_type time;
  std::uint64_t hash = 0;
};

// Reads a file and its state. Throws InputError.
struct ReadFile {
  std::string text;
  FileState state;
};
[[nodiscard]] ReadFile read_file_with_state(const std::filesystem::path& file);

enum class DiskChange { kNone, kChanged, kGone };

// Compares a file with an earlier state. Reads it only if its size or time differ; a file that was only
// touched has not changed.
[[nodiscard]] DiskChange compare_with_disk(const std::filesystem::path& file, const FileState& state);

// The contents of a recovery file. The original has changed since if its text has another hash.
struct Recovery {
  std::filesystem::path recovery_file;
  std::filesystem::path original;  // absolute; empty: never saved
  std::uint64_t base_hash = 0;     // of the original when it was read or saved last; 0: never saved
  std::int64_t time_unix_s = 0;    // when the recovery was written
  std::string text;
};

// $XDG_STATE_HOME/koboshi/recovery, by default ~/.local/state/koboshi/recovery.
[[nodiscard]] std::filesystem::path default_recovery_folder();

// Keeps the text of one open document in a file of a folder, for the time after a crash. A lock file beside
// it says that the document is open; the system releases the lock when the program ends, in whatever way.
class RecoverySlot {
 public:
  // `original`: absolute path; empty for a document that was never saved. Creates the folder. Throws
  // WriteError.
  RecoverySlot(const std::filesystem::path& folder, std::filesystem::path original);
  // Removes the recovery: the document was closed cleanly.
  ~RecoverySlot();
  RecoverySlot(const RecoverySlot&) = delete;
  RecoverySlot& operator=(const RecoverySlot&) = delete;

  // Replaces the recovery atomically. Throws WriteError.
  void write(std::string_view text, std::uint64_t base_hash, std::int64_t time_unix_s);
  // Removes it: the document is saved.
  void remove();
  // Keeps the recovery when the slot ends, as a crash would.
  void keep() { keeps_ = true; }

 private:
  std::filesystem::path original_;
  std::filesystem::path file_;
  std::filesystem::path lock_file_;
  int lock_ = -1;
  bool keeps_ = false;
};

// Returns the recoveries of documents that no program has open, by path. Damaged files are left out.
[[nodiscard]] std::vector<Recovery> find_recoveries(const std::filesystem::path& folder);
// Removes a recovery that the user has restored or refused.
void discard_recovery(const Recovery& recovery);

}  // namespace koboshi::studio
