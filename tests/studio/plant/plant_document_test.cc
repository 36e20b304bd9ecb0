#include "studio/plant/plant_document.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/text/error.h"
#include "simulation/scenario/events_text.h"
#include "simulation/scenario/reader.h"
#include "studio/run/session.h"
#include "tests/support/temporary_folder.h"

namespace koboshi::studio {
namespace {

namespace fs = std::filesystem;
using sim_board::Sides;

const fs::path kRobot = KOBOSHI_SOURCE_DIR "/robots/koboshi/robot.sdf";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  return at == std::string::npos ? "nothing to replace: " + from : text.replace(at, from.size(), to);
}

std::uint64_t hash_of(const simulation::Scenario& scenario) {
  Session session(scenario);
  session.step(100);
  return session.state_hash();
}

class PlantDocumentTest : public testing::Test {
 protected:
  std::unique_ptr<PlantDocument> open(const std::string& text) {
    test::write_file(file_, text);
    return std::make_unique<PlantDocument>(file_, kRobot);
  }
  std::unique_ptr<PlantDocument> open() { return open(first_); }
  // The error of an edit, which must change nothing; empty: none.
  static std::string refusal(PlantDocument& document, const std::string& path, const std::string& typed) {
    const std::string before = document.text();
    try {
      document.set({{path, typed}}, Sides::kOne);
    } catch (const InputError& error) {
      EXPECT_EQ(document.text(), before);
      return error.what();
    }
    return {};
  }

  test::TemporaryFolder folder_;
  const fs::path file_ = folder_.path / "squat.yaml";
  const std::string first_ = test::read_file(KOBOSHI_SOURCE_DIR "/scenarios/squat.yaml");
};

TEST_F(PlantDocumentTest, AddsChangesAndRemovesTheBytesOfItsEntries) {
  const auto document = open();
  EXPECT_TRUE(document->entries().empty());
  document->set({{"left_shank.mass", "80 g"}}, Sides::kOne);
  const std::string with_mass =
      replaced(first_, "robot: koboshi\n", "robot: koboshi\nplant:\n  left_shank.mass: 80 g\n");
  EXPECT_EQ(document->text(), with_mass);
  document->set({{"trunk.com", "0 0 10 mm"}}, Sides::kOne);
  EXPECT_EQ(document->text(), replaced(with_mass, "80 g\n", "80 g\n  trunk.com: 0 0 10 mm\n"));
  document->set({{"left_shank.inertial.mass", "0.09"}}, Sides::kOne);  // the same quantity
  ASSERT_EQ(document->entries().size(), 2U);
  EXPECT_EQ(PlantDocument::text_of(document->entries()[0]), "left_shank.mass = 90 g (model: 50 g)");
  document->save();
  const auto plant = simulation::read_scenario(file_).plant;
  ASSERT_EQ(plant.size(), 2U);
  EXPECT_EQ(plant[0].value, "0.09");
  EXPECT_EQ(plant[1].field.text, "trunk.com");
  document->erase_entry(0);
  document->set({{"trunk.com", "0 0 12 mm"}}, Sides::kOne);
  EXPECT_EQ(document->entries().size(), 1U);
  document->erase_all();
  EXPECT_EQ(document->text(), first_);
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(document->undo());
  EXPECT_FALSE(document->is_modified());
}

TEST_F(PlantDocumentTest, EditsEntriesOfAnyLayout) {
  const auto document = open(replaced(first_, "robot: koboshi\n",
                                      "robot: koboshi\n"
                                      "plant:  # heavier\n"
                                      "  left_shank.mass: 80 g  # measured\n"
                                      "  trunk: {com: 0 0 10 mm, mass: 0.4}\n"
                                      "  left_foot.box.friction: 0.3\n"));
  EXPECT_EQ(document->problem(), "");
  ASSERT_EQ(document->entries().size(), 4U);
  EXPECT_EQ(document->entries()[1].path, "trunk.com");
  document->set({{"left_shank.mass", "90 g"}, {"trunk.com", "0 0 5 mm"}}, Sides::kOne);
  EXPECT_THAT(document->text(), testing::HasSubstr("  left_shank.mass: 90 g  # measured\n"
                                                   "  trunk: {com: 0 0 5 mm, mass: 0.4}\n"));
  document->erase_entry(1);
  EXPECT_THAT(document->text(), testing::HasSubstr("  trunk: {mass: 0.4}\n"));
  document->erase_entry(1);
  EXPECT_THAT(document->text(), testing::Not(testing::HasSubstr("trunk:")));
  document->erase(document->entries()[1].key, Sides::kOne);
  ASSERT_EQ(document->entries().size(), 1U);
  EXPECT_EQ(document->entries()[0].value, "90 g");
}

TEST_F(PlantDocumentTest, ADragIsOneStepAndTheModelsValueIsNoEntry) {
  const auto document = open();
  const auto quantity = [&] {
    return plant_quantities(document->model(), document->plant(), "left_shank").front();
  };
  for (const double mass_g : {61.0, 72.0, 83.0}) document->set(quantity(), mass_g, Sides::kOne, "mass");
  document->end_drag();
  ASSERT_EQ(document->entries().size(), 1U);
  EXPECT_EQ(document->entries()[0].value, "83 g");
  EXPECT_DOUBLE_EQ(quantity().plant, 83.0);
  document->set(quantity(), 50.0, Sides::kOne);
  EXPECT_EQ(document->text(), first_);
  EXPECT_TRUE(document->undo());
  EXPECT_TRUE(document->undo());
  EXPECT_EQ(document->text(), first_);
  EXPECT_FALSE(document->undo());
}

// A whole pose and its halves are values of the same bytes: the one that was set last holds.
TEST_F(PlantDocumentTest, TheLastEditHoldsBesideValuesAroundIt) {
  const auto document = open(replaced(first_, "robot: koboshi\n",
                                      "robot: koboshi\n"
                                      "plant:\n"
                                      "  left_shank.position: 0 0 -66 mm\n"
                                      "  left_shank.pose: 0 0 -0.067 0 0 0\n"));
  const auto height_mm = [&] {
    for (const PlantQuantity& quantity : plant_quantities(document->model(), document->plant(), "left_shank"))
      if (quantity.name() == "left_shank.position z") return quantity.plant;
    return 0.0;
  };
  EXPECT_DOUBLE_EQ(height_mm(), -67.0);
  document->set({{"left_shank.position", "0 0 -64 mm"}}, Sides::kOne);
  EXPECT_DOUBLE_EQ(height_mm(), -64.0);
  document->set({{"left_shank.position", "0 0 -65 mm"}}, Sides::kOne);  // the model's
  EXPECT_DOUBLE_EQ(height_mm(), -65.0);
  EXPECT_EQ(document->entries().size(), 2U);
}

TEST_F(PlantDocumentTest, ChangesBothSides) {
  const auto document = open();
  document->set({{"left_shank.mass", "80 g"}, {"left_shank.com", "0 2 -33 mm"}}, Sides::kBoth);
  std::vector<std::string> texts;
  for (const auto& entry : document->entries()) texts.push_back(entry.path + "=" + entry.value);
  EXPECT_THAT(texts, testing::ElementsAre("left_shank.mass=80 g", "right_shank.mass=80 g",
                                          "left_shank.com=0 2 -33 mm", "right_shank.com=0 -0.002 -0.033"));
  document->erase(document->entries()[0].key, Sides::kBoth);
  EXPECT_EQ(document->entries().size(), 2U);
}

// With the reader's line, under the name of the key.
TEST_F(PlantDocumentTest, RefusesWhatTheReaderRefuses) {
  const auto document = open();
  EXPECT_THAT(refusal(*document, "left_shnk.mass", "80 g"),
              testing::StartsWith("plant: found left_shnk.mass, expected left_shank"));
  EXPECT_THAT(refusal(*document, "left_shank.mass", "80 mm"), testing::StartsWith("plant: found "));
  EXPECT_THAT(refusal(*document, "left_shank.mass", "45"), testing::HasSubstr("did you mean 45 g?"));
  EXPECT_THAT(refusal(*document, "left_shank.mass", ""), testing::HasSubstr("without a value"));
  EXPECT_THAT(refusal(*document, "left_knee.servo", "nothing"), testing::StartsWith("plant: found "));
  EXPECT_THAT(refusal(*document, "left_knee.lower", "160 deg"), testing::StartsWith("plant: found "));
  EXPECT_FALSE(document->is_modified());
}

TEST_F(PlantDocumentTest, SaysWhatOfAFileDoesNotFit) {
  const auto document =
      open(replaced(first_, "robot: koboshi\n", "robot: koboshi\nplant: {left_shnk.mass: 1 g}\n"));
  EXPECT_THAT(document->problem(), testing::StartsWith("plant: found left_shnk.mass"));
  EXPECT_EQ(document->entries().size(), 1U);
  document->erase_entry(0);
  EXPECT_EQ(document->problem(), "");
  EXPECT_EQ(document->text(), first_);
}

TEST_F(PlantDocumentTest, LeadsToTheSameFilesFromAnotherFolder) {
  const std::string relative = fs::relative(kRobot, folder_.path).string();
  const auto document = open(replaced(first_, "robot: koboshi\n", "robot: " + relative + "  # mine\n"));
  document->set({{"left_shank.mass", "80 g"}}, Sides::kOne);
  const fs::path other = folder_.path / "deep/er";
  fs::create_directories(other);
  test::write_file(other / "squat.yaml", document->text_for(other));
  EXPECT_THAT(document->text_for(other), testing::HasSubstr("  # mine\n"));
  const simulation::Scenario moved = simulation::read_scenario(other / "squat.yaml");
  EXPECT_TRUE(fs::equivalent(moved.robot, kRobot));
  EXPECT_EQ(moved.plant.at(0).value, "80 g");
}

// The document, `koboshi run --plant`, the saved file and a run that was played have the same bits.
TEST_F(PlantDocumentTest, GivesTheRunOfTheOption) {
  const auto document = open();
  const std::uint64_t as_modelled = hash_of(simulation::read_scenario(file_));
  document->set({{"left_shank.mass", "80 g"}, {"krs_2552.resistance_ohm", "9"}}, Sides::kOne);
  const std::uint64_t of_option = hash_of(simulation::read_scenario(
      file_, std::vector<Override>{text_override("plant.left_shank.mass", "80g", "--plant"),
                                   text_override("plant.krs_2552.resistance_ohm", "9", "--plant")}));
  EXPECT_NE(of_option, as_modelled);
  Session session(simulation::read_scenario(file_, std::vector<Override>{document->override_value()}));
  session.step(100);
  EXPECT_EQ(session.state_hash(), of_option);
  const fs::path played = folder_.path / "played.yaml";
  test::write_file(played, simulation::played_text(session.played(), folder_.path));
  EXPECT_EQ(hash_of(simulation::read_scenario(played)), of_option);
  document->save();
  EXPECT_EQ(hash_of(simulation::read_scenario(file_)), of_option);
  document->erase_all();
  EXPECT_EQ(hash_of(simulation::read_scenario(file_, std::vector<Override>{document->override_value()})),
            as_modelled);
}

}  // namespace
}  // namespace koboshi::studio
