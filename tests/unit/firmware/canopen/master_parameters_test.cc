#include <gtest/gtest.h>

#include <optional>
#include <utility>
#include <vector>

#include "firmware/canopen/node/stored_parameters.h"
#include "hal/fake/storage.h"
#include "tests/unit/firmware/canopen/storing_node.h"

namespace koboshi::canopen {
namespace {

constexpr PdoConfiguration master_rpdo(std::size_t number) {
  return {.cob_id = static_cast<std::uint32_t>(0x190 + number), .mapping = {mapping(0x607A, 0, 32)}};
}

NodeDescription master_description() {
  NodeDescription made = storing_description();
  made.field_device = false;
  made.sync_producer = true;
  made.sync_period_us = 10'000;
  made.sync_by_owner = true;
  made.tpdos = {};
  return made;
}
const NodeDescription kMasterDescription = master_description();

// It has none of a device's services, produces SYNC, and its PDOs depend on its network.
class Master final : public NodeApplication {
 public:
  explicit Master(hal::FakeStorage& flash)
      : node(kMasterDescription,
             {.node_id = 1, .serial_number = 1, .values = std::as_writable_bytes(std::span(&values, 1))},
             memory.buffers(), sink, *this),
        items(flash, kSectors * 2048),
        parameters(items, node) {
    node.start(0);
  }

  AbortCode on_store(ParameterGroup group) override { return parameters.store(group); }
  PdoConfiguration default_pdo(PdoDirection direction, std::size_t number) override {
    return direction == PdoDirection::kReceive ? master_rpdo(number) : PdoConfiguration{};
  }
  std::uint32_t default_consumer(std::size_t number) override {
    return number < 2 ? static_cast<std::uint32_t>((0x10 + number) << 16 | 100) : 0;
  }
  void on_reset(NmtCommand) override { parameters.load(); }

  void save() {
    AbortCode code = AbortCode::kBusy;
    for (int ms = 0; code == AbortCode::kBusy && ms < 1000; ++ms) {
      items.process();
      parameters.process();
      code = node.write_object({0x1010, 2}, kSave, 4);
    }
    ASSERT_EQ(code, AbortCode::kNone);
  }
  std::uint32_t read(ObjectAddress address) {
    ObjectValue value;
    EXPECT_EQ(node.read_object(address, value), AbortCode::kNone) << std::hex << address.index;
    return value.number();
  }

  TestValues values;
  RecordingSink sink;
  NodeMemory<2, 2, 3, 4> memory;
  Node node;
  storage::ItemStore items;
  StoredParameters parameters;
};

TEST(Master, StoresItsCommunicationParameters) {
  hal::FakeStorage flash(kSectors, 2048);
  flash.complete_after(2);
  const std::vector<std::pair<ObjectAddress, std::uint32_t>> sequence{
      {{0x1400, 1}, 0x8000'0190}, {{0x1401, 1}, 0x8000'0191},  // two RPDOs exchange their identifiers
      {{0x1400, 1}, 0x0000'0191}, {{0x1401, 1}, 0x0000'0190}, {{0x1400, 5}, 70},
      {{0x1016, 1}, 0},           {{0x1016, 2}, 0},  // and two consumers
      {{0x1016, 1}, 0x0011'0064}, {{0x1016, 2}, 0x0010'0064}, {{0x1006, 0}, 0},
      {{0x1019, 0}, 20},          {{0x1006, 0}, 10'000},  // SYNC with a counter
      {{0x1005, 0}, 0x0000'0080}, {{0x1005, 0}, 0x4000'0082},
  };
  std::optional<Master> master(std::in_place, flash);
  for (const auto& [address, value] : sequence) {
    ASSERT_EQ(master->node.write_object(address, value, 0), AbortCode::kNone) << std::hex << address.index;
  }
  std::vector<std::uint32_t> written;
  for (const auto& [address, value] : sequence) written.push_back(master->read(address));
  master->save();
  flash.lose_power();
  master.emplace(flash);
  for (std::size_t i = 0; i < sequence.size(); ++i) {
    const ObjectAddress address = sequence[i].first;
    EXPECT_EQ(master->read(address), written[i]) << std::hex << address.index << " " << int{address.subindex};
  }
}

}  // namespace
}  // namespace koboshi::canopen
