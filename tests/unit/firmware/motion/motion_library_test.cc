#include "firmware/motion/motion_library.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "firmware/storage/image.h"
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
  // Inverts a bit of a stored image where it is in flash.
  void flip_bit(std::uint16_t number, std::size_t offset) {
    const auto image = items_.find(ItemKind::kMotion, number);
    const std::byte changed = image[offset] ^ std::byte{1};
    flash_.load(static_cast<std::size_t>(image.data() - flash_.contents().data()) + offset,
                std::span(&changed, 1));
  }

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

TEST_F(MotionLibraryTest, PlaysAMotionOfAnyNumber) {
  constexpr std::uint16_t kNumbers[] = {0, 31, 32, 33, 63, 64, 65, 127, 198, 199};
  for (const std::uint16_t number : kNumbers) store(number, "motion");
  library_.load();
  for (const std::uint16_t number : kNumbers) {
    Motion motion;
    EXPECT_TRUE(library_.open(number, motion)) << number;
    EXPECT_TRUE(items_.marked(ItemKind::kMotion, number)) << number;
  }
  erase(32);
  Motion motion;
  EXPECT_FALSE(library_.open(32, motion));
  for (const std::uint16_t number : {std::uint16_t{0}, std::uint16_t{33}, std::uint16_t{64}})
    EXPECT_TRUE(library_.open(number, motion)) << number;
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

// --- Validation

// The CRC of the image is wrong from then on, so that a second validation would refuse it.
TEST_F(MotionLibraryTest, ValidatesAMotionOnceAndNotAtItsStart) {
  store(7, "dance");
  library_.load();
  flip_bit(7, storage::kImageCrcOffset);
  Motion motion;
  EXPECT_FALSE(Motion::open(library_.image(7), model_, motion).ok());
  ASSERT_TRUE(library_.open(7, motion));
  EXPECT_EQ(motion.name(), "dance");
  EXPECT_EQ(motion.step_count(), 2u);
  EXPECT_EQ(motion.main_step_count(), 2u);
  EXPECT_EQ(motion.claimed_joints(), 1u << test::kKnee);
  EXPECT_EQ(motion.angle(0, test::kKnee), test::stored(10));
}

TEST_F(MotionLibraryTest, FindsABitErrorAtTheNextBoot) {
  store(7, "dance");
  store(8, "walk");
  library_.load();
  flip_bit(7, storage::kImageHeaderSize + 6);  // in its name
  storage::ItemStore items(flash_, storage::kRobotLogSize_bytes);
  MotionLibrary library(factory_, items, model_);
  library.load();
  Motion motion;
  EXPECT_FALSE(library.open(7, motion));
  EXPECT_TRUE(library.open(8, motion));
  EXPECT_EQ(library.valid()[0], 1u << 8);
}

TEST_F(MotionLibraryTest, NeverPlaysAnInvalidMotionThatCameWithoutANotice) {
  store(7, "dance");
  library_.load();
  store(7, "other", model_.id + 1);  // an image for another robot; `add` is not called
  Motion motion;
  EXPECT_FALSE(library_.open_to_play(storage::Holder::kPlayer, 7, motion));
  store(7, "third");
  ASSERT_TRUE(library_.open_to_play(storage::Holder::kPlayer, 7, motion));
  EXPECT_EQ(motion.name(), "third");
  EXPECT_FALSE(items_.marked(ItemKind::kMotion, 7));
  add(7);
  EXPECT_TRUE(items_.marked(ItemKind::kMotion, 7));
  flip_bit(7, storage::kImageCrcOffset);
  EXPECT_TRUE(library_.open(7, motion));
}

TEST_F(MotionLibraryTest, KeepsItsFindingsWhileMotionsMoveInTheLog) {
  store(7, "dance");
  library_.load();
  const std::byte* const before = library_.image(7).data();
  for (int i = 0; i < 2'000 && library_.image(7).data() == before; ++i) store(9, "other");
  ASSERT_NE(library_.image(7).data(), before) << "the log has moved it";
  EXPECT_TRUE(items_.marked(ItemKind::kMotion, 7));
  EXPECT_FALSE(items_.marked(ItemKind::kMotion, 9));
  Motion motion;
  ASSERT_TRUE(library_.open(7, motion));
  EXPECT_EQ(motion.name(), "dance");
}

TEST_F(MotionLibraryTest, ForgetsTheFindingsOfAnErasedMotion) {
  store(7, "dance");
  library_.load();
  erase(7);
  Motion motion;
  EXPECT_FALSE(library_.open(7, motion));
  EXPECT_FALSE(items_.marked(ItemKind::kMotion, 7));
  store(7, "again");
  EXPECT_TRUE(library_.open(7, motion));
  EXPECT_EQ(motion.name(), "again");
}

// The factory's motion 7, and a stored one that takes its place, or cannot.
class WithAFactory : public MotionLibraryTest {
 protected:
  // Puts a catalogue with the motion "factory" under number 7 at the start of `factory_bytes_`.
  WithAFactory() {
    test::MotionBuilder builder(model_.id);
    builder.name = "factory";
    const std::vector<std::byte> image =
        builder.pose(test::kKnee, 10).step(Opcode::kMove, 0, 100'000).step(Opcode::kEnd).image();
    const std::size_t offset = storage::kImageHeaderSize + 4 + storage::kCatalogueItemSize;
    test::put(factory_bytes_, storage::kCatalogueMagic, 4);
    test::put(factory_bytes_, storage::kCatalogueVersion, 4);
    factory_bytes_.resize(storage::kImageHeaderSize);
    test::put(factory_bytes_, 1, 4);
    test::put(factory_bytes_, static_cast<std::uint32_t>(ItemKind::kMotion), 2);
    test::put(factory_bytes_, 7, 2);
    test::put(factory_bytes_, static_cast<std::uint32_t>(offset), 4);
    test::put(factory_bytes_, static_cast<std::uint32_t>(image.size()), 4);
    test::seal(factory_bytes_);
    factory_bytes_.insert(factory_bytes_.end(), image.begin(), image.end());
    catalogue_.emplace(factory_bytes_);
    library_of_both_.emplace(*catalogue_, items_, model_);
  }
  // The name of motion 7; empty: there is none to play.
  std::string playable() {
    Motion motion;
    return library_of_both_->open(7, motion) ? std::string(motion.name()) : "";
  }
  // From then on a validation refuses the factory's motion.
  void break_the_factory() {
    const auto image = catalogue_->find(ItemKind::kMotion, 7);
    const auto offset = static_cast<std::size_t>(image.data() - factory_bytes_.data());
    factory_bytes_[offset + storage::kImageCrcOffset] ^= std::byte{1};
  }

  std::vector<std::byte> factory_bytes_;
  std::optional<storage::Catalogue> catalogue_;
  std::optional<MotionLibrary> library_of_both_;
};

TEST_F(WithAFactory, IsValidatedOnce) {
  library_of_both_->load();
  break_the_factory();
  EXPECT_EQ(playable(), "factory");
}

TEST_F(WithAFactory, IsNotPlayedBeforeItIsValidated) { EXPECT_EQ(playable(), ""); }

TEST_F(WithAFactory, ReturnsWhenTheStoredOneIsErased) {
  store(7, "stored");
  library_of_both_->load();
  EXPECT_EQ(playable(), "stored");
  ASSERT_EQ(done([&] { return library_of_both_->erase(7); }), Status::kOk);
  EXPECT_EQ(playable(), "factory");
  break_the_factory();
  EXPECT_EQ(playable(), "factory") << "validated again at the erasure, and not since";
}

TEST_F(WithAFactory, TakesThePlaceOfAStoredOneForAnotherRobot) {
  store(7, "stored", model_.id + 1);
  library_of_both_->load();
  break_the_factory();
  EXPECT_EQ(playable(), "factory") << "neither of them is validated again";
}

TEST_F(WithAFactory, ReturnsWhenAnInvalidMotionComesWithoutANotice) {
  library_of_both_->load();
  store(7, "stored", model_.id + 1);
  EXPECT_EQ(playable(), "factory");
  break_the_factory();
  EXPECT_EQ(playable(), "") << "both are validated";
}

}  // namespace
}  // namespace koboshi::motion
