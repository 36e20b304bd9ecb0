#include "studio/model/model_document.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "base/text/error.h"
#include "base/text/text.h"
#include "sim_board/description/load.h"
#include "studio/model/robot_copy.h"
#include "tests/support/temporary_folder.h"

namespace koboshi::studio {
namespace {

namespace fs = std::filesystem;

const fs::path kRobotFolder = KOBOSHI_SOURCE_DIR "/robots/koboshi";

class ModelDocumentTest : public testing::Test {
 protected:
  ModelDocumentTest() {
    fs::create_directory_symlink(kRobotFolder / "meshes", folder_.path / "meshes");
    test::write_file(file_, first_);
  }

  std::unique_ptr<ModelDocument> open() { return std::make_unique<ModelDocument>(file_, recovery_); }
  static std::string value(const ModelDocument& document, const std::string& path) {
    return sim_board::find_field(document.xml(), path).value.value_or("none");
  }

  test::TemporaryFolder folder_;
  const fs::path file_ = folder_.path / "robot.sdf";
  const fs::path recovery_ = folder_.path / "recovery";
  const std::string first_ = test::read_file(kRobotFolder / "robot.sdf");
};

TEST_F(ModelDocumentTest, EditsUndoesRedoesAndSaves) {
  const auto document = open();
  const auto revision = document->revision();
  document->set("left_shank.mass", "60 g", sim_board::Sides::kBoth);
  document->set("left_knee.axis", "0 0.99996 0.0087265", sim_board::Sides::kOne);
  EXPECT_GT(document->revision(), revision);
  EXPECT_EQ(value(*document, "right_shank.mass"), "0.06");
  EXPECT_NEAR(document->robot().total_mass_kg(), 1.2, 0.1);
  EXPECT_TRUE(document->is_modified());
  EXPECT_EQ(document->history().undo_label(), "Set left_knee.axis");
  ASSERT_TRUE(document->undo());
  EXPECT_EQ(value(*document, "left_knee.axis"), "0 1 0");
  const std::string saved = document->text();
  document->save();
  EXPECT_EQ(test::read_file(file_), saved);
  EXPECT_FALSE(document->is_modified());
  ASSERT_TRUE(document->redo());
  EXPECT_TRUE(document->is_modified());
  ASSERT_TRUE(document->undo());
  ASSERT_TRUE(document->undo());
  EXPECT_FALSE(document->undo());
  EXPECT_EQ(document->text(), first_);
}

TEST_F(ModelDocumentTest, RefusesEditsAfterWhichTheRobotDoesNotLoad) {
  const auto document = open();
  for (const char* typed : {"-1", "x", "60 mm", ""})
    EXPECT_THROW(document->set("left_shank.mass", typed, sim_board::Sides::kOne), InputError) << typed;
  EXPECT_THROW(document->set("left_knee.axis", "1 1 0", sim_board::Sides::kOne), InputError);
  EXPECT_THROW(document->replace_text("<sdf/>"), InputError);
  EXPECT_EQ(document->text(), first_);
  EXPECT_FALSE(document->is_modified());
  EXPECT_FALSE(document->history().can_undo());
}

TEST_F(ModelDocumentTest, MergesTheEditsOfADrag) {
  const auto document = open();
  for (const char* mass : {"51 g", "52 g", "53 g"})
    document->set("left_shank.mass", mass, sim_board::Sides::kOne, "mass");
  EXPECT_EQ(document->history().undo_count(), 1U);
  ASSERT_TRUE(document->undo());
  EXPECT_EQ(document->text(), first_);
}

TEST_F(ModelDocumentTest, FindsTheFindingsOfTheText) {
  const auto document = open();
  EXPECT_TRUE(document->report().findings.empty());
  document->set("left_shank.mass", "0.06", sim_board::Sides::kOne);
  ASSERT_FALSE(document->report().findings.empty());
  const tools::ModelFinding& finding = document->report().findings.front();
  EXPECT_EQ(finding.code, "R003");
  EXPECT_TRUE(document->element_at(finding.line).ends_with("_shank"));
  document->undo();
  EXPECT_TRUE(document->report().findings.empty());
}

TEST_F(ModelDocumentTest, TellsWhatTheSimulationDoesNotRead) {
  const auto document = open();
  const XmlDocument before = document->xml();
  document->set("head.helmet.zoom", "0.001 0.001 0.0012", sim_board::Sides::kOne);
  EXPECT_TRUE(same_physics(before, document->xml()));
  document->set("left_foot.friction", "0.5", sim_board::Sides::kOne);
  EXPECT_FALSE(same_physics(before, document->xml()));
}

TEST_F(ModelDocumentTest, RecoversTheTextOfACrash) {
  auto document = open();
  EXPECT_FALSE(document->autosave(1));
  document->set("left_shank.mass", "0.06", sim_board::Sides::kOne);
  const std::string edited = document->text();
  EXPECT_TRUE(document->autosave(2));
  EXPECT_FALSE(document->autosave(3));
  document->keep_recovery();
  document.reset();
  const auto recoveries = find_recoveries(recovery_);
  ASSERT_EQ(recoveries.size(), 1U);
  const auto restored = ModelDocument::restore(recoveries.front(), recovery_);
  EXPECT_EQ(restored->text(), edited);
  EXPECT_TRUE(restored->is_modified());
  ASSERT_TRUE(restored->undo());
  EXPECT_EQ(restored->text(), first_);
}

TEST_F(ModelDocumentTest, NoticesAndTakesOverChangesByOtherPrograms) {
  const auto document = open();
  std::string other = first_;
  other.replace(other.find("<mass>0.36</mass>"), 17, "<mass>0.37</mass>");
  test::write_file(file_, other);
  EXPECT_EQ(document->changed_on_disk(), DiskChange::kChanged);
  document->reload();
  EXPECT_EQ(document->text(), other);
  EXPECT_FALSE(document->is_modified());
  EXPECT_EQ(document->history().undo_label(), "Reload");
  ASSERT_TRUE(document->undo());
  EXPECT_EQ(document->text(), first_);
  // A file that does not load changes nothing.
  for (const std::string& broken : {other.substr(0, 500), std::string("<sdf/>")}) {
    test::write_file(file_, broken);
    const std::uint64_t revision = document->revision();
    EXPECT_THROW(document->reload(), InputError);
    EXPECT_EQ(document->text(), first_);
    EXPECT_EQ(document->revision(), revision);
    EXPECT_EQ(document->changed_on_disk(), DiskChange::kChanged);
  }
}

TEST_F(ModelDocumentTest, CopiesOfTheFileLoadBeforeTheyAreSaved) {
  const auto document = open();
  RobotCopies copies(file_, recovery_.parent_path());
  const fs::path unchanged = copies.write(first_);
  document->set("left_shank.mass", "0.06", sim_board::Sides::kOne);
  const fs::path changed = copies.write(document->text());
  EXPECT_NE(unchanged, changed);
  EXPECT_NEAR(
      sim_board::load_robot(changed).total_mass_kg() - sim_board::load_robot(unchanged).total_mass_kg(), 0.01,
      1e-9);
  EXPECT_EQ(test::read_file(file_), first_);
}

// A value near the present one; the robot may refuse it.
std::string nearby(const sim_board::ModelField& field, std::mt19937& random) {
  if (field.numbers() == 0) return *field.value;
  constexpr double kFactors[] = {0.5, 0.9, 0.99, 1.01, 1.1, 2.0, -1.0};
  std::istringstream words(*field.value);
  std::string text;
  for (std::string word; words >> word;) {
    const double factor = kFactors[random() % std::size(kFactors)];
    text += (text.empty() ? "" : " ") + koboshi::number_text(parse_number(word).value_or(0.0) * factor);
  }
  return text;
}

// KOBOSHI_EDITS=10000 by hand.
TEST_F(ModelDocumentTest, ReturnsToTheFirstByteAfterRandomEdits) {
  const char* wanted = std::getenv("KOBOSHI_EDITS");
  const int edits = wanted != nullptr ? std::atoi(wanted) : 30;
  const auto document = open();
  std::map<std::string, std::vector<std::string>> keys;  // by element
  for (const sim_board::ModelElement& element : document->elements())
    for (const sim_board::ModelField& field : document->fields(element.name))
      if (field.value) keys[element.name].push_back(field.key());
  std::vector<std::string> elements;
  for (const auto& [name, fields] : keys) elements.push_back(name);
  std::mt19937 random(20261125);
  int done = 0;
  for (int i = 0; i < edits; ++i) {
    const auto kind = random() % 10;
    if (kind == 0) document->undo();
    if (kind == 1) document->redo();
    if (kind < 2) continue;
    const auto& fields = keys[elements[random() % elements.size()]];
    const sim_board::ModelField field =
        sim_board::find_field(document->xml(), fields[random() % fields.size()]);
    const auto revision = document->revision();
    try {
      const auto sides = random() % 3 == 0 ? sim_board::Sides::kBoth : sim_board::Sides::kOne;
      document->set(field.key(), nearby(field, random), sides);
      done += document->revision() != revision ? 1 : 0;
    } catch (const InputError&) {
      ASSERT_EQ(document->revision(), revision);
    }
  }
  EXPECT_GT(done, edits / 4);
  while (document->undo()) {
  }
  EXPECT_EQ(document->text(), first_);
  EXPECT_FALSE(document->is_modified());
}

}  // namespace
}  // namespace koboshi::studio
