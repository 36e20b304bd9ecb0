#include "base/file/output_folder.h"

#include <gtest/gtest.h>

#include "base/text/error.h"
#include "tests/support/temporary_folder.h"

namespace koboshi {
namespace {

namespace fs = std::filesystem;

TEST(OutputFolder, IsCreatedWithItsParents) {
  test::TemporaryFolder folder;
  check_output_folder(folder.path / "a" / "b");
  EXPECT_FALSE(fs::exists(folder.path / "a")) << "a check touches nothing";
  OutputFolder{folder.path / "a" / "b"};
  EXPECT_TRUE(fs::is_empty(folder.path / "a" / "b"));
  OutputFolder{folder.path / "a" / "b"};  // empty: free
}

TEST(OutputFolder, ReplacesAnEarlierRun) {
  test::TemporaryFolder folder;
  test::write_file(folder.path / "summary.json", "{}");
  test::write_file(folder.path / "trace.csv", "");
  fs::create_directory(folder.path / "figures");
  test::write_file(folder.path / "figures" / "base.png", "");
  check_output_folder(folder.path);
  EXPECT_TRUE(fs::exists(folder.path / "figures" / "base.png"));
  OutputFolder{folder.path};
  EXPECT_TRUE(fs::is_empty(folder.path));
}

TEST(OutputFolder, ReplacesAnInterruptedRun) {
  test::TemporaryFolder folder;
  test::write_file(folder.path / "can.log", "");
  test::write_file(folder.path / "trace.csv", "");
  OutputFolder{folder.path};
  EXPECT_TRUE(fs::is_empty(folder.path));
}

TEST(OutputFolder, BelongsToOneRunAtATime) {
  const test::TemporaryFolder folder;
  {
    const OutputFolder first(folder.path);
    test::write_file(folder.path / "trace.csv", "rows of the first");
    test::write_file(folder.path / "can.log", "");
    EXPECT_THROW(OutputFolder{folder.path}, InputError);
    EXPECT_EQ(test::read_file(folder.path / "trace.csv"), "rows of the first");
  }
  OutputFolder{folder.path};
  EXPECT_TRUE(fs::is_empty(folder.path));
}

TEST(FolderLock, IsRefusedInOneLine) {
  const test::TemporaryFolder folder;
  const FolderLock lock(folder.path);
  try {
    const FolderLock another(folder.path);
    FAIL() << "two locks of one folder";
  } catch (const InputError& error) {
    EXPECT_EQ(error.what(), folder.path.string() +
                                ": found a folder to which another run is writing, "
                                "expected a folder of its own for each run");
  }
  EXPECT_THROW(FolderLock{folder.path / "missing"}, std::system_error);
}

TEST(OutputFolder, RejectsAFolderOfOtherContents) {
  test::TemporaryFolder folder;
  test::write_file(folder.path / "thesis.tex", "years of work");
  EXPECT_THROW(check_output_folder(folder.path), InputError);
  EXPECT_THROW(OutputFolder{folder.path}, InputError);
  EXPECT_THROW(OutputFolder{folder.path / "thesis.tex"}, InputError);
  EXPECT_THROW(OutputFolder{folder.path / "thesis.tex" / "run"}, InputError);
  EXPECT_THROW(OutputFolder{""}, InputError);

  // A summary alone does not make a whole tree ours.
  test::write_file(folder.path / "summary.json", "{}");
  fs::create_directory(folder.path / "photos");
  EXPECT_THROW(OutputFolder{folder.path}, InputError);
  EXPECT_TRUE(fs::exists(folder.path / "thesis.tex"));
}

}  // namespace
}  // namespace koboshi
