#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <deque>
#include <vector>

#include "firmware/app/controller.h"
#include "firmware/canopen/emergency.h"
#include "hal/cortex_m/vectors.h"
#include "hal/fake/can_registers.h"
#include "hal/fake/sensors.h"
#include "hal/fake/storage.h"
#include "hal/stm32/can.h"
#include "hal/stm32/safety.h"
#include "tests/support/controller_bench.h"
#include "tests/support/drive_stub.h"

namespace koboshi::app {
namespace {

using behaviour::Command;
using behaviour::Reason;
using behaviour::State;
namespace stm32 = hal::stm32;

// 14 time quanta of a 42 MHz clock divided by 3; the sample point is after 12 of them.
constexpr stm32::BitTiming kCanTiming{.prescaler = 3, .segment_1 = 11, .segment_2 = 2, .jump_width = 1};
static_assert(kCanTiming.bit_rate(42'000'000) == 1'000'000);

// The drivers of the new board. Fakes replace those that are not written yet.
struct ExampleBoard {
  hal::FakeCanRegisters can_hardware;  // on the real part: the registers at 0x4000'6400
  stm32::WatchdogRegisters watchdog_registers{};
  volatile std::uint32_t pins = 0;  // on the real part: BSRR of the port with the drive-enable pin

  stm32::Can can{can_hardware.registers};
  hal::FakeImu imu;
  hal::FakeAnkles ankles;
  hal::FakeStorage storage{128, 2048};
  stm32::IndependentWatchdog watchdog{watchdog_registers};
  stm32::DriveEnablePin drive_enable{pins, 7};

  ExampleBoard() { storage.load(0, test::factory_storage()); }
  hal::Board ports() { return {can, imu, ankles, storage, watchdog, drive_enable}; }
  bool drive_enable_line() const { return pins == 1u << 7; }
};

// The driver that the interrupts serve; set before they are enabled.
stm32::Can* can_driver = nullptr;

void can1_tx_handler() { can_driver->on_transmit_interrupt(); }
void can1_rx0_handler() { can_driver->on_receive_interrupt(); }

// The 82 interrupts of an STM32F407 (RM0090, 12.1.3).
[[gnu::section(".vectors.interrupts"), gnu::used]] constinit const auto kInterrupts =
    cortex_m::interrupt_vectors<82>({{19, can1_tx_handler}, {20, can1_rx0_handler}});

// Milliseconds since the start, modulo 2^32.
std::atomic<std::uint32_t> clock_ms{0};

// Serves the firmware once for each millisecond that SysTick has counted, in order.
void serve_elapsed(stm32::Can& can, Controller& firmware, std::uint64_t& now_us) {
  for (std::uint32_t left = clock_ms - static_cast<std::uint32_t>(now_us / 1'000); left > 0; --left) {
    now_us += 1'000;
    can.update();
    firmware.service(now_us);
    if (now_us % Controller::kTick_us == 0) firmware.tick(now_us);
  }
}

}  // namespace
}  // namespace koboshi::app

namespace koboshi::cortex_m {

// Every millisecond, by SysTick::start_interrupt(168'000'000 / 1'000).
extern "C" void systick_handler() { app::clock_ms.fetch_add(1, std::memory_order_relaxed); }

// The start-up code of the core has this one.
extern "C" void fault_handler() { FAIL() << "an interrupt without handler"; }

}  // namespace koboshi::cortex_m

namespace koboshi::app {
namespace {

// The board with the firmware, and a stub of each drive of the test robot on a bus of 1 Mbit/s.
class PortExample : public testing::Test {
 protected:
  static constexpr int kFramesAMillisecond = 8;
  static constexpr int kSequencesAMillisecond = 1'000 / 11;

  PortExample() {
    for (std::size_t i = 0; i < firmware.model().joint_count; ++i)
      drives.emplace_back(firmware.model().joints[i].drive);
    can_driver = &board.can;
    clock_ms = 0;
    board.can_hardware.connect(kInterrupts[20], kInterrupts[19]);
    board.can.start(kCanTiming);
  }
  ~PortExample() override { can_driver = nullptr; }

  void run_ms(int duration_ms) {
    for (int i = 0; i < duration_ms; ++i) {
      feed_sensors();
      cortex_m::systick_handler();
      serve_elapsed(board.can, firmware, now_us);
      pass_a_millisecond_on_the_bus();
    }
  }
  bool run_until(State state, int limit_ms = 3'000) {
    for (int i = 0; i < limit_ms && this->state() != state; ++i) run_ms(1);
    return this->state() == state;
  }
  State state() const { return firmware.values().behaviour.state; }
  void command(Command command) {
    others.push_back({.identifier = 0x201, .size = 3, .data = {static_cast<std::uint8_t>(command)}});
    run_ms(1);
  }
  std::vector<hal::CanFrame> sent_with(std::uint16_t identifier) const {
    std::vector<hal::CanFrame> found;
    std::ranges::copy_if(sent, std::back_inserter(found),
                         [identifier](const hal::CanFrame& frame) { return frame.identifier == identifier; });
    return found;
  }
  bool has_raised(std::uint16_t code) const {
    return std::ranges::any_of(sent, [code](const hal::CanFrame& frame) {
      const auto emergency = canopen::decode_emergency(frame);
      return emergency && emergency->node_id == 1 && emergency->code == code;
    });
  }

  ExampleBoard board;
  Controller firmware{board.ports()};
  std::vector<test::DriveStub> drives;
  std::vector<hal::CanFrame> sent;    // by the firmware
  std::vector<hal::CanFrame> others;  // pending frames of the drives and a PC, in order
  std::uint64_t now_us = 0;

 private:
  void feed_sensors() {
    hal::ImuSample upright;
    upright.accelerometer_raw[2] = 8'200;  // 1 g at a full scale of 4 g
    board.imu.deliver(upright);
    for (const hal::Side side : {hal::Side::kLeft, hal::Side::kRight}) board.ankles.deliver(side, {});
    if (now_us / 1'000 % 100 != 5) return;
    for (const test::DriveStub& drive : drives) others.push_back(drive.heartbeat());
  }

  // Arbitrates between the firmware and all other nodes: the lower identifier wins.
  void pass_a_millisecond_on_the_bus() {
    for (int i = 0; i < kFramesAMillisecond; ++i) {
      const auto ours = board.can_hardware.contender();
      const auto theirs = std::ranges::min_element(others, {}, &hal::CanFrame::identifier);
      if (ours && (theirs == others.end() || ours->identifier < theirs->identifier)) {
        sent.push_back(*board.can_hardware.send());
        for (test::DriveStub& drive : drives) drive.on_frame(sent.back(), others);
      } else if (theirs != others.end()) {
        const hal::CanFrame frame = *theirs;
        others.erase(theirs);
        board.can_hardware.deliver(frame);
      } else {
        board.can_hardware.pass_recessive(kSequencesAMillisecond / kFramesAMillisecond);
      }
    }
  }
};

TEST_F(PortExample, BootsLimpAndStandsOnCommand) {
  ASSERT_TRUE(run_until(State::kLimp));
  EXPECT_FALSE(board.drive_enable_line());
  run_ms(20);
  command(Command::kEnable);
  ASSERT_TRUE(run_until(State::kStanding));
  EXPECT_TRUE(board.drive_enable_line());
  EXPECT_EQ(board.can.status(), hal::CanStatus{});
  EXPECT_EQ(firmware.values().diagnosis.frames_lost, 0);
}

TEST_F(PortExample, SkipsNoMillisecond) {
  for (int i = 0; i < 25; ++i) cortex_m::systick_handler();  // a call that takes 25 ms
  serve_elapsed(board.can, firmware, now_us);
  EXPECT_EQ(now_us, 25'000u);
  serve_elapsed(board.can, firmware, now_us);
  EXPECT_EQ(now_us, 25'000u);
}

// 2^32 ms are 49.7 days.
TEST_F(PortExample, KeepsTimeWhenTheCounterOfMillisecondsWraps) {
  now_us = (std::uint64_t{1} << 32) * 1'000 - 1'000;
  clock_ms = 0xFFFF'FFFF;
  cortex_m::systick_handler();
  serve_elapsed(board.can, firmware, now_us);
  EXPECT_EQ(now_us, (std::uint64_t{1} << 32) * 1'000);
}

TEST(PortExampleVectors, MapAllOthersToTheFaultHandler) {
  EXPECT_EQ(std::ranges::count(kInterrupts, &cortex_m::fault_handler), 80);
}

TEST_F(PortExample, SendsAHeartbeatEach20Milliseconds) {
  run_ms(100);
  sent.clear();
  run_ms(1'000);
  EXPECT_EQ(sent_with(0x701).size(), 50u);
}

TEST_F(PortExample, AnswersAnSdoRequestWithinACycle) {
  ASSERT_TRUE(run_until(State::kLimp));
  sent.clear();
  others.push_back({.identifier = 0x601, .size = 8, .data = {0x40, 0x00, 0x10, 0x00}});  // device type
  run_ms(10);
  ASSERT_EQ(sent_with(0x581).size(), 1u);
  EXPECT_EQ(sent_with(0x581)[0].data[0], 0x43);  // four bytes
}

TEST_F(PortExample, CutsTheTorqueOnEmergencyStop) {
  ASSERT_TRUE(run_until(State::kLimp));
  run_ms(20);
  command(Command::kEnable);
  ASSERT_TRUE(run_until(State::kStanding));
  command(Command::kEmergencyStop);
  run_ms(1);
  EXPECT_FALSE(board.drive_enable_line());
  EXPECT_EQ(state(), State::kEmergencyStop);
}

TEST_F(PortExample, RecoversFromBusOff) {
  ASSERT_TRUE(run_until(State::kLimp));
  run_ms(20);
  command(Command::kEnable);
  ASSERT_TRUE(run_until(State::kStanding));
  sent.clear();
  for (int i = 0; i < 300 && board.can.status().state != hal::CanErrorState::kBusOff; ++i) {
    board.can_hardware.destroy_transmission();
    if (board.can_hardware.contender()) continue;
    cortex_m::systick_handler();
    serve_elapsed(board.can, firmware, now_us);
  }
  ASSERT_EQ(board.can.status().state, hal::CanErrorState::kBusOff);
  ASSERT_TRUE(run_until(State::kFault, 20));
  EXPECT_EQ(firmware.values().behaviour.reason, Reason::kBusOff);
  run_ms(400);  // the quick stop of the drives takes up to 300 ms
  EXPECT_FALSE(board.drive_enable_line());
  EXPECT_EQ(board.can.status().state, hal::CanErrorState::kErrorActive);
  EXPECT_TRUE(has_raised(canopen::error_code::kBusOffRecovered));
  EXPECT_FALSE(sent_with(0x701).empty());
}

TEST_F(PortExample, ReportsAReceiveOverrun) {
  ASSERT_TRUE(run_until(State::kLimp));
  sent.clear();
  for (std::size_t i = 0; i < stm32::Can::kReceiveCapacity + 3; ++i)
    board.can_hardware.deliver({.identifier = 0x7E0, .size = 8});
  run_ms(30);
  EXPECT_EQ(firmware.values().diagnosis.receive_overruns, 3);
  EXPECT_TRUE(has_raised(canopen::error_code::kCanOverrun));
}

}  // namespace
}  // namespace koboshi::app
