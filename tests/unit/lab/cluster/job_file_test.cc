#include "lab/cluster/job_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/text/error.h"
#include "tests/support/temporary_folder.h"

namespace koboshi::lab {
namespace {

using koboshi::test::read_file;
using koboshi::test::TemporaryFolder;
using koboshi::test::write_file;
using ::testing::HasSubstr;

const JobFile kJob{{"experiment", "stand-up", "--set", "a=b c"}, "/somewhere", 8, "0f"};

std::string error_of(const std::filesystem::path& folder, const JobFile& job) {
  try {
    keep_job(folder, job);
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

TEST(JobCommand, LeavesOutWhatBelongsToOneShardOrMachine) {
  EXPECT_EQ(job_command({"experiment", "terrain", "--shard", "1/8", "--seeds", "5", "--out=runs/a", "--jobs",
                         "2", "--budget-s=60", "--shards", "merge", "--speed=0.1"}),
            (std::vector<std::string>{"experiment", "terrain", "--seeds", "5", "--speed=0.1"}));
}

TEST(JobFile, IsReadAsItWasWritten) {
  const TemporaryFolder temporary;
  const std::filesystem::path folder = temporary.path / "new" / "shards";
  keep_job(folder, kJob);
  const JobFile read = read_job(folder);
  EXPECT_EQ(read.command, kJob.command);
  EXPECT_EQ(read.directory, kJob.directory);
  EXPECT_EQ(read.shards, 8u);
  EXPECT_EQ(read.inputs, "0f");
  EXPECT_EQ(read.command_line(), "koboshi experiment stand-up --set 'a=b c'");
  const std::string text = read_file(folder / "job.json");
  keep_job(folder, kJob);
  EXPECT_EQ(read_file(folder / "job.json"), text);
}

TEST(JobFile, RefusesAFolderInItsPlace) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.path / "job.json");
  try {
    static_cast<void>(read_job(folder.path));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("job.json: found a folder, expected one that koboshi lab submit"));
  }
}

TEST(JobFile, RefusesShardsOfAnotherJob) {
  const TemporaryFolder folder;
  keep_job(folder.path, kJob);
  JobFile other = kJob;
  other.directory = "/elsewhere";  // of another machine
  EXPECT_EQ(error_of(folder.path, other), "");
  other.command.push_back("--disturbed");
  EXPECT_THAT(error_of(folder.path, other),
              HasSubstr("found koboshi experiment stand-up --set 'a=b c', expected"));
  other = kJob;
  other.shards = 9;
  EXPECT_THAT(error_of(folder.path, other), HasSubstr("found 8 shards, expected 9"));
  other = kJob;
  other.inputs = "10";
  EXPECT_THAT(error_of(folder.path, other), HasSubstr("another build of the program"));
}

TEST(JobFile, RefusesAFolderWithOtherFiles) {
  const TemporaryFolder folder;
  write_file(folder.path / "letter.txt", "dear reader");
  EXPECT_THAT(error_of(folder.path, kJob), HasSubstr("found a folder with other files"));
  EXPECT_THAT(error_of(folder.path / "letter.txt", kJob), HasSubstr("found a file"));
}

TEST(JobFile, RefusesAMalformedFile) {
  const TemporaryFolder folder;
  EXPECT_THROW(static_cast<void>(read_job(folder.path)), InputError);
  for (const char* text : {"", "[]", "{\"version\": 2}", "{\"version\": 1, \"command\": 3}"}) {
    write_file(folder.path / "job.json", text);
    EXPECT_THROW(static_cast<void>(read_job(folder.path)), InputError) << text;
  }
}

}  // namespace
}  // namespace koboshi::lab
