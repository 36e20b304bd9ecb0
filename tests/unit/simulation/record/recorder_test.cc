#include "simulation/record/recorder.h"

#include <gtest/gtest.h>

#include <system_error>

#include "sim_board/can/bus.h"
#include "sim_board/can/candump_log.h"
#include "tests/support/temporary_folder.h"

namespace koboshi::simulation {
namespace {

const std::vector<TraceColumn> kColumns = {{"base_z", "m"}, {"phase", "", TraceKind::kInteger}};

class DeafNode final : public sim_board::BusNode {
  void on_frame(const hal::CanFrame&, std::uint64_t) override {}
};

TEST(Recorder, WritesTraceAndLog) {
  test::TemporaryFolder folder;
  sim_board::Bus bus;
  DeafNode sender, receiver;
  Recorder recorder(folder.path, kColumns, WhenFull::kWait);
  bus.set_observer(&recorder);
  const sim_board::NodeHandle from = bus.attach(sender, {}, 4);
  bus.attach(receiver, {}, 4);
  ASSERT_TRUE(bus.queue(from, {.identifier = 0x080, .size = 0, .remote = false, .data = {}}, 1'000'000));
  ASSERT_TRUE(bus.queue(from, {.identifier = 0x701, .size = 1, .remote = true, .data = {}}, 2'000'000));
  recorder.row(10'000, std::array<TraceValue, 2>{0.25, 3});
  bus.advance_to(3'000'000);
  recorder.row(20'000, std::array<TraceValue, 2>{0.5, -4});
  recorder.close();

  EXPECT_EQ(test::read_file(folder.path / "trace.csv"), "time_s,base_z_m,phase\n0.01,0.25,3\n0.02,0.5,-4\n");
  sim_board::CandumpReader log(folder.path / "can.log");
  EXPECT_EQ(log.next()->time_us, 1'000'048u) << "the end of its last bit";
  EXPECT_TRUE(std::get<hal::CanFrame>(log.next()->frame).remote);
  EXPECT_FALSE(log.next().has_value());
  EXPECT_EQ(recorder.dropped(), 0u);
}

TEST(Recorder, LosesNothingWithASmallRing) {
  test::TemporaryFolder folder;
  Recorder recorder(folder.path, kColumns, WhenFull::kWait, 2048);
  constexpr std::uint64_t kFrames = 50'000;
  for (std::uint64_t i = 0; i < kFrames; ++i) {
    hal::CanFrame frame{
        .identifier = static_cast<std::uint16_t>(i % 2048), .size = 8, .remote = false, .data = {}};
    frame.data[0] = static_cast<std::uint8_t>(i);
    recorder.on_bus_frame(frame, i, i + 1);
  }
  recorder.close();
  sim_board::CandumpReader log(folder.path / "can.log");
  for (std::uint64_t i = 0; i < kFrames; ++i) {
    const auto logged = log.next();
    ASSERT_TRUE(logged.has_value());
    ASSERT_EQ(logged->time_us, i + 1);
    const auto& frame = std::get<hal::CanFrame>(logged->frame);
    ASSERT_EQ(frame.identifier, i % 2048);
    ASSERT_EQ(frame.data[0], static_cast<std::uint8_t>(i));
  }
}

TEST(Recorder, KeepsItsFilesWhenARunFails) {
  test::TemporaryFolder folder;
  {
    Recorder recorder(folder.path, kColumns, WhenFull::kWait);
    recorder.row(0, std::array<TraceValue, 2>{1.0, 1});
  }
  EXPECT_EQ(test::read_file(folder.path / "trace.csv"), "time_s,base_z_m,phase\n0,1,1\n");
}

TEST(Recorder, ReportsAFullDiskWhenClosed) {
  test::TemporaryFolder folder;
  std::filesystem::create_symlink("/dev/full", folder.path / "can.log");
  for (const std::uint64_t frames :
       {std::uint64_t{1}, std::uint64_t{100'000}}) {  // within and beyond the buffers
    Recorder recorder(folder.path, kColumns, WhenFull::kWait, 2048);
    for (std::uint64_t i = 0; i < frames; ++i) recorder.on_bus_frame({}, i, i);
    try {
      recorder.close();
      FAIL() << "no error";
    } catch (const std::system_error& error) {
      EXPECT_EQ(error.code(), std::errc::no_space_on_device);
      EXPECT_NE(std::string(error.what()).find((folder.path / "can.log").string()), std::string::npos);
    }
  }
}

// A run of hours stops soon after the disk is full, not at its end.
TEST(Recorder, ReportsAFullDiskDuringTheRun) {
  test::TemporaryFolder folder;
  std::filesystem::create_symlink("/dev/full", folder.path / "trace.csv");
  Recorder recorder(folder.path, kColumns, WhenFull::kWait, 2048);
  const auto record_for_long = [&] {
    for (std::uint64_t i = 0; i < 10'000'000; ++i)
      recorder.row(i, std::array<TraceValue, 2>{0.1 * static_cast<double>(i), 1});
  };
  EXPECT_THROW(record_for_long(), std::system_error);
}

TEST(Recorder, RejectsAMissingFolder) {
  EXPECT_THROW(Recorder("/nowhere/at/all", kColumns, WhenFull::kWait), std::system_error);
}

}  // namespace
}  // namespace koboshi::simulation
