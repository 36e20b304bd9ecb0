#include "simulation/scenario/paths.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>

#include <string>

#include "base/text/error.h"
#include "base/yaml/yaml_reader.h"
#include "tests/unit/simulation/scenario/temporary_tree.h"

namespace koboshi::simulation {
namespace {

namespace fs = std::filesystem;

// The working folder and the user's data of a test, back as before at its end.
class InputPath : public testing::Test {
 protected:
  InputPath() {
    // A repository of its own, because that of the sources may be around it.
    for (const char* folder : {"robots", "scenarios"}) fs::create_directories(here_.path / folder);
    fs::current_path(here_.path);
    setenv("XDG_DATA_HOME", user_.path.c_str(), 1);
  }
  ~InputPath() override {
    fs::current_path(before_);
    unsetenv("XDG_DATA_HOME");
  }

  static void write(const fs::path& file, const std::string& text = {}) {
    if (file.has_parent_path()) fs::create_directories(file.parent_path());
    test::write_file(file, text);
  }
  static std::string refusal(InputKind kind, const fs::path& given) {
    try {
      static_cast<void>(find_input(kind, given));
    } catch (const InputError& error) {
      return error.what();
    }
    return {};
  }
  fs::path user() const { return user_.path / "koboshi"; }

  const fs::path before_ = fs::current_path();
  test::TemporaryFolder here_;
  test::TemporaryFolder user_;
};

TEST_F(InputPath, OfAnExistingFileWins) {
  write("walk");
  write("scenarios/walk.yaml");
  EXPECT_EQ(find_input(InputKind::kScenario, "walk"), "walk");
  EXPECT_EQ(find_input(InputKind::kScenario, "scenarios/walk.yaml"), "scenarios/walk.yaml");
}

TEST_F(InputPath, OfANameIsSearchedHereThenInTheUsersDataThenInThePrograms) {
  EXPECT_EQ(find_input(InputKind::kScenario, "walk"), data_folder() / "scenarios/walk.yaml");
  write(user() / "scenarios/walk.yaml");
  EXPECT_EQ(find_input(InputKind::kScenario, "walk"), user() / "scenarios/walk.yaml");
  write("scenarios/walk.yaml");
  EXPECT_EQ(find_input(InputKind::kScenario, "walk"), "scenarios/walk.yaml");
}

TEST_F(InputPath, OfANameIsAlsoSearchedInTheRepositoryAroundTheWorkingFolder) {
  write("scenarios/own.yaml");
  fs::create_directories("robots/deep");
  fs::current_path("robots/deep");
  EXPECT_EQ(find_input(InputKind::kScenario, "own"), here_.path / "scenarios/own.yaml");
}

TEST_F(InputPath, OfANameDependsOnTheKind) {
  EXPECT_EQ(find_input(InputKind::kRobot, "koboshi"), data_folder() / "robots/koboshi/robot.sdf");
  EXPECT_EQ(find_input(InputKind::kGait, "koboshi"), data_folder() / "robots/koboshi/gait.yaml");
  EXPECT_EQ(find_input(InputKind::kStudy, "walk"), data_folder() / "studies/walk.yaml");
  write("robots/box/robot.urdf");
  EXPECT_EQ(find_input(InputKind::kRobot, "box"), "robots/box/robot.urdf");
}

TEST_F(InputPath, OfANameMayHaveTheExtension) {
  EXPECT_EQ(find_input(InputKind::kScenario, "walk.yaml"), data_folder() / "scenarios/walk.yaml");
}

TEST_F(InputPath, OfAFolderIsNoName) {
  fs::create_directories("walk");
  EXPECT_EQ(find_input(InputKind::kScenario, "walk"), data_folder() / "scenarios/walk.yaml");
}

// A program may be called as a robot is.
TEST_F(InputPath, OfARobotsNameGoesBeforeAFileWithoutExtension) {
  write("koboshi");
  write("note");
  EXPECT_EQ(find_input(InputKind::kRobot, "koboshi"), data_folder() / "robots/koboshi/robot.sdf");
  EXPECT_EQ(find_input(InputKind::kRobot, "note"), "note");
}

TEST_F(InputPath, IsSearchedInTheSameFoldersIfItIsRelative) {
  EXPECT_EQ(find_input(InputKind::kScenario, "scenarios/walk.yaml"), data_folder() / "scenarios/walk.yaml");
  EXPECT_EQ(find_path("robots/koboshi/gaits"), data_folder() / "robots/koboshi/gaits");
}

TEST_F(InputPath, ThatIsNotFoundIsLeftToItsReader) {
  EXPECT_EQ(find_input(InputKind::kScenario, "scenarios/wakl.yaml"), "scenarios/wakl.yaml");
  EXPECT_EQ(find_input(InputKind::kScenario, ""), "");
  const std::string long_name = std::string(5000, 'a') + "/b";
  EXPECT_EQ(find_input(InputKind::kScenario, long_name), long_name);
}

TEST_F(InputPath, OfAnUnknownNameIsRefusedWithTheFoldersAndTheNearestName) {
  const std::string text = refusal(InputKind::kScenario, "wakl");
  EXPECT_THAT(text, testing::StartsWith(
                        "wakl: found no such file, and no scenario of this name in ./scenarios, " +
                        (user() / "scenarios").string() + " or " + (data_folder() / "scenarios").string() +
                        ", expected the path of a scenario or its name: board, "));
  EXPECT_THAT(text, testing::EndsWith("; the nearest is walk"));
}

TEST_F(InputPath, OfAMotionBelongsToTheRobot) {
  write("robots/box/robot.sdf");
  write("robots/box/motions/bow.yaml");
  EXPECT_EQ(find_motion("bow", "robots/box/robot.sdf"), "robots/box/motions/bow.yaml");
  EXPECT_EQ(find_motion("robots/box/motions", "robots/box/robot.sdf"), "robots/box/motions");
  EXPECT_THROW(static_cast<void>(find_motion("squat", "robots/box/robot.sdf")), InputError);
  write("squat.yaml");
  EXPECT_EQ(find_motion("squat.yaml", "robots/box/robot.sdf"), "squat.yaml");
}

TEST_F(InputPath, NamesAreThoseOfAllFolders) {
  write("scenarios/own.yaml");
  write(user() / "scenarios/another.yaml");
  EXPECT_THAT(input_names(InputKind::kScenario), testing::IsSupersetOf({"another", "own", "walk"}));
  EXPECT_THAT(input_names(InputKind::kRobot), testing::IsSupersetOf({"chibi", "hanpo", "koboshi", "noppo"}));
}

TEST_F(InputPath, NamesAreOfFilesOfTheirKindOnly) {
  for (const char* file :
       {"scenarios/own.yaml", "scenarios/own.csv", "scenarios/notes.txt", "studies/push.yaml",
        "studies/push.md", "studies/learn/run.yaml", "robots/box/robot.sdf", "robots/ball/robot.urdf",
        "robots/mesh/box.stl", "robots/box/motions/nod.yaml", "robots/box/motions/bow.yaml",
        "robots/box/motions/bow.kmot", "robots/box/motions/notes.txt"})
    write(file);
  const auto scenarios = input_names(InputKind::kScenario);
  EXPECT_THAT(scenarios, testing::Contains("own"));
  EXPECT_THAT(scenarios, testing::Not(testing::Contains("notes")));
  const auto robots = input_names(InputKind::kRobot);
  EXPECT_THAT(robots, testing::IsSupersetOf({"ball", "box"}));
  EXPECT_THAT(robots, testing::Not(testing::Contains("mesh")));
  EXPECT_THAT(input_names(InputKind::kStudy), testing::Contains("push"));
  EXPECT_THAT(input_names(InputKind::kStudy), testing::Not(testing::Contains("run")));
  EXPECT_THAT(robot_motion_names("robots/box/robot.sdf"), testing::ElementsAre("bow", "nod"));
  EXPECT_THAT(robot_motion_names("robots/ball/robot.urdf"), testing::IsEmpty());
}

TEST(RepositoryRoot, IsTheNearestParentWithRobotsAndScenarios) {
  const TemporaryTree tree;
  tree.write("scenarios/deep/down/a.yaml", "");
  EXPECT_EQ(repository_root(tree.root() / "scenarios/deep/down"), tree.root());
  EXPECT_EQ(repository_root(tree.root()), tree.root());
}

TEST(RepositoryRoot, IsSearchedFromTheWorkingFolderForABareFileName) {
  const TemporaryTree tree;
  const auto before = fs::current_path();
  fs::current_path(tree.root() / "scenarios");
  EXPECT_EQ(repository_root(""), tree.root());
  EXPECT_EQ(find_referenced("", "robots/box/robot.sdf"), tree.root() / "robots/box/robot.sdf");
  fs::current_path(before);
}

TEST(RepositoryRoot, IsTheSourceFolderOfTheBuildOtherwise) {
  EXPECT_EQ(repository_root("/"), KOBOSHI_SOURCE_DIR);
}

TEST(ReferencedFile, IsFirstSearchedBesideTheScenario) {
  const TemporaryTree tree;
  const auto beside = tree.write("scenarios/robots/box/robot.sdf", "");
  EXPECT_EQ(find_referenced(tree.root() / "scenarios", "robots/box/robot.sdf"), beside);
  fs::remove(beside);
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

TEST(NamedInput, OfAScenarioGoesBeforeAFileWithoutExtension) {
  const TemporaryTree tree;
  const auto robot = tree.write("robots/box/robot.sdf", "");
  const auto motion = tree.write("robots/box/motions/bow.yaml", "");
  tree.write("box", "a program");
  tree.write("bow", "a program");
  const YamlFile yaml(tree.write("scenarios/own.yaml", "robot: box\nmotion: bow\n"));
  const YamlMap root = yaml.root();
  EXPECT_EQ(read_input(root.value("robot"), tree.root() / "scenarios", InputKind::kRobot), robot);
  EXPECT_EQ(read_robot_file(root.value("motion"), tree.root() / "scenarios", robot, "motions"), motion);
}

}  // namespace
}  // namespace koboshi::simulation
