#include "firmware/app/dictionary.h"

#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <cstdint>

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

}  // namespace
}  // namespace koboshi::app
