#include "sim_board/record/output_folder.h"

#include <gtest/gtest.h>

#include "sim_board/input/error.h"
#include "tests/support/temporary_folder.h"

namespace koboshi::sim {
namespace {

namespace fs = std::filesystem;

TEST(OutputFolder, IsMadeWithItsParents) {
  test::TemporaryFolder folder;
  check_output_folder(folder.path / "a" / "b");
  EXPECT_FALSE(fs::exists(folder.path / "a")) << "a check touches nothing";
  make_output_folder(folder.path / "a" / "b");
  EXPECT_TRUE(fs::is_empty(folder.path / "a" / "b"));
  make_output_folder(folder.path / "a" / "b");  // empty: free
}

TEST(OutputFolder, ReplacesAnEarlierRun) {
  test::TemporaryFolder folder;
  test::write_file(folder.path / "summary.json", "{}");
  test::write_file(folder.path / "trace.csv", "");
  fs::create_directory(folder.path / "figures");
  test::write_file(folder.path / "figures" / "base.png", "");
  check_output_folder(folder.path);
  EXPECT_TRUE(fs::exists(folder.path / "figures" / "base.png"));
  make_output_folder(folder.path);
  EXPECT_TRUE(fs::is_empty(folder.path));
}

TEST(OutputFolder, ReplacesARunThatWasCutShort) {
  test::TemporaryFolder folder;
  test::write_file(folder.path / "can.log", "");
  test::write_file(folder.path / "trace.csv", "");
  make_output_folder(folder.path);
  EXPECT_TRUE(fs::is_empty(folder.path));
}

TEST(OutputFolder, RefusesWhatIsNotOurs) {
  test::TemporaryFolder folder;
  test::write_file(folder.path / "thesis.tex", "years of work");
  EXPECT_THROW(check_output_folder(folder.path), InputError);
  EXPECT_THROW(make_output_folder(folder.path), InputError);
  EXPECT_THROW(make_output_folder(folder.path / "thesis.tex"), InputError);
  EXPECT_THROW(make_output_folder(folder.path / "thesis.tex" / "run"), InputError);
  EXPECT_THROW(make_output_folder(""), InputError);

  // A summary alone does not make a whole tree ours.
  test::write_file(folder.path / "summary.json", "{}");
  fs::create_directory(folder.path / "photos");
  EXPECT_THROW(make_output_folder(folder.path), InputError);
  EXPECT_TRUE(fs::exists(folder.path / "thesis.tex"));
}

}  // namespace
}  // namespace koboshi::sim
