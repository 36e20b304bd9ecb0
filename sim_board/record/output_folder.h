#pragma once

#include <filesystem>

namespace koboshi::sim {

// Locks a folder for whoever writes to it, until the end of this object or of the process (flock). No file is
// left behind.
class FolderLock {
 public:
  // Throws InputError when another process holds it, or another lock in this one; std::system_error when the
  // folder cannot be opened.
  explicit FolderLock(const std::filesystem::path& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int descriptor_;
};

// Throws InputError unless a run may write there: the path is free, or an empty folder, or one that an
// earlier run left (with summary.json, or with the trace.csv and can.log of one that was cut short) and that
// has no folder in it but `figures`. Touches nothing.
void check_output_folder(const std::filesystem::path& folder);

// The folder of a run. It is written in place, so that a run that fails leaves what it recorded and a running
// one can be watched. Check it with all other input, before anything is computed; make it when all input has
// proved good. It stays locked as long as this object lives.
class OutputFolder {
 public:
  // Checks again, makes the folder, and empties it of the earlier run. Throws InputError or
  // std::filesystem::filesystem_error.
  explicit OutputFolder(const std::filesystem::path& folder);

 private:
  FolderLock lock_;
};

}  // namespace koboshi::sim
