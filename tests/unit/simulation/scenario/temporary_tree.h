#pragma once

#include <filesystem>
#include <string>

#include "tests/support/temporary_folder.h"

namespace koboshi::simulation {

// A folder of a test's own that looks like a repository, removed at its end.
class TemporaryTree {
 public:
  TemporaryTree() {
    write("robots/box/robot.sdf", "");
    write("robots/box/motions/squat.yaml", "");
    write("robots/box/motions/bow.yaml", "");
    std::filesystem::create_directories(root() / "scenarios");
  }

  std::filesystem::path write(const std::filesystem::path& file, const std::string& text) const {
    std::filesystem::create_directories((root() / file).parent_path());
    koboshi::test::write_file(root() / file, text);
    return root() / file;
  }
  const std::filesystem::path& root() const { return folder_.path; }

 private:
  koboshi::test::TemporaryFolder folder_;
};

}  // namespace koboshi::simulation
