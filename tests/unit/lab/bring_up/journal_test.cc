#include "lab/bring_up/journal.h"

#include <gtest/gtest.h>

#include "base/file/output_file.h"
#include "base/text/error.h"
#include "tests/unit/base/scratch_file.h"

namespace koboshi::lab {
namespace {

Journal example() {
  Journal journal{
      .entries = {},
      .factors = {.com_height = 0.1 + 0.2, .step_time = 1.1, .gains = 0.5, .trunk_pitch_deg = -2.5},
      .walked_m_per_s = 0.123456789012345,
      .searched = 7,
      .hashes = {{"go.yaml", "0123456789abcdef"}},
      .is_complete = true};
  journal.entries.push_back(
      {{.name = "loads", .result = Rung::Result::kReached, .figure = "20 joints", .cause = {}}, "aa"});
  journal.entries.push_back(
      {{.name = "hangs", .result = Rung::Result::kFailed, .figure = {}, .cause = "\"it\" falls"}, "bb"});
  return journal;
}

TEST(Journal, IsReadAsItWasWritten) {
  const ScratchFile file("json", journal_text(example()));
  const auto journal = read_journal(file.path());
  ASSERT_TRUE(journal);
  EXPECT_EQ(journal_text(*journal), journal_text(example()));
  // To the last bit: a search continues from them.
  EXPECT_EQ(journal->factors.com_height, 0.1 + 0.2);
  EXPECT_EQ(*journal->walked_m_per_s, 0.123456789012345);
  ASSERT_NE(journal->find("hangs"), nullptr);
  EXPECT_EQ(journal->find("hangs")->rung.cause, "\"it\" falls");
  EXPECT_EQ(journal->find("squats"), nullptr);
}

TEST(Journal, KnowsTheFilesOfBeforeAndAfterAWriteThatWasCut) {
  Journal journal = example();
  journal.is_complete = false;
  journal.next_hashes = {{"go.yaml", "fedcba9876543210"}};
  const ScratchFile file("json", journal_text(journal));
  const auto read = read_journal(file.path());
  ASSERT_TRUE(read);
  EXPECT_FALSE(read->is_complete);
  EXPECT_EQ(read->hashes, journal.hashes);
  EXPECT_EQ(read->next_hashes, journal.next_hashes);
}

TEST(Journal, IsAbsentWithoutAFile) { EXPECT_FALSE(read_journal("/no/such/bring-up.json")); }

TEST(Journal, RefusesFilesOfOthers) {
  const ScratchFile foreign("json", "{\"version\": 1}");
  EXPECT_THROW(static_cast<void>(read_journal(foreign.path())), InputError);
  const ScratchFile cut("json", journal_text(example()).substr(0, 100));
  EXPECT_THROW(static_cast<void>(read_journal(cut.path())), InputError);
}

}  // namespace
}  // namespace koboshi::lab
