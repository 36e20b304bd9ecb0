// Measures how fast a PC uploads a large object over the bus of a walking robot, in simulated time.

#include <gtest/gtest.h>

#include <cstdio>

#include "bus/can/sdo_transfer.h"
#include "simulation/scenario/reader.h"
#include "tests/closed_loop/pc.h"
#include "tests/unit/firmware/canopen/test_node.h"

namespace koboshi {
namespace {

constexpr std::uint8_t kServer = 2;  // node id next to the controller's
constexpr std::size_t kSize_bytes = 32 << 10;
constexpr double kWanted_bytes_per_s = 10 << 10;

// A CANopen node on the controller's stack, serviced at the same rate. Its domain object is 0x2100.
class Server final : private sim_board::BusNode, private canopen::FrameSink {
 public:
  explicit Server(sim_board::Bus& bus)
      : bus_(bus), handle_(bus.attach(*this, sim_board::AcceptanceFilter::all(), 8)) {
    device_.bytes.bytes = canopen::counted_bytes(kSize_bytes);
    device_.node.start(bus.now_us());
  }
  void process() { device_.node.process(bus_.now_us()); }
  const std::vector<std::uint8_t>& bytes() const { return device_.bytes.bytes; }

 private:
  void on_frame(const hal::CanFrame& frame, std::uint64_t time_us) override {
    device_.node.on_frame(frame, time_us);
  }
  bool send(const hal::CanFrame& frame) override { return bus_.queue(handle_, frame, bus_.now_us()); }

  sim_board::Bus& bus_;
  sim_board::NodeHandle handle_;
  canopen::TestNode device_{kServer, canopen::kTestDescription, *this};
};

TEST(SdoUpload, ByBlocksIsFastDuringAWalk) {
  const std::vector<Override> lumped{{"physics.stepper", "lumped"}};
  simulation::Simulation simulation(
      simulation::read_scenario(KOBOSHI_SOURCE_DIR "/scenarios/walk.yaml", lumped));
  sim_board::SimBoard& board = simulation.board();
  Server server(board.electronics().bus());
  test::Pc pc(simulation, kServer, [&] { server.process(); });
  pc.advance_until_us(5'000'000);  // the robot is walking
  const sim_board::BusUsage before = board.electronics().bus().usage();
  const std::vector<std::uint8_t> data = bus::SdoTransfer(pc, kServer).upload({0x2100, 1});
  const double duration_s = 1e-6 * static_cast<double>(board.now_us() - before.time_us);
  const double speed_bytes_per_s = static_cast<double>(data.size()) / duration_s;
  EXPECT_EQ(data, server.bytes());
  EXPECT_GE(speed_bytes_per_s, kWanted_bytes_per_s);
  EXPECT_LT(sim_board::bus_load(before, board.electronics().bus().usage()), 0.9);
  std::printf("%.0f bytes/s, bus load %.2f\n", speed_bytes_per_s,
              sim_board::bus_load(before, board.electronics().bus().usage()));
}

}  // namespace
}  // namespace koboshi
