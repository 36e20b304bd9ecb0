#include "bus/dictionary/configured_drive.h"

#include <span>
#include <stdexcept>
#include <utility>

#include "firmware/canopen/node/node.h"
#include "firmware/canopen/sdo/client.h"
#include "firmware/canopen/sdo/protocol.h"
#include "firmware/drive/configuration.h"
#include "sim_board/drive/drive_dictionary.h"

namespace koboshi::bus {
namespace {

class Wire final : public canopen::FrameSink {
 public:
  bool send(const hal::CanFrame& frame) override {
    frames_.push_back(frame);
    return true;
  }
  std::vector<hal::CanFrame> take() { return std::exchange(frames_, {}); }

 private:
  std::vector<hal::CanFrame> frames_;
};

class DriveNode final : private canopen::NodeApplication {
 public:
  explicit DriveNode(const sim_board::DriveDescription& drive)
      : description_(sim_board::drive_node_description(drive)),
        node_(description_,
              {.node_id = drive.node_id,
               .serial_number = drive.serial_number,
               .values = std::as_writable_bytes(std::span(&values_, 1))},
              memory_.buffers(), wire_, *this) {
    node_.start(0);
    static_cast<void>(wire_.take());
  }

  std::vector<hal::CanFrame> answer(const hal::CanFrame& frame) {
    if ((frame.data[0] & canopen::sdo::kSpecifierMask) == canopen::sdo::kInitiateDownloadRequest) {
      writes_.push_back(decode(frame.data));
    }
    node_.on_frame(frame, 0);
    return wire_.take();
  }

  // Decodes a request of the firmware, which writes only numbers that fit into one.
  ConfiguredDrive::Write decode(const canopen::sdo::Data& request) {
    const canopen::ObjectAddress address{canopen::load_u16(&request[1]), request[3]};
    canopen::Location location;
    const canopen::Dictionary objects(description_.rows, {});
    const bool known = objects.find(address, location) == canopen::AbortCode::kNone;
    const std::uint32_t value = canopen::load_u32(&request[4]);
    return {address, known ? canopen::integer_of(value, location.entry->type) : value};
  }
  const std::vector<ConfiguredDrive::Write>& writes() const { return writes_; }

  std::uint32_t read(std::uint16_t index, std::uint8_t subindex) {
    canopen::ObjectValue value;
    return node_.read_object({index, subindex}, value) == canopen::AbortCode::kNone ? value.number() : 0;
  }

  // The PDOs in use among those whose records begin at these indices.
  std::vector<canopen::PdoConfiguration> pdos(std::uint16_t communication, std::uint16_t mapping) {
    std::vector<canopen::PdoConfiguration> used;
    canopen::ObjectValue value;
    while (node_.read_object({communication, 1}, value) == canopen::AbortCode::kNone) {
      canopen::PdoConfiguration pdo{.cob_id = value.number()};
      pdo.transmission_type = static_cast<std::uint8_t>(read(communication, 2));
      pdo.event_timer_ms = static_cast<std::uint16_t>(read(communication, 5));
      const std::uint32_t count = read(mapping, 0);
      for (std::uint8_t i = 0; i < count; ++i) {
        pdo.mapping[i] = read(mapping, static_cast<std::uint8_t>(i + 1));
      }
      if ((pdo.cob_id & canopen::kCobIdInvalid) == 0) used.push_back(pdo);
      ++communication;
      ++mapping;
    }
    return used;
  }

 private:
  sim_board::DriveValues values_;
  canopen::NodeDescription description_;
  canopen::NodeMemory<4, 4, 2, 8> memory_;
  std::vector<ConfiguredDrive::Write> writes_;
  Wire wire_;
  canopen::Node node_;
};

}  // namespace

ConfiguredDrive configure_drive(const robot::Joint& joint, const sim_board::DriveDescription& drive) {
  DriveNode node(drive);
  Wire wire;
  canopen::SdoClient client(wire);
  drive::Configuration configuration(client);
  configuration.begin(joint);
  for (std::uint64_t now_us = 0; configuration.state() == drive::Configuration::State::kBusy;
       now_us += 1000) {
    configuration.process(now_us);
    for (const hal::CanFrame& request : wire.take()) {
      for (const hal::CanFrame& response : node.answer(request)) client.on_frame(response);
    }
    client.process(now_us);
  }
  if (configuration.state() != drive::Configuration::State::kDone) {
    throw std::logic_error("the firmware could not configure a drive with its own objects");
  }
  return {node.pdos(0x1400, 0x1600), node.pdos(0x1800, 0x1A00),
          static_cast<std::uint16_t>(node.read(0x1017, 0)), node.writes()};
}

}  // namespace koboshi::bus
