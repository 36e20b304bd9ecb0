#include "sim_board/can/candump_log.h"

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

#include "base/text/error.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/sim_board/can/bus_fixture.h"

namespace koboshi::sim_board {
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
    remarks_ = reader.remarks();
    return frames;
  }
  std::vector<std::uint64_t> times_of(const std::string& text) {
    std::vector<std::uint64_t> times_us;
    for (const LoggedFrame& logged : read(text)) times_us.push_back(logged.time_us);
    return times_us;
  }
  std::string error_of(const std::string& text) {
    try {
      read(text);
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  }

  std::vector<std::string> remarks_;
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
    hal::CanFrame frame{.identifier = static_cast<std::uint16_t>(random() & 0x7FFu),
                        .size = static_cast<std::uint8_t>(random() % 9),
                        .remote = random() % 8 == 0};
    for (std::size_t k = 0; k < frame.size && !frame.remote; ++k)
      frame.data[k] = static_cast<std::uint8_t>(random());
    written.push_back({.frame = frame, .time_us = time_us += random() % 1'000'000, .interface = "vcan0"});
    text += line_of(frame, time_us);
    EXPECT_EQ(line_of(frame, time_us), log_line(written.back()));
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
  EXPECT_TRUE(std::get<hal::CanFrame>(frames[1].frame).remote);
  EXPECT_TRUE(read("").empty());
}

// A line, and the notation of its frame.
TEST_F(CandumpLog, ReadsWhatRealBusesCarry) {
  struct Case {
    const char* line;
    const char* notation;
  };
  for (const auto& [line, notation] : {
           Case{"(1.000000) can0 080#", "080#"},
           Case{"(0000000001.000000) can0 123#0011 R", "123#0011"},  // candump -x, asc2log
           Case{"(0000000001.000000) can0 123#0011 T", "123#0011"},
           Case{"(0000000001.000000) can0 080#\r", "080#"},
           Case{"(0000000001.000000) can0 080#00 \t", "080#00"},
           Case{" (0000000001.000000)    can0 080#00", "080#00"},  // interfaces aligned to the right
           Case{"(0000000001.000000123) can0 080#00", "080#00"},
           Case{"(0000000001.000000) can0 080#00.11.22", "080#001122"},
           Case{"(0000000001.000000) can0 080#0011223344556677_9", "080#0011223344556677"},  // raw DLC
           Case{"(0000000001.000000) can0 7FF#R8", "7FF#R8"},
           Case{"(0000000001.000000) can0 18FEF100#0102", "18FEF100#0102"},
           Case{"(0000000001.000000) can0 00000080#R", "00000080#R"},
           Case{"(0000000001.000000) can0 123##1", "123##1"},
           Case{"(0000000001.000000) can0 123##300112233445566778899AABB", "123##300112233445566778899AABB"},
           Case{"(0000000001.000000) can0 18FEF100##0AA", "18FEF100##0AA"},
           Case{"(0000000001.000000) can0 20000004#0001000000000000", "20000004#0001000000000000"},
           Case{"(0000000001.000000) can0 123#81:00:12345678#11223344", "123#..."},
       }) {
    const std::vector<LoggedFrame> frames = read(std::string(line) + "\n");
    ASSERT_EQ(frames.size(), 1u) << line;
    EXPECT_EQ(frame_notation(frames[0].frame), notation);
    EXPECT_EQ(frames[0].time_us, 1'000'000u) << line;
    EXPECT_EQ(frames[0].interface, "can0") << line;
  }
  EXPECT_EQ(read("(1.000000) can0 123# T\n")[0].direction, Direction::kSent);
  EXPECT_TRUE(remarks_.empty());
}

TEST_F(CandumpLog, TellsForeignFramesApart) {
  const auto kind = [this](const std::string& notation) {
    return std::get<ForeignFrame>(read("(1.000000) can0 " + notation + "\n").at(0).frame).kind;
  };
  EXPECT_EQ(kind("18FEF100#"), ForeignFrame::Kind::kExtended);
  EXPECT_EQ(kind("123##1"), ForeignFrame::Kind::kFd);
  EXPECT_EQ(kind("18FEF100##1"), ForeignFrame::Kind::kFd);
  EXPECT_EQ(kind("20000004#"), ForeignFrame::Kind::kError);
  EXPECT_EQ(kind("45123#81:00:12345678#"), ForeignFrame::Kind::kXl);
}

TEST_F(CandumpLog, SkipsCommentsAndReportsWhatIsMissing) {
  EXPECT_EQ(
      times_of("# recorded on Monday\n\n; a note\n// another\n(1.000000) can0 080#\n   \n"
               "DROPCOUNT: dropped 12 CAN frames on 'can0' socket (total drops 12)\n(2.000000) can0 080#\n"),
      (std::vector<std::uint64_t>{1'000'000, 2'000'000}));
  EXPECT_EQ(remarks_, std::vector{file_.string() + ":7: 12 frames lost by candump"});
}

TEST_F(CandumpLog, LeavesOutALastLineThatWasCutOff) {
  for (const std::string end :
       {"(0000000002.0", "(0000000002.000000) can0 080#0", "(0000000002.000000) can0 080#00"}) {
    EXPECT_EQ(times_of("(1.000000) can0 080#\n" + end), std::vector<std::uint64_t>{1'000'000});
    ASSERT_EQ(remarks_.size(), 1u) << end;
    EXPECT_TRUE(remarks_[0].starts_with(file_.string() + ":2: the last line has no end")) << remarks_[0];
  }
  EXPECT_EQ(times_of(std::string("(1.000000) can0 080#\n") + std::string(40, '\0')).size(), 1u);
  EXPECT_EQ(remarks_.size(), 1u);
}

TEST_F(CandumpLog, ReadsTimesOfEveryKind) {
  using Times = std::vector<std::uint64_t>;
  // candump -t z, -t d (recognised by a decrease, or by a repetition that a bus excludes), -t A.
  EXPECT_EQ(times_of("(000.000000) c 080#\n(000.010000) c 080#\n(000.030000) c 080#\n"),
            (Times{0, 10'000, 30'000}));
  EXPECT_EQ(times_of("(000.000000) c 080#\n(000.010000) c 080#\n(000.009000) c 080#\n"),
            (Times{0, 10'000, 19'000}));
  EXPECT_EQ(times_of("(000.000000) c 080#\n(000.010000) c 080#\n(000.010000) c 080#\n"),
            (Times{0, 10'000, 20'000}));
  CandumpReader forced(write("(000.000000) c 080#\n(000.010000) c 080#\n(000.030000) c 080#\n"),
                       CandumpReader::Times::kDifferences);
  forced.next();
  forced.next();
  EXPECT_EQ(forced.next()->time_us, 40'000u);
  const Times dated = times_of("(2026-11-25 12:00:00.000000) c 080#\n(2026-11-25 12:01:00.500000) c 080#\n");
  EXPECT_EQ(dated[1] - dated[0], 60'500'000u);
  EXPECT_TRUE(remarks_.empty());
}

// Frames of two interfaces may be in disorder. A clock that was set back is reported.
TEST_F(CandumpLog, GoesOnWhereTimesDecrease) {
  using Times = std::vector<std::uint64_t>;
  EXPECT_EQ(times_of("(5.000010) a 080#\n(5.000000) b 080#\n(5.000020) a 080#\n"),
            (Times{5'000'010, 5'000'010, 5'000'020}));
  EXPECT_TRUE(remarks_.empty());
  EXPECT_EQ(times_of("(9.000000) a 080#\n(5.000000) a 080#\n(5.500000) a 080#\n"),
            (Times{9'000'000, 9'000'000, 9'500'000}));
  EXPECT_EQ(remarks_, std::vector{file_.string() + ":2: the clock was set back by 4 s"});
}

TEST_F(CandumpLog, SaysThatItReadsDifferences) {
  const std::string log = "(000.000000) c 080#\n# a note\n(000.010000) c 080#\n(000.009000) c 080#\n";
  EXPECT_EQ(times_of(log), (std::vector<std::uint64_t>{0, 10'000, 19'000}));
  ASSERT_EQ(remarks_.size(), 1u);
  EXPECT_TRUE(remarks_[0].starts_with(file_.string() +
                                      ":4: a time that is not after the previous one: the times "
                                      "are read as differences"))
      << remarks_[0];
  CandumpReader absolute(write(log), CandumpReader::Times::kAbsolute);
  std::vector<std::uint64_t> times;
  while (const auto logged = absolute.next()) times.push_back(logged->time_us);
  EXPECT_EQ(times, (std::vector<std::uint64_t>{0, 10'000, 10'000}));
  ASSERT_EQ(absolute.remarks().size(), 1u);
  EXPECT_TRUE(absolute.remarks()[0].starts_with(file_.string() + ":4: 1 frame out of order"))
      << absolute.remarks()[0];
}

// A log in reverse gives two lines, not one for each frame.
TEST_F(CandumpLog, CountsTimesThatDecrease) {
  std::string log;
  for (int i = 0; i < 50; ++i) log += "(" + std::to_string(1000 - 2 * i) + ".000000) a 080#\n";
  EXPECT_EQ(times_of(log).size(), 50u);
  EXPECT_EQ(remarks_, (std::vector{file_.string() + ":2: the clock was set back by 2 s",
                                   file_.string() + ":50: the clock was set back 49 times"}));
}

TEST_F(CandumpLog, ReadsLogsOfOtherSystems) {
  const std::vector<std::uint64_t> times{1'000'000, 2'000'000};
  EXPECT_EQ(times_of("\xEF\xBB\xBF(1.000000) c 080#\n(2.000000) c 080#\n"), times);
  EXPECT_EQ(times_of("(1.000000) c 080#\r(2.000000) c 080#\r"), times);
  EXPECT_EQ(times_of("(1.000000) c 080#\r\n(2.000000) c 080#\r\n"), times);
  EXPECT_TRUE(remarks_.empty());
  EXPECT_EQ(times_of("(000.000000) c 080#\r(000.010000) c 080#\r(000.005000) c 080#\r"),
            (std::vector<std::uint64_t>{0, 10'000, 15'000}));
  EXPECT_NE(error_of("(1.000000) c 080#\r(2.000000) c 80#\r").find(":2: found "), std::string::npos);
}

TEST_F(CandumpLog, HasFramesOfCanFdOfTheirSizesOnly) {
  for (std::size_t bytes = 0; bytes <= 65; ++bytes) {
    const std::string notation = "123##1" + std::string(2 * bytes, '0');
    const bool exists = bytes <= 8 || bytes == 12 || bytes == 16 || bytes == 20 || bytes == 24 ||
                        bytes == 32 || bytes == 48 || bytes == 64;
    const std::string error = error_of("(1.000000) c " + notation + "\n");
    EXPECT_EQ(error == "no error", exists) << bytes << ": " << error;
    EXPECT_EQ(error.find("CAN FD has 0 to 8, 12, 16,") == std::string::npos, exists) << error;
  }
}

TEST_F(CandumpLog, RefusesTheScreenFormatWithTheOptionThatRecordsALog) {
  for (const std::string line :
       {"  vcan0  123   [2]  00 11",
        " (0000000001.000000)  vcan0  123   [8]  00 11 22 33 44 55 66 77   '........'",
        "  can0  18FEF100   [0]", "  can0  7FF   [0]  remote request", "  can0  123  [12]  00 11"}) {
    EXPECT_NE(
        error_of(line + "\n")
            .find(
                ":1: found candump's format for the screen, expected a CAN log: record it with `candump -L`"),
        std::string::npos)
        << line << error_of(line + "\n");
  }
}

TEST_F(CandumpLog, RejectsMalformedLines) {
  const std::string good = "(0000000001.000000) vcan0 080#\n";
  for (const std::string bad : {
           "hello",
           "0000000001.000000 vcan0 080#",
           "(0000000001.00000) vcan0 080#",
           "(1.0000000) vcan0 080#",
           "(-1.000000) vcan0 080#",
           "(12345678901234.000000) vcan0 080#",
           "(0000000001.000000)vcan0 080#",
           "(0000000001.000000) vcan0 80#",
           "(0000000001.000000) vcan0 800#",
           "(0000000001.000000) vcan0 080",
           "(0000000001.000000) vcan0 080#1",
           "(0000000001.000000) vcan0 080#0G",
           "(0000000001.000000) vcan0 080#001122334455667788",
           "(0000000001.000000) vcan0 080#R9",
           "(0000000001.000000) vcan0 080#R11",
           "(0000000001.000000) vcan0 080#+1",
           "(0000000001.000000) vcan0 40000000#",
           "(0000000001.000000) vcan0 080###1",
           "(0000000001.000000) vcan0 080##",
           "(0000000001.000000) vcan0 080#00 X",
           "(0000000001.000000) vcan0 080#00 R R",
           "(0000000001.000000) vcan0 080#00_9",
           "(2026-11-25 12:00.000000) vcan0 080#",
       }) {
    const std::string error = error_of(good + bad + "\n");
    EXPECT_NE(error.find(file_.string() + ":2: found "), std::string::npos) << bad << ": " << error;
    EXPECT_EQ(error.find('\n'), std::string::npos) << bad;
  }
}

TEST_F(CandumpLog, RejectsAMissingFile) {
  EXPECT_THROW(CandumpReader("/nowhere/can.log"), InputError);
  EXPECT_THROW(CandumpReader(folder_.path), InputError);
}

// A raw length code of 9 to 15 stands behind eight bytes only.
TEST(CandumpLine, ReadsLengthCodesBeyondEightBytes) {
  for (const char* code : {"9", "A", "F", "f"})
    EXPECT_TRUE(parse_frame_notation(std::string("123#0011223344556677_") + code)) << code;
  for (const char* bad : {"123#0011223344556677_8", "123#0011223344556677_0", "123#0011223344556677_",
                          "123#0011223344556677_9A", "123#00112233445566_9", "123#001122334455667788"})
    EXPECT_FALSE(parse_frame_notation(bad)) << bad;
}

}  // namespace
}  // namespace koboshi::sim_board
