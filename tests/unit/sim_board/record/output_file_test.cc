#include "sim_board/record/output_file.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <iterator>
#include <system_error>

#include "tests/support/temporary_folder.h"

namespace koboshi::sim {
namespace {

namespace fs = std::filesystem;
using test::read_file;
using test::TemporaryFolder;

TEST(WholeFile, ReplacesAndLeavesNothingBeside) {
  const TemporaryFolder folder;
  write_whole_file(folder.path / "a.txt", "old");
  write_whole_file(folder.path / "a.txt", "new");
  EXPECT_EQ(read_file(folder.path / "a.txt"), "new");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path), fs::directory_iterator()), 1);
  EXPECT_THROW(write_whole_file(folder.path / "missing" / "a.txt", "text"), std::system_error);
}

}  // namespace
}  // namespace koboshi::sim
