#include "tools/robot_file/reference/reference.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <string>

// Page and schemas of docs/reference hold the range of each number of a robot's file: one that moves is
// noticed here.
namespace koboshi::tools {
namespace {

TEST(RobotReference, IsThatOfTheRepository) {
  std::set<std::string> names;
  for (const RobotReferenceFile& file : robot_reference_files()) {
    names.insert(file.name);
    std::ifstream kept(std::filesystem::path(KOBOSHI_SOURCE_DIR) / "docs/reference" / file.name);
    const std::string text{std::istreambuf_iterator<char>(kept), {}};
    EXPECT_TRUE(text == file.text) << file.name << " differs; koboshi model reference write";
  }
  EXPECT_EQ(names, (std::set<std::string>{"robot-file.md", "robot.xsd", "robot-koboshi.xsd"}));
}

}  // namespace
}  // namespace koboshi::tools
