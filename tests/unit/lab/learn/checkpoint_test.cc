#include "lab/learn/checkpoint.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/text/error.h"
#include "tests/support/temporary_folder.h"

namespace koboshi::lab {
namespace {

using ::testing::HasSubstr;

Checkpoint sample() {
  Checkpoint checkpoint;
  checkpoint.inputs = "0123456789abcdef";
  checkpoint.search = {.generation = 12,
                       .steps = 480,
                       .mean = {0.1, 1.0 / 3.0, -5e-324},
                       .first_moment = {1e308, -0.0, 2.0},
                       .second_moment = {0.7, 0.07, 0.007}};
  checkpoint.stage = 1;
  checkpoint.survived = {0.25, 1.0};
  checkpoint.validations = {{.generation = 0, .reward = -0.1},
                            {.generation = 10, .reward = 0.3, .lean_rad2 = 0.02}};
  checkpoint.best = 1;
  checkpoint.best_weights = {0.2, 0.3, 1.0 / 7.0};
  checkpoint.log_bytes = 4711;
  return checkpoint;
}

class CheckpointFile : public testing::Test {
 protected:
  std::string refusal(const std::string& text) const {
    test::write_file(file_, text);
    try {
      static_cast<void>(read_checkpoint(file_));
    } catch (const InputError& error) {
      return error.what();
    }
    return "nothing";
  }

  test::TemporaryFolder folder_;
  std::filesystem::path file_ = folder_.path / "state.json";
};

TEST_F(CheckpointFile, KeepsEveryBit) {
  const Checkpoint written = sample();
  write_checkpoint(file_, written);
  const auto read = read_checkpoint(file_);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->inputs, written.inputs);
  EXPECT_EQ(read->search.generation, 12u);
  EXPECT_EQ(read->search.steps, 480u);
  EXPECT_EQ(read->search.mean, written.search.mean);
  EXPECT_EQ(read->search.first_moment, written.search.first_moment);
  EXPECT_EQ(read->search.second_moment, written.search.second_moment);
  EXPECT_EQ(read->stage, 1u);
  EXPECT_EQ(read->survived, written.survived);
  EXPECT_EQ(read->validations, written.validations);
  EXPECT_EQ(read->best, 1u);
  EXPECT_EQ(read->best_weights, written.best_weights);
  EXPECT_EQ(read->log_bytes, 4711u);
}

TEST_F(CheckpointFile, IsNotThereBeforeTheFirst) { EXPECT_FALSE(read_checkpoint(file_)); }

TEST_F(CheckpointFile, RefusesWhatIsNoneWithOneLine) {
  EXPECT_THAT(refusal(""), HasSubstr("state.json: found"));
  EXPECT_THAT(refusal("{\"version\": 2}"), HasSubstr("expected the state of a training"));
  EXPECT_THAT(refusal("{\"version\": 1}"), HasSubstr("state.json: found version 1, expected 2"));
  EXPECT_THAT(refusal("[1]"), HasSubstr("state.json: found"));
}

TEST_F(CheckpointFile, RefusesListsThatDoNotFit) {
  Checkpoint checkpoint = sample();
  checkpoint.best_weights.assign(4, 0.0);
  write_checkpoint(file_, checkpoint);
  EXPECT_THROW(static_cast<void>(read_checkpoint(file_)), InputError);
  checkpoint = sample();
  checkpoint.best = 2;
  write_checkpoint(file_, checkpoint);
  EXPECT_THROW(static_cast<void>(read_checkpoint(file_)), InputError);
}

}  // namespace
}  // namespace koboshi::lab
