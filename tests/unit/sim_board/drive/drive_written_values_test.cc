#include <array>
#include <optional>

#include "tests/support/random_frames.h"
#include "tests/unit/sim_board/drive/drive_bench.h"

// One check judges a value, whichever service writes it.
namespace koboshi::sim_board {
namespace {

class WrittenValues : public DriveTest {
 protected:
  // RPDO 2 carries this object alone; event-driven.
  void map(ObjectAddress address, std::size_t size) {
    write({0x1401, 1}, 0x8000'0000u + 0x300 + kNode, 4);
    write({0x1401, 2}, 255, 1);
    write({0x1601, 0}, 0, 1);
    write({0x1601, 1}, canopen::mapping(address.index, address.subindex, static_cast<std::uint8_t>(8 * size)),
          4);
    write({0x1601, 0}, 1, 1);
    write({0x1401, 1}, 0x300 + kNode, 4);
    say({.identifier = 0x000, .size = 2, .data = {1, kNode}});
    run_ms(2);
  }
  void send(std::uint32_t value, std::size_t size) {
    hal::CanFrame frame{.identifier = 0x300 + kNode, .size = static_cast<std::uint8_t>(size)};
    canopen::store_u32(frame.data.data(), value);
    say(frame);
    run_ms(2);
  }
  std::uint32_t read(ObjectAddress address) {
    heard.clear();
    hal::CanFrame frame{.identifier = 0x600 + kNode, .size = 8};
    frame.data = canopen::sdo::message(canopen::sdo::kInitiateUploadRequest, address, 0);
    say(frame);
    run_ms(2);
    for (const hal::CanFrame& answer : heard) {
      if (answer.identifier == 0x580 + kNode) return canopen::load_u32(&answer.data[4]);
    }
    ADD_FAILURE() << "no answer";
    return 0;
  }
  std::optional<hal::CanFrame> emergency() const {
    for (const hal::CanFrame& frame : heard) {
      if (frame.identifier == 0x080 + kNode) return frame;
    }
    return std::nullopt;
  }
};

TEST_F(WrittenValues, AreIgnoredByAPdoWithAnEmergencyIfSdoRefusesThem) {
  struct Refused {
    ObjectAddress address;
    std::size_t size;
    std::uint32_t value;
  };
  for (const auto& [address, size, value] :
       {Refused{{0x6084, 0}, 4, 0}, Refused{{0x6083, 0}, 4, 999}, Refused{{0x6081, 0}, 4, 0},
        Refused{{0x6081, 0}, 4, 0xFFFF'FFFF}, Refused{{0x6060, 0}, 1, 3}, Refused{{0x6060, 0}, 1, 7},
        Refused{{0x6060, 0}, 1, 0xFF}}) {
    SCOPED_TRACE(testing::Message() << std::hex << address.index << " = " << value);
    EXPECT_NE(abort_of(address, value, size), 0u);
    map(address, size);
    const std::uint32_t before = read(address);
    heard.clear();
    send(value, size);
    const auto told = emergency();
    ASSERT_TRUE(told);
    EXPECT_EQ(canopen::load_u16(&told->data[0]), 0x6320);
    EXPECT_EQ(canopen::load_u16(&told->data[3]), address.index);
    EXPECT_EQ(told->data[5], address.subindex);
    EXPECT_EQ(told->data[6], 2);
    EXPECT_EQ(read(address), before);
    heard.clear();
    send(before, size);
    ASSERT_TRUE(emergency());
    EXPECT_EQ(canopen::load_u16(&emergency()->data[0]), 0);
  }
}

// Every object that an RPDO may write, with values at the ends of every type and at random.
TEST_F(WrittenValues, AreJudgedAlikeByPdoAndSdo) {
  test::Random random(20261125);
  const auto description = drive_node_description(joint.drive);
  for (const canopen::Entry& row : description.rows) {
    const bool by_rpdo = row.mappable == canopen::Mappable::kRpdo || row.mappable == canopen::Mappable::kBoth;
    if (!by_rpdo) continue;
    const ObjectAddress address{row.index, row.subindex};
    const std::size_t size = canopen::size_bytes(row.type);
    std::vector<std::uint32_t> values{0,   1,     2,    3,    6,           7,           8,          9,
                                      999, 1'000, 0x7F, 0x80, 0x7FFF'FFFF, 0x8000'0000, 0xFFFF'FFFF};
    for (int i = 0; i < 20; ++i) values.push_back(random.next() >> random.below(32));
    map(address, size);
    for (const std::uint32_t value : values) {
      const std::uint32_t mask = size == 4 ? 0xFFFF'FFFF : (1u << (8 * size)) - 1;
      const std::uint32_t before = read(address) & mask;
      const bool accepted = abort_of(address, value, size) == 0;
      write(address, before, size);
      send(value, size);
      EXPECT_EQ(read(address) & mask, accepted ? value & mask : before)
          << std::hex << address.index << " = " << value;
      write(address, before, size);
    }
  }
}

// The rest of the PDO is processed: a controlword is obeyed whatever stands beside it.
TEST_F(WrittenValues, DoNotKeepAPdoFromStoppingTheDrive) {
  enable();
  write({0x1401, 1}, 0x8000'0000u + 0x300 + kNode, 4);
  write({0x1401, 2}, 255, 1);
  write({0x1601, 0}, 0, 1);
  write({0x1601, 1}, 0x6060'0008, 4);
  write({0x1601, 2}, 0x6040'0010, 4);
  write({0x1601, 0}, 2, 1);
  write({0x1401, 1}, 0x300 + kNode, 4);
  say({.identifier = 0x300 + kNode, .size = 3, .data = {99, 0x02, 0x00}});
  run_ms(2);
  EXPECT_EQ(drive->state(), State::kQuickStopActive);
  EXPECT_EQ(drive->values().mode, 8);
}

}  // namespace
}  // namespace koboshi::sim_board
