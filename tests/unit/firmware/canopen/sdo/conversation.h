#pragma once

#include <gtest/gtest.h>

#include "tests/unit/firmware/canopen/test_node.h"

namespace koboshi::canopen {

// The client's side of an SDO transfer with node 0x10.
class SdoConversation : public testing::Test {
 protected:
  void SetUp() override { device_.make_operational(); }
  std::vector<hal::CanFrame> ask(std::initializer_list<unsigned> bytes) {
    return device_.ask(can_frame(0x610, bytes), now_us_);
  }
  static std::vector<hal::CanFrame> answer(std::initializer_list<unsigned> bytes) {
    return {can_frame(0x590, bytes)};
  }

  TestNode device_;
  std::uint64_t now_us_ = 0;
};

}  // namespace koboshi::canopen
