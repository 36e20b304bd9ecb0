#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tools/lab/tune/study_search.h"

namespace koboshi::tools {
namespace {

TEST(StudyFiles, ListTheFilesOfEveryTrialOnce) {
  Study study;
  study.file = "walk.yaml";
  sim::Scenario calm;
  calm.file = "go.yaml";
  calm.robot = "robot.sdf";
  sim::Scenario rough = calm;
  rough.motions = {{.file = "bow.yaml"}};
  rough.parameter_file = "parameters.yaml";
  EXPECT_THAT(study_files(study, std::vector{calm, rough}),
              testing::ElementsAre("walk.yaml", "go.yaml", "robot.sdf", "bow.yaml", "parameters.yaml"));
}

}  // namespace
}  // namespace koboshi::tools
