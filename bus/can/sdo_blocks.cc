#include "bus/can/sdo_blocks.h"

#include "firmware/canopen/frame.h"
#include "sim_board/drive/pc_sdo.h"

namespace koboshi::bus {
namespace {

struct Channel {
  std::uint16_t request = 0;  // 0: not an SDO frame
  bool is_request = false;
};

Channel channel_of(std::uint16_t identifier) {
  if (sim_board::node_of_pc_sdo_request(identifier) != 0) return {identifier, true};
  if (const int node = sim_board::node_of_pc_sdo_response(identifier); node != 0)
    return {sim_board::pc_sdo_request(node), false};
  const auto node = static_cast<std::uint16_t>(identifier & ~canopen::kFunctionCodeMask);
  const int base = identifier & canopen::kFunctionCodeMask;
  if (base != canopen::kSdoRequestBase && base != canopen::kSdoResponseBase) return {};
  return {static_cast<std::uint16_t>(canopen::kSdoRequestBase + node), base == canopen::kSdoRequestBase};
}

}  // namespace

bool SdoBlocks::follow(const hal::CanFrame& frame) {
  if (hal::is_boot_up(frame)) {  // its transfers ended with the reset
    const int node = frame.identifier & 0x7F;
    channels_.erase(static_cast<std::uint16_t>(canopen::kSdoRequestBase + node));
    if (sim_board::has_pc_sdo(node)) channels_.erase(sim_board::pc_sdo_request(node));
    return false;
  }
  const Channel channel = channel_of(frame.identifier);
  if (channel.request == 0 || frame.remote || frame.size != 8) return false;
  return channels_[channel.request].follow(frame.data, channel.is_request);
}

}  // namespace koboshi::bus
