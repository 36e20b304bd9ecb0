#include "bus/dictionary/services.h"

#include <utility>

#include "firmware/app/controller_objects.h"
#include "firmware/canopen/described_object.h"
#include "firmware/canopen/frame.h"

namespace koboshi::bus {
namespace {

Signal unsigned_signal(std::string name, unsigned start_bit, unsigned size_bits,
                       std::span<const canopen::ValueName> values = {}) {
  return integer_signal(
      {.name = std::move(name), .start_bit = start_bit, .size_bits = size_bits, .values = values});
}

Message message(unsigned identifier, std::string name, std::string sender, std::vector<Signal> signals) {
  Message made;
  made.identifier = static_cast<std::uint16_t>(identifier);
  made.name = std::move(name);
  made.sender = std::move(sender);
  made.signals = std::move(signals);
  if (!made.signals.empty()) {
    made.size_bytes = (made.signals.back().start_bit + made.signals.back().size_bits) / 8;
  }
  return made;
}

Message with_receiver(Message made, const std::string& receiver) {
  for (Signal& signal : made.signals) signal.receivers = {receiver};
  return made;
}

}  // namespace

Signal integer_signal(Signal signal) {
  const std::int64_t values = std::int64_t{1} << signal.size_bits;
  signal.low_raw = signal.is_signed ? -values / 2 : 0;
  signal.high_raw = signal.is_signed ? values / 2 - 1 : values - 1;
  return signal;
}

Message nmt_message(const std::string& master) {
  Message made = message(
      canopen::kNmtCobId, "NMT", master,
      {unsigned_signal("command", 0, 8, canopen::kNmtCommandNames), unsigned_signal("node_id", 8, 8)});
  made.signals.back().comment = "0: every node.";
  return made;
}

Message sync_message(const std::string& producer, std::uint32_t cycle_time_ms) {
  Message made = message(canopen::kSyncCobId, "SYNC", producer, {});
  made.cycle_time_ms = cycle_time_ms;
  made.comment = "The drives take over their targets and sample what they answer.";
  return made;
}

Message emergency_message(std::uint8_t node_id, const std::string& node, const std::string& receiver,
                          bool controller) {
  std::vector<Signal> signals{unsigned_signal("error_code", 0, 16, canopen::kErrorCodeNames),
                              unsigned_signal("error_register", 16, 8)};
  if (controller) {
    signals.push_back(unsigned_signal("state", 24, 8, app::kStateNames));
    signals.push_back(unsigned_signal("reason", 32, 8, app::kReasonNames));
    signals.push_back(unsigned_signal("drive_fault", 40, 8, app::kDriveFaultNames));
    signals.push_back(unsigned_signal("faulty_joint", 48, 8));
    signals.push_back(unsigned_signal("reserved", 56, 8));
  } else {
    signals.push_back(unsigned_signal("manufacturer_error", 24, 40));
  }
  return with_receiver(message(canopen::kEmergencyBase + node_id, node + "_EMCY", node, std::move(signals)),
                       receiver);
}

Message heartbeat_message(std::uint8_t node_id, const std::string& node, const std::string& receiver,
                          std::uint32_t period_ms) {
  Message made = message(canopen::kHeartbeatBase + node_id, node + "_heartbeat", node,
                         {unsigned_signal("nmt_state", 0, 8, canopen::kNmtStateNames)});
  made.cycle_time_ms = period_ms;
  return with_receiver(std::move(made), receiver);
}

std::array<Message, 2> sdo_messages(std::uint8_t node_id, const std::string& node,
                                    const std::string& client) {
  const std::vector<Signal> signals{unsigned_signal("command", 0, 8), unsigned_signal("index", 8, 16),
                                    unsigned_signal("subindex", 24, 8), unsigned_signal("data", 32, 32)};
  Message request = message(canopen::kSdoRequestBase + node_id, node + "_SDO_rx", client, signals);
  request.comment = "SDO request; in a segmented transfer, seven bytes of data follow the command.";
  Message response = message(canopen::kSdoResponseBase + node_id, node + "_SDO_tx", node, signals);
  response.comment = "SDO response; in a segmented transfer, seven bytes of data follow the command.";
  return {with_receiver(std::move(request), node), with_receiver(std::move(response), client)};
}

}  // namespace koboshi::bus
