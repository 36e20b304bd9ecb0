#include "lab/experiment/files.h"

#include <gtest/gtest.h>

#include "base/text/error.h"
#include "tests/support/temporary_folder.h"

namespace koboshi::lab {
namespace {

namespace fs = std::filesystem;
using koboshi::test::read_file;
using koboshi::test::TemporaryFolder;
using koboshi::test::write_file;

TEST(InputHash, DistinguishesFilesAndTexts) {
  const TemporaryFolder folder;
  const fs::path a = folder.path / "a";
  write_file(a, "one");
  const auto hash = [&](const std::vector<std::string>& texts) {
    return hash_inputs(std::vector<fs::path>{a}, texts);
  };
  const std::string before = hash({"x", "y"});
  EXPECT_EQ(hash({"x", "y"}), before);
  EXPECT_NE(hash({"xy"}), before);
  EXPECT_NE(hash({"xy", ""}), before);
  write_file(a, "two");
  EXPECT_NE(hash({"x", "y"}), before);
  EXPECT_THROW(static_cast<void>(hash_inputs(std::vector<fs::path>{folder.path / "b"}, {})), InputError);
}

TEST(PageSection, CreatesAPageAndIsReplacedInPlace) {
  const TemporaryFolder folder;
  const fs::path page = folder.path / "page.md";
  write_section(page, "Walking", "level", "20 seeds\n");
  EXPECT_EQ(read_file(page), "# Walking\n\n<!-- generated: level -->\n20 seeds\n<!-- end of level -->\n");
  write_section(page, "Walking", "pushed", "10 seeds\n");
  const std::string by_hand = read_file(page) + "\nWhat it means.\n";
  write_file(page, by_hand);
  write_section(page, "Walking", "level", "100 seeds\n");
  EXPECT_EQ(read_file(page),
            "# Walking\n\n<!-- generated: level -->\n100 seeds\n<!-- end of level -->\n"
            "\n<!-- generated: pushed -->\n10 seeds\n<!-- end of pushed -->\n\nWhat it means.\n");
}

TEST(PageSection, RejectsAPageThatLacksOneOfItsComments) {
  const TemporaryFolder folder;
  const fs::path page = folder.path / "page.md";
  write_file(page, "# Walking\n<!-- generated: level -->\n20 seeds\n");
  EXPECT_THROW(write_section(page, "Walking", "level", "100 seeds\n"), InputError);
  EXPECT_EQ(read_file(page), "# Walking\n<!-- generated: level -->\n20 seeds\n");
}

}  // namespace
}  // namespace koboshi::lab
