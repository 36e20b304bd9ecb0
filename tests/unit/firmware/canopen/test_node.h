#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <ostream>
#include <span>
#include <vector>

#include "firmware/canopen/node/device_services.h"
#include "firmware/canopen/node/node.h"

namespace koboshi::hal {

// Prints a frame in candump's format in GoogleTest's messages.
inline void PrintTo(const CanFrame& frame, std::ostream* out) {
  static constexpr char kHex[] = "0123456789ABCDEF";
  for (int shift = 8; shift >= 0; shift -= 4) *out << kHex[(frame.identifier >> shift) & 15];
  *out << (frame.remote ? "#R" : "#");
  for (std::size_t i = 0; i < frame.size; ++i) *out << kHex[frame.data[i] >> 4] << kHex[frame.data[i] & 15];
}

}  // namespace koboshi::hal

namespace koboshi::canopen {

inline hal::CanFrame can_frame(std::uint16_t identifier, std::initializer_list<unsigned> bytes) {
  hal::CanFrame frame{.identifier = identifier, .size = static_cast<std::uint8_t>(bytes.size())};
  std::transform(bytes.begin(), bytes.end(), frame.data.begin(),
                 [](unsigned byte) { return static_cast<std::uint8_t>(byte); });
  return frame;
}

// Records sent frames while there is room.
class RecordingSink final : public FrameSink {
 public:
  bool send(const hal::CanFrame& frame) override {
    if (room == 0) return false;
    --room;
    frames.push_back(frame);
    return true;
  }
  // Returns the frames sent since the last call.
  std::vector<hal::CanFrame> take() { return std::exchange(frames, {}); }

  bool pending(hal::TransmitFifo fifo) const override { return beats_wait && fifo == hal::kBackgroundFifo; }

  std::size_t room = 1'000'000;
  bool beats_wait = false;  // true: the bus is full of SDO messages, so heartbeats wait
  std::vector<hal::CanFrame> frames;
};

// A small device with one object of each kind.
struct TestValues {
  std::uint16_t controlword = 0;
  std::int32_t target = 0;
  std::uint16_t statusword = 0;
  std::int32_t position = 0;
  std::int8_t mode = 0;
  std::uint8_t secret = 0;
  bool flag = false;
  std::int16_t torque = 0;
  std::uint32_t gains[3] = {};
};

inline constexpr Entry kTestRows[] = {
    object(0x2000, 1, KOBOSHI_FIELD(TestValues, gains[0]), Access::kReadWrite, Mappable::kBoth)
        .repeated(3, sizeof(std::uint32_t)),
    object(0x2001, 0, KOBOSHI_FIELD(TestValues, secret), Access::kWriteOnly),
    object(0x2002, 0, KOBOSHI_FIELD(TestValues, flag), Access::kReadWrite),
    domain(0x2100, 1, Access::kReadWrite),
    domain(0x2100, 2, Access::kReadOnly),
    domain(0x2100, 3, Access::kWriteOnly),
    domain(0x2100, 4, Access::kReadWrite),
    object(0x6040, 0, KOBOSHI_FIELD(TestValues, controlword), Access::kReadWrite, Mappable::kRpdo),
    object(0x6041, 0, KOBOSHI_FIELD(TestValues, statusword), Access::kReadOnly, Mappable::kTpdo),
    object(0x6060, 0, KOBOSHI_FIELD(TestValues, mode), Access::kReadWrite, Mappable::kRpdo)
        .within<std::int8_t>(-1, 10),
    object(0x6064, 0, KOBOSHI_FIELD(TestValues, position), Access::kReadOnly, Mappable::kTpdo),
    object(0x6077, 0, KOBOSHI_FIELD(TestValues, torque), Access::kReadOnly, Mappable::kTpdo),
    object(0x607A, 0, KOBOSHI_FIELD(TestValues, target), Access::kReadWrite, Mappable::kRpdo)
        .within<std::int32_t>(-1000, 1000),
    constant<std::uint32_t>(0x6502, 0, 0x80),
};
static_assert(is_valid_table(kTestRows, sizeof(TestValues)));

inline constexpr PdoConfiguration kTestRpdos[] = {
    {.cob_id = kRpdo1Base,
     .plus_node_id = true,
     .transmission_type = kSynchronousEverySync,
     .mapping = {mapping(0x6040, 0, 16), mapping(0x607A, 0, 32)}},
    {.cob_id = kRpdo1Base + kPdoStep, .plus_node_id = true, .mapping = {mapping(0x6040, 0, 16)}},
};

inline constexpr PdoConfiguration kTestTpdos[] = {
    {.cob_id = kTpdo1Base,
     .plus_node_id = true,
     .transmission_type = kSynchronousEverySync,
     .mapping = {mapping(0x6041, 0, 16), mapping(0x6064, 0, 32), mapping(0x6077, 0, 16)}},
    {.cob_id = kTpdo1Base + kPdoStep, .plus_node_id = true, .mapping = {mapping(0x6041, 0, 16)}},
};

inline constexpr NodeDescription kTestDescription{
    .device_type = 0x00020192,
    .vendor_id = 0x11223344,
    .product_code = 0x55,
    .revision_number = 0x00010002,
    .device_name = "Koboshi test node",
    .hardware_version = "A",
    .software_version = "1.0.0",
    .stored_groups = group_bit(ParameterGroup::kAll),
    .rows = kTestRows,
    .rpdos = kTestRpdos,
    .tpdos = kTestTpdos,
    .watched_tpdos = 0,
};

// The same node as a field device.
inline const NodeDescription kTestDevice = [] {
  NodeDescription description = kTestDescription;
  description.field_device = true;
  return description;
}();

// A DOMAIN in memory with settable verdicts.
class TestDomain final : public Domain {
 public:
  AbortCode begin_upload(std::uint32_t& size_bytes) override {
    if (announces) size_bytes = static_cast<std::uint32_t>(bytes.size());
    return begun(begin_verdict);
  }
  std::size_t read(std::uint32_t position, std::span<std::uint8_t> out) override {
    const std::size_t size =
        std::min(out.size(), bytes.size() - std::min<std::size_t>(position, bytes.size()));
    std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(position), size, out.begin());
    return size;
  }
  AbortCode begin_download(std::uint32_t size_bytes) override {
    announced = size_bytes;
    arriving.clear();
    return begun(begin_verdict);
  }
  AbortCode write(std::span<const std::uint8_t> piece) override {
    if (write_verdict != AbortCode::kBusy) arriving.insert(arriving.end(), piece.begin(), piece.end());
    return write_verdict;
  }
  AbortCode commit() override {
    if (commit_verdict == AbortCode::kNone) bytes = arriving;
    return commit_verdict;
  }
  void release() override { --open; }

  std::vector<std::uint8_t> bytes;
  std::vector<std::uint8_t> arriving;
  bool announces = true;
  std::uint32_t announced = 0;
  int open = 0;  // transfers that are begun and not yet released
  int begun_count = 0;
  AbortCode begin_verdict = AbortCode::kNone;
  AbortCode write_verdict = AbortCode::kNone;
  AbortCode commit_verdict = AbortCode::kNone;

 private:
  AbortCode begun(AbortCode verdict) {
    if (verdict == AbortCode::kNone) {
      ++open;
      ++begun_count;
    }
    return verdict;
  }
};

inline std::vector<std::uint8_t> counted_bytes(std::size_t count) {
  std::vector<std::uint8_t> bytes(count);
  for (std::size_t i = 0; i < count; ++i) bytes[i] = static_cast<std::uint8_t>(i * 7 + i / 256);
  return bytes;
}

inline const hal::CanFrame kSync = can_frame(0x080, {});

// A node and its owner, which records the callbacks.
class TestNode final : public NodeApplication, public DeviceOwner {
 public:
  explicit TestNode(std::uint8_t node_id = 0x10, const NodeDescription& description = kTestDescription)
      : TestNode(node_id, description, sink) {}
  TestNode(std::uint8_t node_id, const NodeDescription& description, FrameSink& other_sink)
      : services({description.vendor_id, description.product_code, description.revision_number, 0xCAFE},
                 *this),
        node(description,
             {.node_id = node_id,
              .serial_number = 0xCAFE,
              .values = std::as_writable_bytes(std::span(&values, 1)),
              .services = description.field_device ? &services : nullptr},
             memory.buffers(), other_sink, *this) {}
  TestNode(const TestNode&) = delete;

  // Brings the node to operational and clears the recorded frames.
  void make_operational(std::uint64_t now_us = 0) {
    start(node.node_id(), now_us);
    node.command(NmtCommand::kStart, now_us);
    sink.frames.clear();
  }
  // Powers on a device with this stored node id.
  void start(std::uint8_t node_id, std::uint64_t now_us) {
    services.start(node_id);
    node.start(now_us);
  }
  // Passes a frame to the node, as a device's owner does.
  void hear(const hal::CanFrame& frame, std::uint64_t now_us) {
    const bool device = node.description().field_device;
    if (!device || !services.on_frame(node, frame, now_us)) node.on_frame(frame, now_us);
  }
  // Returns the frames with which the node answers this one.
  std::vector<hal::CanFrame> ask(const hal::CanFrame& frame, std::uint64_t now_us = 0) {
    sink.frames.clear();
    hear(frame, now_us);
    return sink.take();
  }

  AbortCode on_write(ObjectAddress address, std::uint32_t value) override {
    written.push_back({address, value});
    return verdict;
  }
  Domain* domain(ObjectAddress address) override { return address.subindex == 4 ? nullptr : &bytes; }
  AbortCode on_store(ParameterGroup group) override {
    stored.push_back(group);
    return verdict;
  }
  AbortCode on_restore(ParameterGroup group) override {
    restored.push_back(group);
    return verdict;
  }
  AbortCode on_store_node_id(std::uint8_t node_id) override {
    stored_node_ids.push_back(node_id);
    return verdict;
  }
  void on_node_id(std::uint8_t node_id) override { node_ids.push_back(node_id); }
  void on_time(const TimeOfDay& time) override { times.push_back(time); }
  void on_reset(NmtCommand reset) override { resets.push_back(reset); }
  void on_state(NmtState state) override { states.push_back(state); }
  void on_sync(std::uint64_t) override {
    ++syncs;
    values.statusword = next_statusword;
  }
  bool on_rpdo(std::size_t number) override {
    rpdos.push_back(number);
    return takes_rpdos;
  }
  bool on_rpdo_timeout(std::size_t number) override {
    silent_rpdos.push_back(number);
    return true;
  }
  void on_heartbeat(const HeartbeatEvent& event) override { heartbeats.push_back(event); }
  void on_emergency(const Emergency& emergency) override { emergencies.push_back(emergency); }
  void on_impostor(std::uint16_t identifier) override { impostors.push_back(identifier); }

  struct Write {
    ObjectAddress address;
    std::uint32_t value;
  };

  TestValues values;
  TestDomain bytes;
  std::vector<ParameterGroup> stored;
  std::vector<ParameterGroup> restored;
  RecordingSink sink;
  NodeMemory<4, 4, 3, 4> memory;
  AbortCode verdict = AbortCode::kNone;
  std::uint16_t next_statusword = 0;
  int syncs = 0;
  std::vector<Write> written;
  std::vector<NmtCommand> resets;
  std::vector<std::uint8_t> stored_node_ids;
  std::vector<std::uint8_t> node_ids;
  std::vector<TimeOfDay> times;
  std::vector<NmtState> states;
  std::vector<std::size_t> rpdos;
  bool takes_rpdos = true;
  std::vector<std::size_t> silent_rpdos;
  std::vector<HeartbeatEvent> heartbeats;
  std::vector<Emergency> emergencies;
  DeviceServices services;
  std::vector<std::uint16_t> impostors;
  Node node;
};

}  // namespace koboshi::canopen
