#include "tools/robot_file/reference/reference.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <set>
#include <string>

#include "base/text/text.h"

// The page and the schemas in docs/reference state the range of each number of a robot's file, so that this
// test notices a changed range.
namespace koboshi::tools {
namespace {

TEST(RobotReference, IsThatOfTheRepository) {
  std::set<std::string> names;
  for (const RobotReferenceFile& file : robot_reference_files()) {
    names.insert(file.name);
    const auto kept = std::filesystem::path(KOBOSHI_SOURCE_DIR) / "docs/reference" / file.name;
    EXPECT_TRUE(read_text_file(kept, "a page or a schema") == file.text)
        << file.name << " differs; koboshi model reference write";
  }
  EXPECT_EQ(names, (std::set<std::string>{"robot-file.md", "robot.xsd", "robot-koboshi.xsd"}));
}

}  // namespace
}  // namespace koboshi::tools
