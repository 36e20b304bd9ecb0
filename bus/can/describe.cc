#include "bus/can/describe.h"

#include <fmt/core.h>

#include "bus/can/sdo_transfer.h"
#include "firmware/canopen/described_object.h"
#include "firmware/canopen/dictionary.h"
#include "firmware/canopen/frame.h"
#include "firmware/canopen/lss_slave.h"
#include "firmware/canopen/sdo/protocol.h"
#include "sim_board/drive/pc_sdo.h"

namespace koboshi::bus {
namespace {

using canopen::load_u16;
namespace sdo = canopen::sdo;

std::string node_name(int node) { return node == 0 ? "all nodes" : fmt::format("node {}", node); }

std::string name_or(std::span<const canopen::ValueName> names, std::uint8_t value, const char* unknown) {
  const std::string_view name = canopen::name_of(names, value);
  return std::string(name.empty() ? unknown : name);
}

std::string command_name(std::uint8_t command) {
  return name_or(canopen::kNmtCommandNames, command, "unknown command");
}

std::string state_name(std::uint8_t state) {
  return name_or(canopen::kNmtStateNames, state & 0x7F,
                 "unknown state");  // bit 7 is the toggle of node guarding
}

// Classes of error codes by their high byte (CiA 301, table 26).
struct EmergencyClass {
  int first;
  int last;
  const char* name;
};
constexpr EmergencyClass kEmergencyClasses[] = {
    {0x00, 0x00, "error reset or no error"},
    {0x10, 0x10, "generic error"},
    {0x20, 0x23, "current"},
    {0x30, 0x33, "voltage"},
    {0x40, 0x43, "temperature"},
    {0x50, 0x50, "device hardware"},
    {0x60, 0x63, "device software"},
    {0x70, 0x71, "additional modules"},
    {0x73, 0x73, "additional modules"},
    {0x80, 0x81, "communication"},
    {0x82, 0x82, "protocol"},
    {0x84, 0x86, "velocity or position control"},
    {0x90, 0x90, "external error"},
    {0xFF, 0xFF, "device specific"},
};

const char* emergency_class(std::uint16_t code) {
  for (const EmergencyClass& one : kEmergencyClasses) {
    if (one.first <= code >> 8 && code >> 8 <= one.last) return one.name;
  }
  return "error";
}

// An object of a node by its address and, if that is known, its name.
struct Object {
  int node;
  const ObjectNames& names;

  std::string text(const sdo::Data& data) const {
    const canopen::ObjectAddress address = sdo::address_of(data);
    std::string text = fmt::format("{:04X}:{:02X}", address.index, address.subindex);
    const std::string name = names ? names(node, address) : "";
    return name.empty() ? text : text + " " + name;
  }
};

std::string expedited_text(const sdo::Data& data) {
  std::string text = "0x";
  for (std::size_t i = sdo::expedited_size(data[0]); i-- > 0;) text += fmt::format("{:02X}", data[4 + i]);
  return text;
}

std::string initiate_text(const char* what, const Object& object, const sdo::Data& data,
                          std::uint8_t initiate, bool carries) {
  std::string text = fmt::format("{} {}", what, object.text(data));
  if (!carries) return text;
  if (sdo::is_expedited(data[0], initiate)) return text + " = " + expedited_text(data);
  return (data[0] & sdo::kSizeIndicated) != 0 ? fmt::format("{}, {} bytes", text, sdo::data_of(data)) : text;
}

std::string sdo_text(const hal::CanFrame& frame, bool request, const Object& object) {
  const sdo::Data& data = frame.data;
  if (data[0] == sdo::kAbort) {
    const auto code = static_cast<canopen::AbortCode>(sdo::data_of(data));
    return fmt::format("abort {}: {:08X} {}", object.text(data), static_cast<std::uint32_t>(code),
                       text_of(code));
  }
  switch (data[0] & sdo::kSpecifierMask) {
    case 0x00:
      return request ? "write segment" : "read segment answered";
    case 0x20:
      return request ? initiate_text("write", object, data, sdo::kInitiateDownloadRequest, true)
                     : "write segment done";
    case 0x40:
      return request ? initiate_text("read", object, data, 0, false)
                     : initiate_text("read answered", object, data, sdo::kInitiateUploadResponse, true);
    case 0x60:
      return request ? "read segment" : initiate_text("write done", object, data, 0, false);
    default:
      return "block transfer";
  }
}

std::string segment_text(std::uint8_t command) {
  return fmt::format("block segment {}{}", command & ~sdo::kBlockLastSegment & 0xFF,
                     (command & sdo::kBlockLastSegment) != 0 ? ", the last" : "");
}

// Returns the drive whose second SDO channel (0x1201) has this identifier, or 0.
int second_channel_of(std::uint16_t identifier) {
  const int node = sim_board::node_of_pc_sdo_request(identifier);
  return node != 0 ? node : sim_board::node_of_pc_sdo_response(identifier);
}

bool is_request(std::uint16_t identifier) {
  return (identifier & canopen::kFunctionCodeMask) == canopen::kSdoRequestBase ||
         sim_board::node_of_pc_sdo_request(identifier) != 0;
}

std::string emergency_text(const hal::CanFrame& frame) {
  const std::uint16_t code = load_u16(frame.data.data());
  return fmt::format("{:04X} {}, register {:02X}", code, code == 0 ? "no error" : emergency_class(code),
                     frame.data[2]);
}

}  // namespace

FrameKind kind_of(const hal::CanFrame& frame) {
  const std::uint16_t identifier = frame.identifier;
  if (identifier == canopen::kNmtCobId) return FrameKind::kNmt;
  if (identifier == canopen::kSyncCobId) return FrameKind::kSync;
  if (identifier == 0x100) return FrameKind::kTime;
  if (identifier == canopen::kLssRequestCobId || identifier == canopen::kLssResponseCobId)
    return FrameKind::kLss;
  if (second_channel_of(identifier) != 0) return FrameKind::kSdo;
  switch (identifier & canopen::kFunctionCodeMask) {
    case canopen::kEmergencyBase:
      return FrameKind::kEmergency;
    case canopen::kSdoResponseBase:
    case canopen::kSdoRequestBase:
      return FrameKind::kSdo;
    case canopen::kHeartbeatBase:
      return FrameKind::kHeartbeat;
    default:
      return identifier >= 0x181 && identifier < canopen::kSdoResponseBase ? FrameKind::kPdo
                                                                           : FrameKind::kOther;
  }
}

int node_of(const hal::CanFrame& frame) {
  const FrameKind kind = kind_of(frame);
  if (kind == FrameKind::kNmt) return frame.size > 1 ? frame.data[1] : 0;
  if (const int node = second_channel_of(frame.identifier); node != 0) return node;
  const bool of_all = kind == FrameKind::kSync || kind == FrameKind::kTime || kind == FrameKind::kLss;
  return of_all ? 0 : frame.identifier & 0x7F;
}

std::string describe(const hal::CanFrame& frame, const ObjectNames& names, bool is_segment) {
  const int node = node_of(frame);
  if (frame.remote) return fmt::format("remote request of {}", node_name(node));
  switch (kind_of(frame)) {
    case FrameKind::kNmt:
      return frame.size == 2 ? fmt::format("NMT {}: {}", node_name(node), command_name(frame.data[0]))
                             : "NMT of wrong length";
    case FrameKind::kSync:
      return frame.size == 0 ? "SYNC" : fmt::format("SYNC {}", frame.data[0]);
    case FrameKind::kEmergency:
      return frame.size == 8 ? fmt::format("EMCY {}: {}", node_name(node), emergency_text(frame))
                             : "EMCY of wrong length";
    case FrameKind::kTime:
      return "TIME";
    case FrameKind::kHeartbeat:
      return frame.size == 1 ? fmt::format("heartbeat {}: {}", node_name(node), state_name(frame.data[0]))
                             : "heartbeat of wrong length";
    case FrameKind::kLss:
      return describe_lss(frame);
    case FrameKind::kSdo: {
      const bool request = is_request(frame.identifier);
      const char* channel = second_channel_of(frame.identifier) != 0 ? "second SDO" : "SDO";
      if (is_segment) return fmt::format("{} {}: {}", channel, node_name(node), segment_text(frame.data[0]));
      return frame.size == 8
                 ? fmt::format("{} {}: {}", channel, node_name(node), sdo_text(frame, request, {node, names}))
                 : "SDO of wrong length";
    }
    default:
      return {};
  }
}

}  // namespace koboshi::bus
