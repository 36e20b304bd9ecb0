#pragma once

#include <filesystem>
#include <string>

#include "tests/support/temporary_folder.h"

namespace koboshi {

// A file of the running test's own, gone with the object.
class ScratchFile {
 public:
  ScratchFile(const std::string& name, const std::string& text) : path_(folder_.path / name) {
    koboshi::test::write_file(path_, text);
  }

  const std::filesystem::path& path() const { return path_; }

 private:
  koboshi::test::TemporaryFolder folder_;
  std::filesystem::path path_;
};

}  // namespace koboshi
