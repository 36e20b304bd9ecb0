#include "hal/stm32/can.h"

#include <gtest/gtest.h>

#include <vector>

#include "hal/fake/can_registers.h"

namespace koboshi::hal::stm32 {
namespace {

constexpr BitTiming k1MbitAt42MHz{.prescaler = 3, .segment_1 = 11, .segment_2 = 2, .jump_width = 1};
constexpr CanFrame kSync{.identifier = 0x080};
constexpr CanFrame kRpdo{.identifier = 0x210, .size = 6, .data = {1, 2, 3, 4, 5, 6}};
constexpr CanFrame kAnswer{.identifier = 0x581, .size = 8, .data = {0x4B, 1, 2, 3, 4, 5, 6, 7}};
constexpr CanFrame kHeartbeat{.identifier = 0x701, .size = 1, .data = {5}};

class Stm32Can : public testing::Test {
 protected:
  Stm32Can() {
    hardware.connect([this] { can.on_receive_interrupt(); }, [this] { can.on_transmit_interrupt(); });
  }
  void start() {
    can.start(k1MbitAt42MHz);
    hardware.settle();
    can.update();
    hardware.pass_recessive(1);
  }
  void destroy_until_bus_off() {
    ASSERT_TRUE(can.transmit(kHeartbeat));
    for (int i = 0; i < 32; ++i) hardware.destroy_transmission();
  }
  std::vector<std::uint16_t> send_all() {
    std::vector<std::uint16_t> identifiers;
    while (const auto frame = hardware.send()) identifiers.push_back(frame->identifier);
    return identifiers;
  }

  FakeCanRegisters hardware;
  Can can{hardware.registers};
  CanFrame frame;
};

TEST(BitTiming, GivesTheRegisterOfTheManual) {
  static_assert(k1MbitAt42MHz.bit_rate(42'000'000) == 1'000'000);
  static_assert(k1MbitAt42MHz.sample_point_permille() == 857);
  static_assert(k1MbitAt42MHz.btr() == (0u << 24 | 1u << 20 | 10u << 16 | 2u));
  static_assert(k1MbitAt42MHz.bit_rate(8'000'000) == 0, "190,476.2 bits a second");
}

TEST_F(Stm32Can, IsSilentUntilStarted) {
  ASSERT_TRUE(can.transmit(kSync));
  EXPECT_FALSE(hardware.on_bus());
  EXPECT_EQ(hardware.send(), std::nullopt);
}

TEST_F(Stm32Can, StartsByTheAcknowledgedInitialisationMode) {
  can.start(k1MbitAt42MHz);
  can.update();  // too early: initialisation is not acknowledged
  EXPECT_EQ(hardware.registers.fa1r, 0u);
  hardware.settle();
  EXPECT_EQ(hardware.registers.msr, msr::kInak);
  can.update();
  hardware.settle();
  EXPECT_EQ(hardware.registers.btr, k1MbitAt42MHz.btr());
  EXPECT_FALSE(hardware.on_bus());  // needs 11 recessive bits first
  hardware.pass_recessive(1);
  EXPECT_TRUE(hardware.on_bus());
}

TEST_F(Stm32Can, ReceivesFramesAsTheyWereSent) {
  start();
  const CanFrame remote{.identifier = 0x7FF, .size = 4, .remote = true};
  for (const CanFrame& sent : {kSync, kRpdo, kAnswer, kHeartbeat, remote}) {
    hardware.deliver(sent);
    ASSERT_TRUE(can.receive(frame));
    EXPECT_EQ(frame, sent);
  }
  EXPECT_FALSE(can.receive(frame));
}

TEST_F(Stm32Can, ReadsADlcAboveEightAsEight) {
  start();
  hardware.deliver({.identifier = 0x123, .size = 15, .data = {1, 2, 3, 4, 5, 6, 7, 8}});
  ASSERT_TRUE(can.receive(frame));
  EXPECT_EQ(frame.size, 8);
}

TEST_F(Stm32Can, KeepsAsManyFramesAsTheRingHolds) {
  start();
  constexpr std::uint16_t kFrames = Can::kReceiveCapacity;
  for (std::uint16_t i = 0; i < kFrames + 2; ++i) hardware.deliver({.identifier = i});
  EXPECT_EQ(can.status().receive_overruns, 2);
  for (std::uint16_t i = 0; i < kFrames; ++i) {
    ASSERT_TRUE(can.receive(frame));
    EXPECT_EQ(frame.identifier, i);
  }
  EXPECT_FALSE(can.receive(frame));
}

// The interrupt is delayed by more than the duration of three frames: the fourth is lost and counted once.
TEST_F(Stm32Can, CountsAnOverrunOfTheHardwareFifo) {
  start();
  const std::uint32_t enabled = hardware.registers.ier;
  hardware.registers.ier = 0;
  for (std::uint16_t i = 1; i <= 4; ++i) hardware.deliver({.identifier = i});
  EXPECT_EQ(can.status().receive_overruns, 0);
  hardware.registers.ier = enabled;
  hardware.settle();
  EXPECT_EQ(can.status().receive_overruns, 1);
  for (std::uint16_t i = 1; i <= 3; ++i) {
    ASSERT_TRUE(can.receive(frame));
    EXPECT_EQ(frame.identifier, i);
  }
  EXPECT_FALSE(can.receive(frame));
  hardware.deliver(kSync);
  EXPECT_EQ(can.status().receive_overruns, 1);
}

// The interrupt line falls some clock cycles after the release, so the handler runs again.
TEST_F(Stm32Can, ReadsAFrameOnceWhileItsReleaseIsPending) {
  start();
  hardware.connect([] {}, [] {});
  const std::uint32_t enabled = hardware.registers.ier;
  hardware.registers.ier = 0;
  hardware.deliver(kSync);
  can.on_receive_interrupt();
  hardware.registers.rf0r = hardware.registers.rf0r | 1;  // FMP still counts the frame
  can.on_receive_interrupt();
  hardware.registers.ier = enabled;
  EXPECT_TRUE(can.receive(frame));
  EXPECT_FALSE(can.receive(frame));
}

TEST_F(Stm32Can, SendsTheLowestIdentifierOfTheOldestInEachFifo) {
  start();
  for (const CanFrame& sent : {kHeartbeat, kAnswer, kRpdo, kSync}) ASSERT_TRUE(can.transmit(sent));
  EXPECT_EQ(send_all(), (std::vector<std::uint16_t>{0x210, 0x080, 0x581, 0x701}));
}

TEST_F(Stm32Can, SendsFramesAsTheyWereGiven) {
  start();
  const CanFrame remote{.identifier = 0x210, .size = 8, .remote = true};
  for (const CanFrame& sent : {kRpdo, kAnswer, remote, kHeartbeat}) {
    ASSERT_TRUE(can.transmit(sent));
    EXPECT_EQ(hardware.send(), sent);
  }
}

TEST_F(Stm32Can, ReportsPendingFramesPerFifo) {
  start();
  ASSERT_TRUE(can.transmit(kAnswer));
  EXPECT_TRUE(can.transmit_pending(kAnswerFifo));
  EXPECT_FALSE(can.transmit_pending(kProcessFifo));
  ASSERT_TRUE(hardware.send());
  EXPECT_FALSE(can.transmit_pending(kAnswerFifo));

  // Fills one mailbox and the ring.
  for (std::size_t i = 0; i < Can::kTransmitCapacity + 1; ++i) {
    EXPECT_EQ(can.transmit_space(kProcessFifo),
              i == 0 ? Can::kTransmitCapacity : Can::kTransmitCapacity + 1 - i);
    ASSERT_TRUE(can.transmit(kRpdo));
  }
  EXPECT_EQ(can.transmit_space(kProcessFifo), 0u);
  EXPECT_FALSE(can.transmit(kRpdo));
  EXPECT_TRUE(can.transmit(kHeartbeat));  // the other FIFOs have room
  EXPECT_EQ(send_all().size(), Can::kTransmitCapacity + 2);
}

TEST_F(Stm32Can, ReportsTheErrorStates) {
  start();
  EXPECT_EQ(can.status(), CanStatus{});
  ASSERT_TRUE(can.transmit(kHeartbeat));
  for (int i = 0; i < 15; ++i) hardware.destroy_transmission();
  hardware.destroy_reception();
  EXPECT_EQ(can.status(), (CanStatus{CanErrorState::kErrorActive, 120, 1, 0}));
  hardware.destroy_transmission();
  EXPECT_EQ(can.status().state, CanErrorState::kErrorPassive);
  for (int i = 0; i < 16; ++i) hardware.destroy_transmission();
  EXPECT_EQ(can.status().state, CanErrorState::kBusOff);
  EXPECT_EQ(can.status().transmit_error_count, 255);
}

TEST_F(Stm32Can, StaysBusOffUntilRecoveryIsRequested) {
  start();
  destroy_until_bus_off();
  for (int i = 0; i < 10; ++i) {
    can.update();
    hardware.pass_recessive(100);
  }
  EXPECT_EQ(can.status().state, CanErrorState::kBusOff);
}

TEST_F(Stm32Can, RecoversAfter128TimesElevenRecessiveBits) {
  start();
  destroy_until_bus_off();
  can.recover();
  hardware.settle();
  can.update();
  hardware.pass_recessive(100);
  can.recover();  // the firmware requests recovery in each cycle; a recovery in progress must not restart
  hardware.pass_recessive(27);
  EXPECT_EQ(can.status().state, CanErrorState::kBusOff);
  hardware.pass_recessive(1);
  EXPECT_EQ(can.status(), CanStatus{});
  can.update();
  ASSERT_TRUE(can.transmit(kSync));
  EXPECT_EQ(hardware.send(), kSync);

  destroy_until_bus_off();  // a second time
  can.recover();
  hardware.settle();
  can.update();
  hardware.pass_recessive(128);
  EXPECT_EQ(can.status(), CanStatus{});
}

TEST_F(Stm32Can, SendsNothingFromBeforeTheRecovery) {
  start();
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(can.transmit(kRpdo));
  destroy_until_bus_off();
  can.recover();
  hardware.settle();
  EXPECT_FALSE(can.transmit_pending(kProcessFifo));
  EXPECT_FALSE(can.transmit_pending(kBackgroundFifo));
  EXPECT_EQ(can.transmit_space(kProcessFifo), Can::kTransmitCapacity);
  can.update();
  hardware.pass_recessive(128);
  ASSERT_TRUE(can.transmit(kSync));
  EXPECT_EQ(send_all(), (std::vector<std::uint16_t>{0x080}));
}

TEST_F(Stm32Can, RecoversFromBusOffOnly) {
  start();
  ASSERT_TRUE(can.transmit(kSync));
  can.recover();
  EXPECT_EQ(hardware.send(), kSync);
}

// --- The fake itself, where the driver does not exercise it

TEST(FakeCanRegisters, ProtectsTheBitTimingOutsideInitialisationMode) {
  FakeCanRegisters hardware;
  const std::uint32_t before = hardware.registers.btr;
  hardware.registers.btr = 42;
  hardware.settle();
  EXPECT_EQ(hardware.registers.btr, before);
}

TEST(FakeCanRegisters, FindsAHandlerThatDoesNotClearItsInterrupt) {
  FakeCanRegisters hardware;
  Can can(hardware.registers);
  hardware.connect([] {}, [&] { can.on_transmit_interrupt(); });
  can.start(k1MbitAt42MHz);
  hardware.settle();
  can.update();
  hardware.pass_recessive(1);
  EXPECT_THROW(hardware.deliver(kSync), std::logic_error);
}

TEST(FakeCanRegisters, ReplacesTheNewestFrameOfAFifoThatIsNotLocked) {
  FakeCanRegisters hardware;
  hardware.registers.mcr = mcr::kInrq;
  hardware.settle();
  hardware.registers.fa1r = 1;  // all filters
  hardware.registers.mcr = 0;
  hardware.pass_recessive(1);
  for (std::uint16_t i = 1; i <= 4; ++i) hardware.deliver({.identifier = i});
  EXPECT_EQ(hardware.registers.rf0r, 3 | rf0r::kFull | rf0r::kOverrun);
  std::vector<std::uint32_t> seen;
  for (int i = 0; i < 3; ++i) {
    seen.push_back(hardware.registers.receive[0].identifier >> mailbox::kStidShift);
    hardware.registers.rf0r = rf0r::kRelease;
    hardware.settle();
  }
  EXPECT_EQ(seen, (std::vector<std::uint32_t>{1, 2, 4}));
}

TEST(FakeCanRegisters, SendsInTheOrderOfRequestsWhenConfigured) {
  FakeCanRegisters hardware;
  hardware.registers.mcr = mcr::kInrq | mcr::kTxfp;
  hardware.settle();
  hardware.registers.mcr = mcr::kTxfp;
  hardware.pass_recessive(1);
  hardware.registers.transmit[0].identifier = 0x300u << mailbox::kStidShift | mailbox::kTxrq;
  hardware.settle();
  hardware.registers.transmit[1].identifier = 0x100u << mailbox::kStidShift | mailbox::kTxrq;
  EXPECT_EQ(hardware.send()->identifier, 0x300);
  EXPECT_EQ(hardware.send()->identifier, 0x100);
}

}  // namespace
}  // namespace koboshi::hal::stm32
