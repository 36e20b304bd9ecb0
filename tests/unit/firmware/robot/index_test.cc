#include "firmware/robot/index.h"

#include <gtest/gtest.h>

#include <array>
#include <type_traits>

#include "hal/port/side.h"

namespace koboshi::robot {
namespace {

// Mixing index types does not compile, and using one as an index costs no call.
static_assert(std::is_nothrow_convertible_v<JointIndex, std::size_t>);
static_assert(!std::is_convertible_v<std::size_t, JointIndex>);
static_assert(!std::is_convertible_v<JointIndex, LinkIndex>);
static_assert(!std::is_convertible_v<LinkIndex, JointIndex>);
static_assert(!std::is_convertible_v<LinkIndex, std::size_t>, "the trunk has no place among the joints");
static_assert(std::is_trivially_copyable_v<JointIndex> && std::is_trivially_copyable_v<LinkIndex>);

TEST(JointIndex, IndexesArraysByJoint) {
  const std::array<int, 3> angles{10, 11, 12};
  EXPECT_EQ(angles[JointIndex(2)], 12);
}

TEST(LinkIndex, IsTheTrunkOrTheLinkOfAJoint) {
  EXPECT_TRUE(LinkIndex().is_trunk());
  EXPECT_EQ(LinkIndex().raw(), -1);
  const LinkIndex link(JointIndex(7));
  EXPECT_FALSE(link.is_trunk());
  EXPECT_EQ(link.joint(), 7u);
  EXPECT_EQ(LinkIndex::from_raw(7), link);
  EXPECT_EQ(LinkIndex::from_raw(-2).raw(), -2);  // kept for the validation of the model
  EXPECT_FALSE(LinkIndex::from_raw(-2).is_trunk());
}

TEST(BySide, IsIndexedBySideAndByNumber) {
  hal::BySide<int> feet{1, 2};
  EXPECT_EQ(feet[hal::Side::kLeft], 1);
  feet[hal::Side::kRight] = 3;
  EXPECT_EQ(feet[1], 3);
  EXPECT_EQ(feet.size(), 2u);
}

}  // namespace
}  // namespace koboshi::robot
