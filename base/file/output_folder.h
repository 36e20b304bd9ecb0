#pragma once

#include <filesystem>

namespace koboshi {

// Exclusive lock of an output folder until this object or the process ends (flock). It creates no file.
class FolderLock {
 public:
  // Throws InputError if the folder is locked by another process or by another lock in this one, and
  // std::system_error if it cannot be opened.
  explicit FolderLock(const std::filesystem::path& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int descriptor_;
};

// Throws InputError unless a run may use this folder: the path does not exist, or is an empty folder, or the
// folder of an earlier run (with summary.json, or with trace.csv and can.log of an interrupted one) without
// subfolders except `figures`. Changes nothing.
void check_output_folder(const std::filesystem::path& folder);

// The output folder of a run. Files are written in place, so a failed run leaves its records and a running
// one can be watched. Call check_output_folder together with the other input checks, and create this object
// after all of them. The folder stays locked during the lifetime of this object.
class OutputFolder {
 public:
  // Checks again, creates the folder and removes the files of an earlier run. Throws InputError or
  // std::filesystem::filesystem_error.
  explicit OutputFolder(const std::filesystem::path& folder);

 private:
  FolderLock lock_;
};

}  // namespace koboshi
