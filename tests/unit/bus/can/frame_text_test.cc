#include "bus/can/frame_text.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

#include "firmware/app/dictionary.h"
#include "firmware/drive/configuration.h"

namespace koboshi::bus {
namespace {

TEST(FrameText, IsReadAndWrittenAsCansendDoes) {
  const hal::CanFrame frame{.identifier = 0x201, .size = 2, .data = {0x01, 0xAB}};
  EXPECT_EQ(parse_frame("201#01AB"), frame);
  EXPECT_EQ(parse_frame("201#01ab"), frame);
  EXPECT_EQ(frame_text(frame), "201#01AB");
  EXPECT_EQ(parse_frame("0#"), hal::CanFrame{});
  EXPECT_EQ(frame_text({.identifier = 0x80}), "080#");
  EXPECT_EQ(parse_frame("701#R1"), (hal::CanFrame{.identifier = 0x701, .size = 1, .remote = true}));
  EXPECT_EQ(frame_text(parse_frame("701#R1")), "701#R1");
  EXPECT_EQ(frame_text(parse_frame("701#R")), "701#R");
}

// As the help promises: the identifier of the controller's first RPDO, and all that this holds.
TEST(FrameText, SampleMatchesTheCommandPdoOfTheController) {
  const hal::CanFrame sample = parse_frame(kSampleFrame);
  const canopen::PdoConfiguration& commands = app::kControllerNode.rpdos[app::kCommandRpdo];
  EXPECT_EQ(sample.identifier, commands.cob_id + drive::kControllerNodeId);
  unsigned bits = 0;
  for (const std::uint32_t entry : commands.mapping) bits += entry & 0xFF;
  EXPECT_EQ(8u * sample.size, bits);
  EXPECT_EQ(sample.data[0], static_cast<std::uint8_t>(behaviour::Command::kEnable));
  try {
    parse_frame("201");
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find(kSampleFrame), std::string::npos) << error.what();
  }
}

TEST(FrameText, RejectsMalformedFrames) {
  for (const char* bad : {"", "201", "#01", "800#01", "0201#01", "201#0", "201#0G", "201#010203040506070809",
                          "201#R9", "201##01", "2x1#01", "-01#01"}) {
    EXPECT_THROW(parse_frame(bad), std::invalid_argument) << bad;
  }
}

TEST(Number, IsDecimalOrHexadecimalWithinItsBounds) {
  EXPECT_EQ(parse_number("127", "the node", 127), 127u);
  EXPECT_EQ(parse_number("0x7F", "the node", 127), 127u);
  try {
    parse_number("128", "the node", 127);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_EQ(std::string(error.what()), "found the node '128', expected a number up to 127");
  }
  for (const char* bad : {"", "0x", "1.5", "12 ", "-1", "99999999999999999999", "010", "7F"})
    EXPECT_THROW(parse_number(bad, "it", 1'000'000), std::invalid_argument) << bad;
}

TEST(HexadecimalNumber, NeedsNoMarkWhereItIsPlain) {
  EXPECT_EQ(parse_hexadecimal("1018", "the index", 0xFFFF, 4), 0x1018u);
  EXPECT_EQ(parse_hexadecimal("0x1018", "the index", 0xFFFF, 4), 0x1018u);
  EXPECT_EQ(parse_hexadecimal("081", "the identifier", 0x7FF, 3), 0x081u);
  EXPECT_EQ(parse_hexadecimal("0x10", "the sub-index", 0xFF, 0), 0x10u);
  EXPECT_EQ(parse_hexadecimal("0A", "the sub-index", 0xFF, 0), 10u);
  EXPECT_EQ(parse_hexadecimal("7", "the sub-index", 0xFF, 0), 7u);
}

TEST(HexadecimalNumber, IsRefusedWhereItCouldBeDecimal) {
  try {
    parse_hexadecimal("10", "the sub-index", 0xFF, 0);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_EQ(std::string(error.what()), "found the sub-index '10', expected 0x10, or 0xA if it is decimal");
  }
  for (const char* bad : {"", "81", "0x", "800", "G1", "1 "})
    EXPECT_THROW(parse_hexadecimal(bad, "the identifier", 0x7FF, 3), std::invalid_argument) << bad;
}

}  // namespace
}  // namespace koboshi::bus
