#include "studio/document/recovery.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>

#include "tests/studio/document/sample_document.h"
#include "tests/support/temporary_folder.h"

namespace koboshi::studio {
namespace {

namespace fs = std::filesystem;
using Rows = std::vector<std::size_t>;

std::size_t files_in(const fs::path& folder) {
  std::error_code none;
  return static_cast<std::size_t>(
      std::distance(fs::directory_iterator(folder, none), fs::directory_iterator()));
}

struct Files {
  test::TemporaryFolder folder;
  fs::path file = folder.path / "bow.yaml";
  fs::path recoveries = folder.path / "state" / "recovery";

  Files() { test::write_file(file, kSample); }
  std::unique_ptr<MotionDocument> open() const {
    return std::make_unique<MotionDocument>(sample_robot(), file, recoveries);
  }
};

TEST(Saving, ReplacesTheFileAndKnowsItsText) {
  const Files files;
  const auto document = files.open();
  EXPECT_FALSE(document->is_modified());
  document->set_time(Rows{0}, 2);
  EXPECT_TRUE(document->is_modified());
  EXPECT_EQ(test::read_file(files.file), kSample);
  document->save();
  EXPECT_FALSE(document->is_modified());
  EXPECT_EQ(test::read_file(files.file), document->text());
  EXPECT_EQ(document->changed_on_disk(), DiskChange::kNone);
  document->undo();
  EXPECT_TRUE(document->is_modified());
  document->redo();
  EXPECT_FALSE(document->is_modified());
  document->save_as(files.folder.path / "other.yaml");
  EXPECT_EQ(document->file(), files.folder.path / "other.yaml");
  EXPECT_EQ(test::read_file(document->file()), document->text());
}

TEST(Saving, DoesNotWriteWithoutAChange) {
  const Files files;
  const auto document = files.open();
  const auto time = fs::last_write_time(files.file);
  document->save();
  EXPECT_EQ(fs::last_write_time(files.file), time);
}

TEST(Saving, NoticesOtherProgramsAndReloadsAsAnEdit) {
  const Files files;
  const auto document = files.open();
  document->set_time(Rows{0}, 2);
  const std::string mine = document->text();
  const std::string theirs = with("times: 3", "times: 9");  // of the same size
  test::write_file(files.file, theirs);
  fs::last_write_time(files.file, fs::last_write_time(files.file) + std::chrono::seconds(1));
  EXPECT_EQ(document->changed_on_disk(), DiskChange::kChanged);
  document->reload();
  EXPECT_EQ(document->text(), theirs);
  EXPECT_FALSE(document->is_modified());
  EXPECT_EQ(document->changed_on_disk(), DiskChange::kNone);
  document->undo();
  EXPECT_EQ(document->text(), mine);
  EXPECT_TRUE(document->is_modified());
  fs::last_write_time(files.file, fs::last_write_time(files.file) + std::chrono::seconds(1));
  EXPECT_EQ(document->changed_on_disk(), DiskChange::kNone) << "touched, not changed";
  fs::remove(files.file);
  EXPECT_EQ(document->changed_on_disk(), DiskChange::kGone);
  EXPECT_THROW(document->reload(), InputError);
}

TEST(Saving, BeginsAMotionWithTheStandingPose) {
  const Files files;
  const auto document = MotionDocument::begin(sample_robot(), "two words");
  ASSERT_NE(document->compiled(), nullptr) << print(document->diagnostics());
  EXPECT_TRUE(document->is_modified());
  const auto& angles = document->rows().rows.at(0).angles_rad;
  for (std::size_t i = 0; i < angles.size(); ++i)
    EXPECT_NEAR(angles[i], sample_robot()->standing_rad[i], 1e-4);
  EXPECT_THROW(document->save(), InputError);
  EXPECT_THROW(document->reload(), InputError);
  document->save_as(files.folder.path / "new.yaml");
  EXPECT_FALSE(document->is_modified());
  EXPECT_THROW(static_cast<void>(MotionDocument::begin(sample_robot(), "")), InputError);
  EXPECT_THROW(static_cast<void>(MotionDocument::begin(sample_robot(), std::string(25, 'a'))), InputError);
}

TEST(Recovery, IsThereAfterACrashAndRestores) {
  const Files files;
  std::string edited;
  {
    const auto document = files.open();
    EXPECT_FALSE(document->autosave(100)) << "not modified";
    document->set_time(Rows{0}, 2);
    EXPECT_TRUE(document->autosave(200));
    EXPECT_FALSE(document->autosave(300)) << "not changed since";
    document->set_time(Rows{1}, 3);
    EXPECT_TRUE(document->autosave(400));
    edited = document->text();
    EXPECT_TRUE(find_recoveries(files.recoveries).empty()) << "still open";
    document->keep_recovery();
  }
  EXPECT_EQ(test::read_file(files.file), kSample);
  const auto found = find_recoveries(files.recoveries);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].original, files.file);
  EXPECT_EQ(found[0].base_hash, hash_text(kSample));
  EXPECT_EQ(found[0].time_unix_s, 400);
  EXPECT_EQ(found[0].text, edited);

  const auto restored = MotionDocument::restore(sample_robot(), found[0], files.recoveries);
  EXPECT_EQ(restored->text(), edited);
  EXPECT_TRUE(restored->is_modified());
  EXPECT_TRUE(restored->autosave(500));  // beside what the crash has left
  EXPECT_EQ(find_recoveries(files.recoveries).size(), 1U);
  discard_recovery(found[0]);
  restored->undo();
  EXPECT_EQ(restored->text(), kSample);
  EXPECT_FALSE(restored->is_modified());
}

TEST(Recovery, IsThereAfterTheProcessHasDied) {
  const Files files;
  EXPECT_EXIT(
      {
        const auto document = files.open();
        document->set_time(Rows{0}, 2);
        document->autosave(1);
        ::_exit(find_recoveries(files.recoveries).empty() ? 7 : 1);
      },
      testing::ExitedWithCode(7), "");
  const auto found = find_recoveries(files.recoveries);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].text, with("time_s: 1.5", "time_s: 2"));
}

TEST(Recovery, LeavesNothingAfterACleanCloseOrSave) {
  const Files files;
  {
    const auto document = files.open();
    document->set_time(Rows{0}, 2);
    document->autosave(1);
    EXPECT_EQ(files_in(files.recoveries), 2U);  // with the lock
    document->save();
    EXPECT_EQ(files_in(files.recoveries), 1U);
    document->set_time(Rows{0}, 3);
    document->autosave(2);
    document->undo();
    document->autosave(3);
    EXPECT_EQ(files_in(files.recoveries), 1U);
    document->redo();
    document->autosave(4);
  }
  EXPECT_EQ(files_in(files.recoveries), 0U);
}

TEST(Recovery, KeepsTwoUntitledMotionsApart) {
  const Files files;
  {
    const auto one = MotionDocument::begin(sample_robot(), "one", files.recoveries);
    const auto two = MotionDocument::begin(sample_robot(), "two", files.recoveries);
    EXPECT_TRUE(one->autosave(1));
    EXPECT_TRUE(two->autosave(1));
    one->keep_recovery();
    two->keep_recovery();
  }
  const auto found = find_recoveries(files.recoveries);
  ASSERT_EQ(found.size(), 2U);
  EXPECT_NE(found[0].text, found[1].text);
  EXPECT_TRUE(found[0].original.empty());
}

TEST(Recovery, IgnoresDamagedFiles) {
  const Files files;
  {
    const auto document = files.open();
    document->set_time(Rows{0}, 2);
    document->autosave(1);
    document->keep_recovery();
  }
  const auto found = find_recoveries(files.recoveries);
  ASSERT_EQ(found.size(), 1U);
  const std::string content = test::read_file(found[0].recovery_file);
  for (const std::size_t length : {std::size_t{0}, std::size_t{5}, std::size_t{30}, content.size() - 1}) {
    test::write_file(found[0].recovery_file, content.substr(0, length));
    EXPECT_TRUE(find_recoveries(files.recoveries).empty()) << length;
  }
  EXPECT_TRUE(find_recoveries(files.folder.path / "none").empty());
}

TEST(Document, StaysEditableAsATextThatIsNoYaml) {
  const auto document = document_of();
  document->replace_text("version: [");
  EXPECT_EQ(document->tree(), nullptr);
  EXPECT_TRUE(document->rows().rows.empty());
  ASSERT_FALSE(document->diagnostics().empty());
  EXPECT_EQ(document->diagnostics().front().code, "M001");
  EXPECT_THROW(document->set_time(Rows{0}, 1), InputError);
  EXPECT_THROW(document->mirror_motion(), InputError);
  EXPECT_THROW(static_cast<void>(document->insert_step({StepPlace::Kind::kEndOf, 0}, "end")), InputError);
  EXPECT_THROW(document->upgrade(), InputError);
  EXPECT_EQ(document->text(), "version: [");
  const std::uint64_t revision = document->revision();
  document->undo();
  EXPECT_GT(document->revision(), revision);
  EXPECT_EQ(document->text(), kSample);
  EXPECT_NE(document->compiled(), nullptr);
  for (const char* text : {"", "\n", "- 1\n", "a\n", "\xff\n", "a: &x 1\n", "a: !t 1\n", "version: 7\n"}) {
    document->replace_text(text);
    EXPECT_FALSE(document->diagnostics().empty()) << text;
    EXPECT_EQ(document->compiled(), nullptr);
  }
}

}  // namespace
}  // namespace koboshi::studio
