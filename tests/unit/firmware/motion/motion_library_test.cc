#include "firmware/motion/motion_library.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hal/fake/storage.h"
#include "tests/unit/firmware/motion/motion_builder.h"
#include "tests/unit/firmware/robot/test_robot.h"

namespace koboshi::motion {
namespace {

using storage::ItemKind;
using storage::Status;

// A library with a log that holds some motions, and no motions of the factory.
class MotionLibraryTest : public testing::Test {
 protected:
  static std::string name_of(Role role) { return std::string(kMotionNames[static_cast<std::size_t>(role)]); }

  // Repeats an operation of the log until it is done.
  template <typename Operation>
  Status done(const Operation& operation) {
    for (;;) {
      const Status status = operation();
      if (status != Status::kBusy) return status;
      items_.process();
    }
  }
  void store(std::uint16_t number, const std::string& name, std::uint32_t model_id) {
    test::MotionBuilder builder(model_id);
    builder.name = name;
    const std::vector<std::byte> image =
        builder.pose(test::kKnee, 10).step(Opcode::kMove, 0, 100'000).step(Opcode::kEnd).image();
    ASSERT_EQ(done([&] { return items_.begin(ItemKind::kMotion, number, image.size()); }), Status::kOk);
    std::span<const std::byte> rest = image;
    while (!rest.empty()) {
      const auto piece = rest.first(std::min<std::size_t>(rest.size(), storage::ItemStore::kMaxAppendSize));
      ASSERT_EQ(done([&] { return items_.append(piece); }), Status::kOk);
      rest = rest.subspan(piece.size());
    }
    ASSERT_EQ(done([&] { return items_.commit(); }), Status::kOk);
    items_.release();
  }
  void store(std::uint16_t number, const std::string& name) { store(number, name, model_.id); }
  void add(std::uint16_t number) {
    Motion motion;
    ASSERT_TRUE(library_.open(number, motion));
    library_.add(number, motion);
  }
  void erase(std::uint16_t number) {
    ASSERT_EQ(done([&] { return library_.erase(number); }), Status::kOk);
  }
  void search() {
    for (std::size_t i = 0; i < storage::kMaxMotions; ++i) library_.process();
  }

  const robot::RobotModel model_ = test::make_test_robot();
  hal::FakeStorage flash_{storage::kRobotLogSize_bytes / 2048, 2048};
  const storage::Catalogue factory_{std::span<const std::byte>()};
  storage::ItemStore items_{flash_, storage::kRobotLogSize_bytes};
  MotionLibrary library_{factory_, items_, model_};
};

TEST_F(MotionLibraryTest, FindsMotionsByRoleWhereverTheyAreStored) {
  store(199, name_of(Role::kRiseSeat));
  store(7, name_of(Role::kFallFront));
  store(8, "no role");
  library_.load();
  EXPECT_EQ(library_.number_of(Role::kRiseSeat), 199);
  EXPECT_EQ(library_.number_of(Role::kFallFront), 7);
  EXPECT_EQ(library_.number_of(Role::kRiseProne), std::nullopt);
}

TEST_F(MotionLibraryTest, GivesARoleToTheMotionThatCameLast) {
  store(30, name_of(Role::kRiseSeat));
  library_.load();
  store(3, name_of(Role::kRiseSeat));
  EXPECT_EQ(library_.number_of(Role::kRiseSeat), 30);
  add(3);
  EXPECT_EQ(library_.number_of(Role::kRiseSeat), 3);
}

TEST_F(MotionLibraryTest, SearchesForAnotherMotionWhenARoleHasLostItsOwn) {
  store(3, name_of(Role::kRiseSeat));
  store(120, name_of(Role::kRiseSeat));
  library_.load();
  EXPECT_EQ(library_.number_of(Role::kRiseSeat), 120);
  erase(120);
  EXPECT_EQ(library_.number_of(Role::kRiseSeat), std::nullopt);
  for (int i = 0; i < 3; ++i) library_.process();
  EXPECT_EQ(library_.number_of(Role::kRiseSeat), std::nullopt) << "one number per call, from 0 on";
  library_.process();
  EXPECT_EQ(library_.number_of(Role::kRiseSeat), 3);
  erase(3);
  search();
  EXPECT_EQ(library_.number_of(Role::kRiseSeat), std::nullopt);
}

TEST_F(MotionLibraryTest, LosesARoleWhenItsMotionIsReplacedByOneWithAnotherName) {
  store(5, name_of(Role::kRiseSeat));
  store(150, name_of(Role::kRiseSeat));
  library_.load();
  store(150, "dance");
  add(150);
  search();
  EXPECT_EQ(library_.number_of(Role::kRiseSeat), 5);
}

TEST_F(MotionLibraryTest, IgnoresMotionsOfAnotherRobot) {
  store(4, name_of(Role::kRiseSeat), model_.id + 1);
  library_.load();
  EXPECT_EQ(library_.number_of(Role::kRiseSeat), std::nullopt);
  EXPECT_EQ(library_.valid()[0], 0U);
  store(9, name_of(Role::kRiseSeat));
  add(9);
  erase(9);
  search();
  EXPECT_EQ(library_.number_of(Role::kRiseSeat), std::nullopt);
}

}  // namespace
}  // namespace koboshi::motion
