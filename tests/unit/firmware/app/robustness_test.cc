#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <iterator>
#include <span>

#include "firmware/app/dictionary.h"
#include "firmware/drive/configuration.h"
#include "tests/support/controller_bench.h"
#include "tests/support/random_frames.h"

namespace koboshi::app {
namespace {

using test::ControllerBench;
using test::kVelocityIdentifier;
using test::Random;

// Roughness of the bus traffic. Mild: frames that a PC may send while the robot stands and moves. Rough: also
// those that end this. Storm: frequent NMT commands, each of which may reset the controller.
enum class Bus { kMild, kRough, kStorm };

constexpr std::uint16_t kCommandIdentifier = 0x201;
constexpr std::uint16_t kSdoIdentifier = canopen::kSdoRequestBase + drive::kControllerNodeId;

hal::CanFrame command(Random& random, Bus bus) {
  static constexpr Command kMild[] = {Command::kEnable, Command::kPlay, Command::kPlay,
                                      Command::kStop,   Command::kWalk, Command::kCalibrate};
  const Command any = static_cast<Command>(random.below(9));
  hal::CanFrame frame{.identifier = kCommandIdentifier, .size = 3};
  frame.data[0] = static_cast<std::uint8_t>(bus == Bus::kMild ? random.one_of(kMild) : any);
  frame.data[1] = static_cast<std::uint8_t>(random.below(3));
  return frame;
}

// Returns a forged answer of a drive, sent in addition to those of the bench's drives.
hal::CanFrame forged_answer(Random& random, const robot::RobotModel& model) {
  static constexpr std::uint16_t kBases[] = {canopen::kTpdo1Base, canopen::kTpdo1Base,
                                             canopen::kEmergencyBase, canopen::kSdoResponseBase,
                                             canopen::kHeartbeatBase};
  hal::CanFrame frame = test::noise_frame(random);
  const robot::Joint& joint = random.one_of(std::span(model.joints).first(model.joint_count));
  frame.identifier = static_cast<std::uint16_t>(random.one_of(kBases) + joint.drive.node_id);
  if (random.below(2) == 0) frame.size = 8;
  frame.remote = false;
  return frame;
}

hal::CanFrame network_command(Random& random) {
  using enum canopen::NmtCommand;
  static constexpr canopen::NmtCommand kCommands[] = {kStart, kStop, kEnterPreOperational, kResetNode,
                                                      kResetCommunication};
  return canopen::encode(canopen::NmtMessage{
      random.one_of(kCommands), random.below(2) == 0 ? std::uint8_t{0} : drive::kControllerNodeId});
}

hal::CanFrame random_frame(Random& random, Bus bus, const robot::RobotModel& model) {
  if (bus != Bus::kMild) {
    constexpr std::uint32_t kRare = 1'000;  // every 0.7 s on average, so that a boot can complete
    switch (random.below(8)) {
      case 0:
        if (bus == Bus::kRough && random.below(kRare) != 0) break;
        return network_command(random);
      case 1:
        return test::noise_frame(random);
      case 2:
        return forged_answer(random, model);
      case 3:
        return test::mutated(command(random, bus), random);
      default:
        break;
    }
  }
  switch (random.below(8)) {
    case 0:
      return command(random, bus);
    case 1: {
      hal::CanFrame frame = test::noise_frame(random);
      frame.identifier = kVelocityIdentifier;
      return frame;
    }
    case 2: {
      hal::CanFrame frame =
          test::mutated(test::sdo_request(kSdoIdentifier, kControllerNode.rows, random), random);
      frame.identifier = kSdoIdentifier;
      return frame;
    }
    default:
      return test::sdo_request(kSdoIdentifier, kControllerNode.rows, random);
  }
}

// Expects torque only in the states that permit it and until a fault's stop has ended, and no target beyond
// the limits.
void expect_safe(const ControllerBench& bench) {
  const State state = bench.now().state;
  if (!behaviour::kTorque.contains(state)) {
    ASSERT_TRUE(state == State::kFault || !bench.board.drive_enable.enabled());
    return;
  }
  const bool ticked = (bench.now_us() - 1'000) % Controller::kTick_us == 0;
  if (!ticked || !behaviour::kBalancing.contains(state)) return;
  for (std::size_t i = 0; i < bench.model().joint_count; ++i) {
    const robot::Joint& joint = bench.model().joints[i];
    const fixed::Angle target = bench.target(i);
    // The drive's unit is coarser than that of Angle.
    const std::int64_t beyond_raw = std::int64_t{target.raw()} - robot::clamp_to_limits(joint, target).raw();
    ASSERT_LE(std::abs(beyond_raw), 1 << (32 - canopen::cia402::kPositionUnitBits)) << "joint " << i;
  }
}

struct Beginning {
  State state;
  Bus bus;
};
constexpr Beginning kBeginnings[] = {{State::kMotion, Bus::kMild},
                                     {State::kStanding, Bus::kRough},
                                     {State::kWalking, Bus::kMild},
                                     {State::kBoot, Bus::kStorm},
                                     {State::kLimp, Bus::kMild}};

bool lead_to(State state, ControllerBench& bench) {
  if (state == State::kBoot) return true;
  if (state == State::kLimp) return bench.run_until(state);
  if (!bench.run_until_ready_to_walk()) return false;
  if (state == State::kMotion) bench.command(Command::kPlay, 1);
  if (state == State::kWalking) bench.command(Command::kWalk);
  return bench.now().state == state;
}

// The complete controller with all objects, in every state that it reaches. tests/proof shows that it cannot
// use the heap.
TEST(ControllerRobustness, SurvivesRandomFrames) {
  constexpr std::uint64_t kEpisode = 20'000;    // frames for one controller, before a new one starts
  constexpr std::uint32_t kMaxFuzzFrames = 24;  // per millisecond; leaves room for the drives' answers
  const std::uint64_t frames = test::frames_to_survive();
  std::array<std::uint64_t, std::size(behaviour::kStates)> visits{};  // ms in each state
  std::uint64_t delivered = 0;
  std::uint64_t sent = 0;
  for (std::uint64_t episode = 0; delivered < frames; ++episode) {
    const std::uint64_t seed = 20081129 + episode;
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Random random(seed);
    const auto& [state, bus] = kBeginnings[episode % std::size(kBeginnings)];
    ControllerBench bench;
    ASSERT_TRUE(lead_to(state, bench));
    const std::uint64_t end = std::min(frames, delivered + kEpisode);
    while (delivered < end) {
      bench.sent.clear();
      bench.board.can.limit_transmit(random.below(65));
      for (std::uint32_t i = random.below(kMaxFuzzFrames + 1); i > 0; --i) {
        const auto lost = bench.board.can.status().receive_overruns;
        bench.board.can.deliver(random_frame(random, bus, bench.model()));
        if (bench.board.can.status().receive_overruns == lost) ++delivered;
      }
      bench.run_ms(1);
      sent += bench.sent.size();
      ++visits[static_cast<std::size_t>(bench.now().state)];
      expect_safe(bench);
      if (testing::Test::HasFatalFailure()) return;
    }
  }
  // Random frames need not lead to the others.
  for (std::size_t i = 0; i <= static_cast<std::size_t>(State::kWalking); ++i)
    EXPECT_GT(visits[i], 0u) << "state " << i;
  EXPECT_GT(sent, frames / 10);
}

}  // namespace
}  // namespace koboshi::app
