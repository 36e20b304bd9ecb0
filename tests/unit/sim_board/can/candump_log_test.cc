#include "sim_board/can/candump_log.h"

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

#include "sim_board/input/error.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/sim_board/can/bus_fixture.h"

namespace koboshi::sim {
namespace {

using test::make_frame;

std::string line_of(const hal::CanFrame& frame, std::uint64_t time_us,
                    std::string_view interface = kLogInterface) {
  std::array<char, kMaxLogLineBytes> line;
  return {line.data(), format_log_line(line, frame, time_us, interface)};
}

class CandumpLog : public testing::Test {
 protected:
  std::filesystem::path write(const std::string& text) {
    koboshi::test::write_file(file_, text);
    return file_;
  }
  std::vector<LoggedFrame> read(const std::string& text) {
    CandumpReader reader(write(text));
    std::vector<LoggedFrame> frames;
    while (auto frame = reader.next()) frames.push_back(*frame);
    return frames;
  }
  std::string error_of(const std::string& text) {
    try {
      read(text);
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  }

  const koboshi::test::TemporaryFolder folder_;
  const std::filesystem::path file_ = folder_.path / "can.log";
};

TEST_F(CandumpLog, WritesLinesAsCandumpDoes) {
  EXPECT_EQ(line_of(make_frame(0x210, {0x0F, 0x00, 0x11, 0x22, 0x33}), 12'345'678),
            "(0000000012.345678) vcan0 210#0F00112233\n");
  EXPECT_EQ(line_of(make_frame(0x000, {}), 0, "can0"), "(0000000000.000000) can0 000#\n");
  EXPECT_EQ(line_of({.identifier = 0x701, .size = 0, .remote = true, .data = {}}, 5),
            "(0000000000.000005) vcan0 701#R\n");
  EXPECT_EQ(line_of({.identifier = 0x7FF, .size = 8, .remote = true, .data = {}}, 5),
            "(0000000000.000005) vcan0 7FF#R8\n");
}

TEST_F(CandumpLog, FitsTheLongestLine) {
  const std::string line =
      line_of(make_frame(0x7FF, {1, 2, 3, 4, 5, 6, 7, 8}), ~std::uint64_t{0}, "fifteen_letters");
  EXPECT_EQ(line, "(18446744073709.551615) fifteen_letters 7FF#0102030405060708\n");
  EXPECT_LE(line.size(), kMaxLogLineBytes);
}

TEST_F(CandumpLog, RoundTrips) {
  std::mt19937 random(3);
  std::vector<LoggedFrame> written;
  std::string text;
  std::uint64_t time_us = 0;
  for (int i = 0; i < 1000; ++i) {
    LoggedFrame logged{.frame = {}, .time_us = time_us += random() % 1'000'000, .interface = "vcan0"};
    logged.frame.identifier = static_cast<std::uint16_t>(random() & 0x7FFu);
    logged.frame.size = static_cast<std::uint8_t>(random() % 9);
    logged.frame.remote = random() % 8 == 0;
    for (std::size_t k = 0; k < logged.frame.size && !logged.frame.remote; ++k) {
      logged.frame.data[k] = static_cast<std::uint8_t>(random());
    }
    text += line_of(logged.frame, logged.time_us);
    written.push_back(logged);
  }
  EXPECT_EQ(read(text), written);
}

TEST_F(CandumpLog, ReadsLogsOfOtherTools) {
  const std::vector<LoggedFrame> frames =
      read("(1436509052.249713) can0 044#2a366c2bba\n(1436509052.249713) slcan1 7ff#R\n");
  ASSERT_EQ(frames.size(), 2u);
  EXPECT_EQ(frames[0],
            (LoggedFrame{make_frame(0x044, {0x2A, 0x36, 0x6C, 0x2B, 0xBA}), 1'436'509'052'249'713, "can0"}));
  EXPECT_EQ(frames[1].interface, "slcan1");
  EXPECT_TRUE(frames[1].frame.remote);
  EXPECT_TRUE(read("").empty());
}

TEST_F(CandumpLog, RejectsMalformedLines) {
  const std::string good = "(0000000001.000000) vcan0 080#\n";
  for (const std::string bad : {
           "",
           "hello",
           "0000000001.000000 vcan0 080#",
           "(0000000001.00000) vcan0 080#",
           "(1.0000000) vcan0 080#",
           "(-1.000000) vcan0 080#",
           "(12345678901234.000000) vcan0 080#",
           "(0000000001.000000)vcan0 080#",
           "(0000000001.000000) vcan0  080#",
           "(0000000001.000000) vcan0 80#",
           "(0000000001.000000) vcan0 800#",
           "(0000000001.000000) vcan0 00000080#",
           "(0000000001.000000) vcan0 080",
           "(0000000001.000000) vcan0 080#1",
           "(0000000001.000000) vcan0 080#0G",
           "(0000000001.000000) vcan0 080#001122334455667788",
           "(0000000001.000000) vcan0 080##100",
           "(0000000001.000000) vcan0 080#R9",
           "(0000000001.000000) vcan0 080#R11",
           "(0000000001.000000) vcan0 080#00 ",
           "(0000000001.000000) vcan0 080#\r",
           "(0000000001.000000) vcan0 080#+1",
       }) {
    const std::string error = error_of(good + bad + "\n");
    EXPECT_NE(error.find(file_.string() + ":2: found "), std::string::npos) << bad << ": " << error;
    EXPECT_EQ(error.find('\n'), std::string::npos) << bad;
  }
}

TEST_F(CandumpLog, RejectsATruncatedLineDecreasingTimeAndAMissingFile) {
  EXPECT_NE(error_of("(0000000001.000000) vcan0 080#00").find(":1: found a line without end"),
            std::string::npos);
  EXPECT_NE(
      error_of("(0000000001.000001) v 080#\n(0000000001.000000) v 080#\n").find(":2: found a time before"),
      std::string::npos);
  EXPECT_THROW(CandumpReader("/nowhere/can.log"), InputError);
  EXPECT_THROW(CandumpReader(folder_.path), InputError);
}

}  // namespace
}  // namespace koboshi::sim
