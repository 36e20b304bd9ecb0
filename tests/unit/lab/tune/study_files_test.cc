#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lab/tune/study_search.h"

namespace koboshi::lab {
namespace {

TEST(StudyFiles, ListTheFilesOfEveryTrialOnce) {
  Study study;
  study.file = "walk.yaml";
  simulation::Scenario calm;
  calm.file = "go.yaml";
  calm.robot = "robot.sdf";
  simulation::Scenario rough = calm;
  rough.motions = {{.file = "bow.yaml"}};
  rough.parameter_file = "parameters.yaml";
  EXPECT_THAT(study_files(study, std::vector{calm, rough}),
              testing::ElementsAre("walk.yaml", "go.yaml", "robot.sdf", "bow.yaml", "parameters.yaml"));
}

}  // namespace
}  // namespace koboshi::lab
