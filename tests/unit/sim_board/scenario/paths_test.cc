#include "sim_board/scenario/paths.h"

#include <gtest/gtest.h>

#include "tests/unit/sim_board/scenario/temporary_tree.h"

namespace koboshi::sim {
namespace {

TEST(RepositoryRoot, IsTheNearestParentWithRobotsAndScenarios) {
  const TemporaryTree tree;
  tree.write("scenarios/deep/down/a.yaml", "");
  EXPECT_EQ(repository_root(tree.root() / "scenarios/deep/down"), tree.root());
  EXPECT_EQ(repository_root(tree.root()), tree.root());
}

TEST(RepositoryRoot, IsSearchedFromTheWorkingFolderForABareFileName) {
  const TemporaryTree tree;
  const auto before = std::filesystem::current_path();
  std::filesystem::current_path(tree.root() / "scenarios");
  EXPECT_EQ(repository_root(""), tree.root());
  EXPECT_EQ(find_referenced("", "robots/box/robot.sdf"), tree.root() / "robots/box/robot.sdf");
  std::filesystem::current_path(before);
}

TEST(RepositoryRoot, IsTheSourceFolderOfTheBuildOtherwise) {
  EXPECT_EQ(repository_root("/"), KOBOSHI_SOURCE_DIR);
}

TEST(ReferencedFile, IsFirstSearchedBesideTheScenario) {
  const TemporaryTree tree;
  const auto beside = tree.write("scenarios/robots/box/robot.sdf", "");
  EXPECT_EQ(find_referenced(tree.root() / "scenarios", "robots/box/robot.sdf"), beside);
  std::filesystem::remove(beside);
  EXPECT_EQ(find_referenced(tree.root() / "scenarios", "robots/box/robot.sdf"),
            tree.root() / "robots/box/robot.sdf");
}

TEST(ReferencedFile, MayBeOutsideTheFolderOrAbsolute) {
  const TemporaryTree tree;
  const auto robot = tree.root() / "robots/box/robot.sdf";
  EXPECT_EQ(find_referenced(tree.root() / "scenarios", "../robots/box/robot.sdf"), robot);
  EXPECT_EQ(find_referenced("/", robot), robot);
}

TEST(ReferencedFile, IsEmptyWithoutAReference) {
  const TemporaryTree tree;
  EXPECT_TRUE(find_referenced(tree.root(), "robots/box/other.sdf").empty());
  EXPECT_TRUE(find_referenced(tree.root(), "robots/box").empty()) << "a folder is no file";
}

}  // namespace
}  // namespace koboshi::sim
