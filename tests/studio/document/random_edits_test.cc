#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <random>

#include "studio/document/edit_support.h"
#include "tests/studio/document/sample_document.h"
#include "tests/support/seed.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/simulation/motion_language/random_program.h"

namespace koboshi::studio {
namespace {

// Makes random edits of a motion, with undos and redos between them.
class RandomEdits {
 public:
  RandomEdits(MotionDocument& document, std::uint32_t seed) : document_(document), random_(seed) {}

  void edit() {
    const std::string before = document_.text();
    const std::uint64_t revision = document_.revision();
    try {
      edit_once();
      ++done_;
    } catch (const InputError&) {
      EXPECT_EQ(document_.text(), before) << "a refused edit has changed the text";
      EXPECT_EQ(document_.revision(), revision);
      if (below(4) == 0) check_tree();
    }
    EXPECT_TRUE(document_.text() == before || document_.revision() > revision);
    if (below(4) == 0) check_tree();
  }
  int done() const { return done_; }

 private:
  std::size_t row_count() const { return document_.rows().rows.size(); }

  template <typename Edit>
  void keeping_steps(Edit edit) {
    const auto comments = std::ranges::count(document_.text(), '#');
    const std::size_t rows = row_count();
    edit();
    EXPECT_EQ(std::ranges::count(document_.text(), '#'), comments);
    EXPECT_EQ(row_count(), rows);
  }

  std::size_t count_with_bodies(const std::vector<std::size_t>& rows) const {
    return with_bodies(document_.rows(), rows, "a.yaml").size();
  }
  void erase_rows() {
    const auto rows = some_rows();
    const std::size_t before = row_count();
    const std::size_t count = rows.empty() ? 0 : count_with_bodies(rows);
    document_.erase_rows(rows);
    EXPECT_EQ(row_count(), before - count);
  }
  void duplicate_rows() {
    const auto rows = some_rows();
    const std::size_t before = row_count();
    const std::size_t count = count_with_bodies(rows);
    const std::size_t first = document_.duplicate_rows(rows);
    EXPECT_EQ(row_count(), before + count);
    EXPECT_EQ(document_.rows().rows.at(first).text, document_.rows().rows.at(std::ranges::min(rows)).text);
  }

  // Reversed twice, a motion is the same one.
  void reverse_twice_or_once(const std::vector<std::size_t>& rows) {
    const auto image = [&] {
      return document_.compiled() != nullptr ? document_.compiled()->image : std::vector<std::byte>();
    };
    const auto before = image();
    document_.reverse_rows(rows);
    if (before.empty() || image().empty() || below(2) == 0) return;
    document_.reverse_rows(rows);
    EXPECT_EQ(image(), before) << document_.text();
  }

  // The step reaches the angles, and with a pose of its own no other step's pose changes.
  void set_angles() {
    const std::size_t index = row();
    const std::vector<JointAngle> angles = some_angles();
    const PoseScope scope = below(2) == 0 ? PoseScope::kAllSteps : PoseScope::kThisStep;
    const bool compiled = document_.compiled() != nullptr;
    std::vector<MotionRow> before = document_.rows().rows;
    document_.set_angles(index, angles, scope, drag());
    if (!compiled || document_.source() == nullptr) return;
    const auto& rows = document_.rows().rows;
    for (const JointAngle& angle : angles) {
      const bool is_last = std::ranges::count(angles, angle.joint, &JointAngle::joint) == 1;
      if (!is_last || rows[index].has_error) continue;
      EXPECT_NEAR(rows[index].angles_rad[angle.joint], angle.angle_rad, 1e-4) << document_.text();
    }
    ASSERT_EQ(rows.size(), before.size());
    for (std::size_t i = 0; scope == PoseScope::kThisStep && i < rows.size(); ++i) {
      if (i == index) continue;
      EXPECT_EQ(rows[i].moved, before[i].moved) << document_.text();
    }
  }

  // The tree, of which an edit parses only a part, is that of the whole text.
  void check_tree() {
    const YamlNode whole = parse_yaml(document_.text(), document_.file());
    EXPECT_TRUE(same_tree(*document_.tree(), whole)) << document_.text();
  }
  static bool same_tree(const YamlNode& one, const YamlNode& other) {
    const auto places = [](const YamlNode& node) {
      return std::array{node.line, node.column, node.value_line, node.value_column};
    };
    return one.kind == other.kind && one.path == other.path && one.key == other.key &&
           one.scalar == other.scalar && one.quoted == other.quoted && places(one) == places(other) &&
           std::ranges::equal(one.items, other.items, same_tree);
  }

  std::size_t below(std::size_t limit) { return random_() % std::max<std::size_t>(limit, 1); }
  double share() { return static_cast<double>(random_()) / static_cast<double>(std::mt19937::max()); }
  std::size_t row() { return below(document_.rows().rows.size()); }
  std::vector<std::size_t> some_rows() {
    std::vector<std::size_t> rows(1 + below(3));
    for (std::size_t& each : rows) each = row();
    if (below(2) == 0) {  // in a row
      for (std::size_t i = 1; i < rows.size(); ++i) rows[i] = rows[0] + i;
    }
    return rows;
  }
  StepPlace place() {
    const auto kind = static_cast<StepPlace::Kind>(below(5));
    return {kind, kind == StepPlace::Kind::kEndOf ? below(document_.rows().sections.size()) : row()};
  }
  std::string drag() { return below(2) == 0 ? "" : "drag"; }

  std::vector<JointAngle> some_angles() {
    std::vector<JointAngle> angles(1 + below(3));
    for (JointAngle& angle : angles) {
      angle.joint = below(sample_robot()->model.joint_names.size());
      angle.angle_rad = (share() - 0.5) * 2.0;
    }
    return angles;
  }

  std::string step() {
    const std::vector<std::string> steps{
        "{wait_s: 0.5}",
        "{pose: {head_pan: 3}, time_s: 1}   # look",
        "# a loop\n- loop:\n    times: 2\n    steps:\n      # in it\n      - {wait_s: 1}\n",
        "- if: roll_mdeg > 0\n  then: []\n",
        "end",
        "- {label: here}\n- {jump: here, if: pitch_mdeg > 0}\n",
    };
    return steps[below(steps.size())];
  }

  std::string some_pose() {
    const YamlNode* poses = document_.tree() != nullptr ? document_.tree()->find("poses") : nullptr;
    return poses == nullptr || poses->items.empty() ? "none" : poses->items[below(poses->items.size())].key;
  }

  void edit_once() {
    switch (below(20)) {
      case 0:
        return void(document_.undo());
      case 1:
        return void(document_.redo());
      case 2:
        return document_.end_drag();
      case 3:
        return document_.set_time(some_rows(), share() * 3, drag());
      case 4:
        return document_.set_speed(some_rows(), share() * 200, drag());
      case 5:
        return document_.set_pause(some_rows(), below(2) == 0 ? 0.0 : share(), drag());
      case 6:
        return document_.set_interpolation(some_rows(), motion::Interpolation::kCubic);
      case 7:
        return document_.scale_time(some_rows(), 0.5 + share(), drag());
      case 8:
        return erase_rows();
      case 9:
        return duplicate_rows();
      case 10:
        return keeping_steps([&] { document_.move_rows(some_rows(), place()); });
      case 11:
        return keeping_steps([&] { reverse_twice_or_once(some_rows()); });
      case 12:
        return document_.mirror_rows(some_rows());
      case 13:
        copied_ = document_.copy_rows(some_rows());
        return;
      case 14:
        return void(document_.paste(place(), copied_));
      case 15:
        return document_.rename_pose(some_pose(), "pose " + std::to_string(below(9)));
      case 16:
        return void(document_.insert_step(place(), step()));
      case 17:
        return below(3) == 0 ? document_.upgrade() : document_.mirror_motion();
      default:
        return set_angles();
    }
  }

  MotionDocument& document_;
  std::mt19937 random_;
  std::string copied_;
  int done_ = 0;
};

// KOBOSHI_EDITS asks for another number of edits.
int wanted_edits() {
  const char* const text = std::getenv("KOBOSHI_EDITS");
  return text == nullptr ? 600 : std::atoi(text);
}

TEST(RandomEdits, AreAllUndoneToTheByte) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(KOBOSHI_SOURCE_DIR "/robots/koboshi/motions"))
    files.push_back(entry.path());
  std::ranges::sort(files);
  // Files of version 2 as well, with all constructs of the language.
  const test::TemporaryFolder folder;
  for (std::uint32_t i = 0; i < 10; ++i) {
    files.push_back(folder.path / ("random_" + std::to_string(i) + ".yaml"));
    test::write_file(files.back(),
                     simulation::RandomProgram(static_cast<std::uint32_t>(test::kSeed) + i).text());
  }
  const int per_file = wanted_edits() / static_cast<int>(files.size());
  int done = 0;
  for (std::size_t i = 0; i < files.size(); ++i) {
    SCOPED_TRACE(files[i]);
    MotionDocument document(sample_robot(), files[i]);
    const std::string first = document.text();
    RandomEdits edits(document, static_cast<std::uint32_t>(test::kSeed + i));
    for (int n = 0; n < per_file && !testing::Test::HasFailure(); ++n) edits.edit();
    done += edits.done();
    while (document.redo()) {
    }
    const std::string last = document.text();
    while (document.undo()) {
    }
    ASSERT_EQ(document.text(), first);
    EXPECT_FALSE(document.is_modified());
    while (document.redo()) {
    }
    ASSERT_EQ(document.text(), last);
  }
  EXPECT_GT(done, wanted_edits() / 3);
}

}  // namespace
}  // namespace koboshi::studio
