#pragma once

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

namespace koboshi::tools {

// Two runs' folders, A and B, that a test fills.
class RunFiles : public ::testing::Test {
 protected:
  RunFiles() {
    std::filesystem::create_directories(a());
    std::filesystem::create_directories(b());
  }
  ~RunFiles() override { std::filesystem::remove_all(root_); }

  std::filesystem::path a() const { return root_ / "a"; }
  std::filesystem::path b() const { return root_ / "b"; }
  static void write(const std::filesystem::path& file, const std::string& text) {
    std::ofstream(file) << text;
  }

 private:
  std::filesystem::path root_ =
      std::filesystem::temp_directory_path() / ("koboshi_diff_" + std::to_string(getpid()));
};

}  // namespace koboshi::tools
