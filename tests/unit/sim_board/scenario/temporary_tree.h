#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace koboshi::sim {

// A folder of a test's own that looks like a repository, removed at its end.
class TemporaryTree {
 public:
  TemporaryTree() {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    root_ = std::filesystem::temp_directory_path() / ("koboshi_" + std::string(test->test_suite_name()) +
                                                      "_" + test->name() + "_" + std::to_string(getpid()));
    write("robots/box/robot.sdf", "");
    write("robots/box/motions/squat.yaml", "");
    write("robots/box/motions/bow.yaml", "");
    std::filesystem::create_directories(root_ / "scenarios");
  }
  ~TemporaryTree() { std::filesystem::remove_all(root_); }
  TemporaryTree(const TemporaryTree&) = delete;
  TemporaryTree& operator=(const TemporaryTree&) = delete;

  std::filesystem::path write(const std::filesystem::path& file, const std::string& text) const {
    std::filesystem::create_directories((root_ / file).parent_path());
    std::ofstream(root_ / file) << text;
    return root_ / file;
  }
  const std::filesystem::path& root() const { return root_; }

 private:
  std::filesystem::path root_;
};

}  // namespace koboshi::sim
