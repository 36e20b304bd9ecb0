#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "tests/support/temporary_folder.h"

namespace koboshi::tools {

// Two runs' folders, A and B, that a test fills.
class RunFiles : public ::testing::Test {
 protected:
  RunFiles() {
    std::filesystem::create_directories(a());
    std::filesystem::create_directories(b());
  }

  std::filesystem::path a() const { return folder_.path / "a"; }
  std::filesystem::path b() const { return folder_.path / "b"; }
  static void write(const std::filesystem::path& file, const std::string& text) {
    koboshi::test::write_file(file, text);
  }

 private:
  koboshi::test::TemporaryFolder folder_;
};

}  // namespace koboshi::tools
