#include "lab/cluster/scripts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/text/error.h"
#include "base/text/shell_word.h"
#include "lab/cluster/child.h"

namespace koboshi::lab {
namespace {

using ::testing::HasSubstr;

const ScriptSetup kSetup{"/opt/koboshi",
                         "/data/my runs/wide",
                         "/home/it's",
                         {"experiment", "terrain", "--set", "commands.2.walk={left_m_per_s: 0.1}"},
                         12,
                         2};

TEST(ShellWord, IsOneWordOfAShell) {
  for (const std::string text : {"plain", "", "two words", "it's", "$HOME `id` \"x\" \\ *", "a\nb"}) {
    const ChildResult echoed =
        run_child({"sh", "-c", "printf %s " + shell_word(text)}, ChildOutput::kCaptured, "a shell");
    EXPECT_EQ(echoed.output, text);
  }
}

TEST(ShardScript, PlaysTheShardOfItsArgument) {
  EXPECT_THAT(
      shard_script(kSetup),
      HasSubstr(
          "cd '/home/it'\\''s' && exec /opt/koboshi experiment terrain --set "
          "'commands.2.walk={left_m_per_s: 0.1}' --out '/data/my runs/wide' --jobs 2 --shard \"$1/12\""));
}

TEST(SlurmScript, IsAnArrayOfShards) {
  const std::string script = slurm_script(kSetup, {"--time=60"});
  EXPECT_THAT(script, HasSubstr("#SBATCH --array=1-12\n"));
  EXPECT_THAT(script, HasSubstr("#SBATCH --cpus-per-task=2\n"));
  EXPECT_THAT(script, HasSubstr("#SBATCH --output=\"/data/my runs/wide/slurm-%a.log\"\n"));
  EXPECT_THAT(script, HasSubstr("#SBATCH --time=60\n"));
  EXPECT_THAT(script, HasSubstr("exec sh '/data/my runs/wide/shard.sh' \"$SLURM_ARRAY_TASK_ID\"\n"));
}

TEST(ParallelScript, ResumesFromItsLog) {
  const std::string script = parallel_script(kSetup, "4/a,:");
  EXPECT_THAT(script, HasSubstr("seq 1 12 | parallel"));
  EXPECT_THAT(script,
              HasSubstr("--sshlogin 4/a,: --joblog '/data/my runs/wide/parallel.joblog' --resume-failed"));
}

TEST(RangesText, JoinsNumbersInARow) {
  EXPECT_EQ(ranges_text(""), "");
  EXPECT_EQ(ranges_text("4"), "4");
  EXPECT_EQ(ranges_text("1,2,3,7,9,10"), "1-3,7,9-10");
}

TEST(WithoutShards, LeavesTheOtherLinesOfTheLog) {
  EXPECT_EQ(without_shards("Seq\tHost\n1\ta\n2\tb\n12\ta\n", {"2", "3"}), "Seq\tHost\n1\ta\n12\ta\n");
}

TEST(Child, HasAStatusAndAnOutput) {
  const ChildResult child = run_child({"sh", "-c", "pwd; exit 3"}, ChildOutput::kCaptured, "a shell", "/");
  EXPECT_EQ(child.status, 3);
  EXPECT_EQ(child.output, "/\n");
  EXPECT_EQ(run_child({"sh", "-c", "kill -9 $$"}, ChildOutput::kCaptured, "a shell").status, 137);
  EXPECT_THROW(static_cast<void>(run_child({"no-such-program"}, ChildOutput::kCaptured, "another")),
               InputError);
}

}  // namespace
}  // namespace koboshi::lab
