#include "firmware/app/dictionary.h"

#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <utility>

#include "firmware/app/controller_objects.h"
#include "tests/support/eds.h"

namespace koboshi::app {
namespace {

TEST(ControllerDictionary, IsThatOfTheDataSheet) {
  test::expect_described_by(test::read_eds("controller.eds"), kControllerNode);
}

// 0x2200:2 shows the first mask of the valid motions, and 0x2403 all of them.
TEST(ControllerDictionary, GivesEachObjectBytesOfItsOwn) {
  constexpr std::array<std::uint16_t, 1> kTwice{offsetof(ControllerValues, diagnosis.motions)};
  test::expect_separate_values(kControllerNode.rows, kTwice);
}

// Programs of others know only the numbers (docs/reference/object-dictionary.md).
TEST(ControllerDictionary, HasTheFlagsOfItsPage) {
  EXPECT_EQ(kLeftZmpValid, 0x01);
  EXPECT_EQ(kRightZmpValid, 0x02);
  EXPECT_EQ(kZmpValid, 0x04);
  EXPECT_EQ(kFrameIsRight, 0x08);
  EXPECT_EQ(kPlannedZmpValid, 0x10);
  EXPECT_EQ(kPlanIsInRight, 0x20);
  EXPECT_EQ(kLeftContact, 0x40);
  EXPECT_EQ(kRightContact, 0x80);
  EXPECT_EQ(kComValid, 0x01);
  EXPECT_EQ(kComIsInRight, 0x02);
  EXPECT_EQ(kDcmErrorValid, 0x04);
  EXPECT_EQ(kLeftTouches, 0x08);
  EXPECT_EQ(kRightTouches, 0x10);
  EXPECT_EQ(kGroundValid, 0x01);
}

// Without parameters in storage nothing moves the robot by itself.
TEST(ControllerDictionary, IsNeutralAtFirst) {
  ControllerValues values;
  canopen::Dictionary dictionary(kControllerNode.rows, std::as_writable_bytes(std::span(&values, 1)));
  std::map<canopen::ObjectAddress, std::uint32_t> initial;
  for (const canopen::Entry& row : kControllerNode.rows) {
    if (!row.is_in_ram()) continue;
    for (unsigned element = 0; element < row.count; ++element) {
      const canopen::ObjectAddress address{row.index, static_cast<std::uint8_t>(row.subindex + element)};
      canopen::ObjectValue value;
      ASSERT_EQ(dictionary.read(address, value), canopen::AbortCode::kNone);
      if (value.number() != 0) initial[address] = value.number();
    }
  }
  // NMT master; no second motion; any supply, which the lowest voltage of 0 admits, too; a ramp of 60 deg/s;
  // a fall needs a cycle, and the limits of a robot that steps are those of one that stands; no factory
  // parameters.
  const std::map<canopen::ObjectAddress, std::uint32_t> expected{
      {{0x1F80, 0}, 1}, {{0x2001, 10}, 255}, {{0x2100, 2}, 65'535}, {{0x2100, 3}, 683},
      {{0x2140, 6}, 1}, {{0x2140, 8}, 100},  {{0x2200, 12}, 1}};
  EXPECT_EQ(initial, expected);
}

// A count of an object is this fraction of its unit, as docs/reference/object-dictionary.md has it; of all
// others it is one unit, or a count of a sensor.
TEST(ControllerDictionary, HasTheUnitsOfItsPage) {
  using Factor = std::pair<int, int>;
  const std::map<canopen::ObjectAddress, Factor> expected{
      {{0x2010, 1}, {360, 65536}},   {{0x2010, 2}, {360, 65536}},    {{0x2010, 3}, {360, 4096}},
      {{0x2010, 6}, {1, 256}},       {{0x2011, 1}, {1000, 32768}},   {{0x2011, 5}, {1000, 32768}},
      {{0x2011, 7}, {1000, 32768}},  {{0x2011, 11}, {1000, 32768}},  {{0x2012, 1}, {1000, 32768}},
      {{0x2012, 5}, {1000, 32768}},  {{0x2012, 7}, {1000, 32768}},   {{0x2014, 3}, {360, 65536}},
      {{0x2014, 5}, {360, 65536}},   {{0x2014, 7}, {360, 65536}},    {{0x2100, 3}, {360, 4096}},
      {{0x2100, 6}, {360, 4096}},    {{0x2101, 1}, {1, 4096}},       {{0x2101, 2}, {1, 4096}},
      {{0x2101, 3}, {1, 4096}},      {{0x2101, 4}, {1, 4096}},       {{0x2101, 5}, {1, 4096}},
      {{0x2102, 1}, {1, 4096}},      {{0x2103, 1}, {100, 4096}},     {{0x2104, 1}, {1, 4096}},
      {{0x2105, 1}, {100, 4096}},    {{0x2106, 1}, {360, 4096}},     {{0x2120, 1}, {360, 65536}},
      {{0x2121, 1}, {360, 65536}},   {{0x2122, 1}, {360, 16777216}}, {{0x2130, 2}, {1, 10}},
      {{0x2130, 3}, {1, 10}},        {{0x2130, 4}, {1, 10}},         {{0x2130, 5}, {1, 10}},
      {{0x2130, 9}, {1, 10}},        {{0x2130, 10}, {1, 10}},        {{0x2130, 11}, {1, 10}},
      {{0x2130, 12}, {1, 10}},       {{0x2130, 13}, {1, 10}},        {{0x2131, 1}, {1, 10}},
      {{0x2131, 2}, {1, 10}},        {{0x2131, 3}, {1, 10}},         {{0x2131, 4}, {360, 65536}},
      {{0x2131, 5}, {360, 65536}},   {{0x2131, 6}, {1, 1000}},       {{0x2131, 7}, {1, 1000}},
      {{0x2131, 8}, {1, 1000}},      {{0x2132, 1}, {1, 10}},         {{0x2132, 2}, {1, 10}},
      {{0x2132, 3}, {1, 10}},        {{0x2132, 4}, {1, 10}},         {{0x2132, 5}, {1, 100}},
      {{0x2132, 6}, {1, 10}},        {{0x2132, 8}, {1, 10}},         {{0x2132, 9}, {1, 10}},
      {{0x2132, 10}, {1, 10}},       {{0x2132, 11}, {1, 10}},        {{0x2132, 12}, {1, 10}},
      {{0x2132, 13}, {1, 10}},       {{0x2132, 15}, {1, 100}},       {{0x2140, 1}, {360, 65536}},
      {{0x2140, 2}, {360, 65536}},   {{0x2140, 3}, {360, 65536}},    {{0x2140, 5}, {360, 65536}},
      {{0x2140, 7}, {360, 65536}},   {{0x2161, 1}, {360, 65536}},    {{0x2200, 7}, {360, 4096}},
      {{0x2301, 1}, {360, 1048576}}, {{0x2303, 1}, {360, 1048576}},  {{0x2304, 1}, {1, 10}}};
  std::map<canopen::ObjectAddress, Factor> factors;
  for (const canopen::DescribedObject& object : kControllerObjects) {
    const canopen::Unit& unit = object.text.unit;
    const canopen::ObjectAddress address{object.entry.index, object.entry.subindex};
    if (Factor(unit.numerator, unit.denominator) != Factor(1, 1))
      factors[address] = {unit.numerator, unit.denominator};
  }
  EXPECT_EQ(factors, expected);
}

}  // namespace
}  // namespace koboshi::app
