#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "tests/support/temporary_folder.h"
#include "tools/robot_file/check/model_check.h"

namespace koboshi::tools {

// A copy of the default robot's file beside its meshes, in which tests plant faults.
class PlantedRobotTest : public testing::Test {
 protected:
  PlantedRobotTest() {
    std::filesystem::create_directory_symlink(source() / "meshes", folder_.path / "meshes");
    std::filesystem::create_directory_symlink(source().parent_path() / "servos", folder_.path / "servos");
  }

  static std::filesystem::path source() { return KOBOSHI_SOURCE_DIR "/robots/koboshi"; }

  // Replaces a text that follows another one.
  void plant(const std::string& after, const std::string& before, const std::string& text) {
    const std::size_t start = text_.find(after);
    ASSERT_NE(start, std::string::npos) << after;
    const std::size_t place = text_.find(before, start);
    ASSERT_NE(place, std::string::npos) << before;
    text_.replace(place, before.size(), text);
    line_ = 1 + static_cast<int>(
                    std::count(text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(place), '\n'));
  }

  // The finding with this code; the test fails without one, and with one of another code.
  ModelFinding finding(const std::string& code) {
    const ModelReport report = check();
    for (const ModelFinding& one : report.findings) EXPECT_EQ(one.code, code) << one.found;
    if (report.findings.empty()) {
      ADD_FAILURE() << "no finding";
      return {};
    }
    EXPECT_GT(report.findings.front().line, 0);
    return report.findings.front();
  }

  ModelReport check() { return checker_.check(file_, text_); }

  static bool has(const ModelReport& report, const std::string& code) {
    return std::ranges::any_of(report.findings, [&](const ModelFinding& one) { return one.code == code; });
  }

  test::TemporaryFolder folder_;
  std::filesystem::path file_ = folder_.path / "robot.sdf";
  std::string text_ = test::read_file(source() / "robot.sdf");
  int line_ = 0;  // of the last planted fault
  ModelChecker checker_;
};

}  // namespace koboshi::tools
