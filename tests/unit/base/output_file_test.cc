#include "base/file/output_file.h"

#include <gtest/gtest.h>

#include <sys/resource.h>

#include <csignal>
#include <filesystem>
#include <iterator>
#include <string>
#include <system_error>

#include "base/file/overwrite.h"
#include "base/text/error.h"
#include "tests/support/temporary_folder.h"

namespace koboshi {
namespace {

namespace fs = std::filesystem;
using test::read_file;
using test::TemporaryFolder;

TEST(WholeFile, ReplacesTheFileAtomically) {
  const TemporaryFolder folder;
  write_whole_file(folder.path / "a.txt", "old");
  write_whole_file(folder.path / "a.txt", "new");
  EXPECT_EQ(read_file(folder.path / "a.txt"), "new");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path), fs::directory_iterator()), 1);
  EXPECT_THROW(write_whole_file(folder.path / "missing" / "a.txt", "text"), std::system_error);
}

TEST(WholeFile, FollowsASymbolicLink) {
  const TemporaryFolder folder;
  test::write_file(folder.path / "a.txt", "old");
  fs::create_symlink("a.txt", folder.path / "link");
  write_whole_file(folder.path / "link", "new");
  EXPECT_TRUE(fs::is_symlink(folder.path / "link"));
  EXPECT_EQ(read_file(folder.path / "a.txt"), "new");
}

fs::perms mode_of(const fs::path& file) { return fs::status(file).permissions(); }

TEST(WholeFile, KeepsTheMode) {
  const TemporaryFolder folder;
  const fs::path file = folder.path / "a.txt";
  test::write_file(file, "old");
  for (const unsigned mode : {0600U, 0640U, 0755U}) {
    fs::permissions(file, fs::perms(mode));
    write_whole_file(file, "new");
    EXPECT_EQ(mode_of(file), fs::perms(mode));
  }
}

TEST(WholeFile, KeepsHardLinks) {
  const TemporaryFolder folder;
  test::write_file(folder.path / "a.txt", "a long old text");
  fs::permissions(folder.path / "a.txt", fs::perms(0600U));
  fs::create_hard_link(folder.path / "a.txt", folder.path / "b.txt");
  for (const std::string text : {"new", "a text that is longer than the old one"}) {
    write_whole_file(folder.path / "a.txt", text);
    EXPECT_EQ(read_file(folder.path / "b.txt"), text);
    EXPECT_EQ(fs::hard_link_count(folder.path / "a.txt"), 2u);
    EXPECT_EQ(mode_of(folder.path / "a.txt"), fs::perms(0600U));
  }
}

TEST(WholeFile, LeavesFilesOfOthersAlone) {
  const TemporaryFolder folder;
  test::write_file(folder.path / "a.txt.part", "mine");
  write_whole_file(folder.path / "a.txt", "new");
  EXPECT_EQ(read_file(folder.path / "a.txt.part"), "mine");
}

// A limit of the file's size stands for a full disk.
TEST(WholeFile, LeavesALinkedFileAsItWasWhenTheDiskIsFull) {
  const TemporaryFolder folder;
  test::write_file(folder.path / "a.txt", "old");
  fs::create_hard_link(folder.path / "a.txt", folder.path / "b.txt");
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const rlimit limit{.rlim_cur = 10, .rlim_max = before.rlim_max};
  setrlimit(RLIMIT_FSIZE, &limit);
  EXPECT_THROW(write_whole_file(folder.path / "a.txt", "more than ten bytes"), WriteError);
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  EXPECT_EQ(read_file(folder.path / "b.txt"), "old");
}

TEST(WholeFile, WritesADeviceDirectly) {
  write_whole_file("/dev/null", "text");
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  EXPECT_THROW(write_whole_file("/dev/full", "text"), WriteError);
  EXPECT_TRUE(fs::is_character_file("/dev/full"));
}

TEST(OutputFile, HasOnlyCompleteRowsWhileItIsWritten) {
  const TemporaryFolder folder;
  const fs::path file = folder.path / "rows.csv";
  OutputFile rows(file);
  const std::string row = std::string(99, 'x') + "\n";
  for (int i = 0; i < 2000; ++i) rows.write(row);
  const std::string so_far = read_file(file);
  EXPECT_GT(so_far.size(), 100'000u) << "a run can be watched";
  EXPECT_EQ(so_far.size() % row.size(), 0u);
  rows.close();
  EXPECT_EQ(read_file(file).size(), 2000 * row.size());
}

TEST(OutputFile, AppendsToAnExistingFile) {
  const TemporaryFolder folder;
  test::write_file(folder.path / "log", "one\n");
  OutputFile log(folder.path / "log", OutputFile::Mode::kAppend);
  log.write("two\n");
  EXPECT_THROW(OutputFile(folder.path / "log", OutputFile::Mode::kAppend), InputError);
  log.close();
  EXPECT_EQ(read_file(folder.path / "log"), "one\ntwo\n");
}

TEST(OutputFile, ReportsAFullDisk) {
  OutputFile file("/dev/full");
  file.write("row\n");
  try {
    file.close();
    FAIL() << "nothing was said";
  } catch (const WriteError& error) {
    EXPECT_STREQ(error.what(), "cannot write /dev/full: No space left on device");
  }
  EXPECT_THROW(OutputFile("/nowhere/file"), WriteError);
}

// A limit of the file's size stands for a disk of so many bytes.
TEST(OutputFile, TruncatesTheRowThatDidNotFit) {
  const TemporaryFolder folder;
  const fs::path file = folder.path / "rows.csv";
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const rlimit limit{.rlim_cur = 10, .rlim_max = before.rlim_max};
  setrlimit(RLIMIT_FSIZE, &limit);
  OutputFile rows(file);
  rows.write("one\ntwo\nthree\n");
  EXPECT_THROW(rows.flush(), WriteError);
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  EXPECT_EQ(read_file(file), "one\ntwo\n");
}

TEST(RefuseToOverwrite, AnInputUnderWhateverName) {
  const TemporaryFolder folder;
  const fs::path input = folder.path / "input";
  write_whole_file(input, "text");
  fs::create_symlink(input, folder.path / "link");
  EXPECT_THROW(refuse_to_overwrite({"other", input}, input), InputError);
  EXPECT_THROW(refuse_to_overwrite({input}, folder.path / "link"), InputError);
  EXPECT_NO_THROW(refuse_to_overwrite({input, ""}, folder.path / "new"));
  EXPECT_NO_THROW(refuse_to_overwrite({folder.path / "new"}, folder.path / "new"));
}

}  // namespace
}  // namespace koboshi
