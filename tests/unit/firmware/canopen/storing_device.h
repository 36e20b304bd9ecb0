#pragma once

#include <gtest/gtest.h>

#include <optional>
#include <vector>

#include "firmware/canopen/node/stored_parameters.h"
#include "hal/fake/storage.h"
#include "tests/unit/firmware/canopen/storing_node.h"

namespace koboshi::canopen {

inline const NodeDescription kStoringDescription = storing_description();

// A device with its node and a flash that survives every restart.
class Device final : public NodeApplication, public DeviceOwner {
 public:
  explicit Device(hal::FakeStorage& flash, std::uint8_t node_id = 0x10)
      : services({1, 2, 3, 4}, *this),
        node(kStoringDescription,
             {.node_id = node_id,
              .serial_number = 1,
              .values = std::as_writable_bytes(std::span(&values, 1)),
              .services = &services},
             memory.buffers(), sink, *this),
        items(flash, kSectors * 2048),
        parameters(items, node) {
    services.start(node_id);
    node.start(0);
  }

  AbortCode on_store(ParameterGroup group) override { return parameters.store(group); }
  AbortCode on_restore(ParameterGroup group) override { return parameters.restore(group); }
  void on_reset(NmtCommand reset) override {
    if (reset == NmtCommand::kResetNode) values = {};
    parameters.load(reset == NmtCommand::kResetNode ? ParameterGroup::kAll : ParameterGroup::kCommunication);
  }

  void pass_a_millisecond() {
    items.process();
    parameters.process();
  }
  // Writes by SDO and returns the final result for the client.
  AbortCode write(ObjectAddress address, std::uint32_t value, std::size_t size) {
    AbortCode code = node.write_object(address, value, size);
    for (int ms = 0; code == AbortCode::kBusy && ms < 1000; ++ms) {
      pass_a_millisecond();
      code = node.write_object(address, value, size);
    }
    return code;
  }
  AbortCode save(std::uint8_t subindex = 1) { return write({0x1010, subindex}, kSave, 4); }
  AbortCode load(std::uint8_t subindex = 1) { return write({0x1011, subindex}, kLoad, 4); }
  std::uint32_t read(std::uint16_t index, std::uint8_t subindex = 0) {
    ObjectValue value;
    EXPECT_EQ(node.read_object({index, subindex}, value), AbortCode::kNone) << std::hex << index;
    return value.number();
  }

  TestValues values;
  RecordingSink sink;
  NodeMemory<2, 2, 3, 4> memory;
  DeviceServices services;
  Node node;
  storage::ItemStore items;
  StoredParameters parameters;
};

class StoredParametersTest : public testing::Test {
 protected:
  StoredParametersTest() { flash.complete_after(2); }

  void restart(std::uint8_t node_id = 0x10) {
    flash.lose_power();
    device.emplace(flash, node_id);
  }

  hal::FakeStorage flash{kSectors, 2048};
  std::optional<Device> device{std::in_place, flash};
};

}  // namespace koboshi::canopen
