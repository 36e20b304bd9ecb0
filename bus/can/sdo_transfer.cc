#include "bus/can/sdo_transfer.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <thread>
#include <utility>

#include "bus/can/source.h"
#include "firmware/canopen/frame.h"
#include "firmware/canopen/sdo/protocol.h"
#include "sim_board/drive/pc_sdo.h"

namespace koboshi::bus {
namespace {

using canopen::AbortCode;
using canopen::ObjectAddress;
namespace sdo = canopen::sdo;
using Clock = std::chrono::steady_clock;

std::size_t segments_of(std::size_t bytes) { return (bytes + sdo::kSegmentBytes - 1) / sdo::kSegmentBytes; }

// The pauses before a transfer is repeated: 20, 40, 80 ms. A controller that configures a node sends it a
// request every few milliseconds, for less than 100 ms.
constexpr std::chrono::milliseconds kPause{10};

// Abort codes of a transfer into which another client's came.
bool is_disturbance(AbortCode code) {
  return code == AbortCode::kCommandSpecifierUnknown || code == AbortCode::kToggleBitNotAlternated ||
         code == AbortCode::kInvalidSequenceNumber || code == AbortCode::kCrcError;
}

constexpr std::pair<AbortCode, const char*> kTexts[] = {
    {AbortCode::kToggleBitNotAlternated, "toggle bit not alternated"},
    {AbortCode::kTimedOut, "SDO protocol timed out"},
    {AbortCode::kCommandSpecifierUnknown, "command specifier not valid or unknown"},
    {AbortCode::kInvalidBlockSize, "invalid block size"},
    {AbortCode::kInvalidSequenceNumber, "invalid sequence number"},
    {AbortCode::kCrcError, "CRC error"},
    {AbortCode::kOutOfMemory, "out of memory"},
    {AbortCode::kUnsupportedAccess, "unsupported access to an object"},
    {AbortCode::kReadOfWriteOnly, "attempt to read a write-only object"},
    {AbortCode::kWriteOfReadOnly, "attempt to write a read-only object"},
    {AbortCode::kObjectDoesNotExist, "object does not exist"},
    {AbortCode::kNotMappable, "object cannot be mapped to the PDO"},
    {AbortCode::kPdoLengthExceeded, "the objects would exceed the length of a PDO"},
    {AbortCode::kParameterIncompatibility, "general parameter incompatibility"},
    {AbortCode::kInternalIncompatibility, "general internal incompatibility in the device"},
    {AbortCode::kHardwareError, "access failed due to a hardware error"},
    {AbortCode::kLengthMismatch, "data type does not match, length of parameter does not match"},
    {AbortCode::kLengthTooHigh, "data type does not match, length of parameter too high"},
    {AbortCode::kLengthTooLow, "data type does not match, length of parameter too low"},
    {AbortCode::kSubindexDoesNotExist, "sub-index does not exist"},
    {AbortCode::kInvalidValue, "invalid value for parameter"},
    {AbortCode::kValueTooHigh, "value of parameter too high"},
    {AbortCode::kValueTooLow, "value of parameter too low"},
    {AbortCode::kMaximumBelowMinimum, "maximum value is less than minimum value"},
    {AbortCode::kResourceNotAvailable, "resource not available: SDO connection"},
    {AbortCode::kGeneralError, "general error"},
    {AbortCode::kCannotTransfer, "data cannot be transferred or stored to the application"},
    {AbortCode::kLocalControl, "data cannot be transferred or stored because of local control"},
    {AbortCode::kDeviceState, "data cannot be transferred or stored because of the present device state"},
    {AbortCode::kNoDictionary, "no object dictionary is present"},
    {AbortCode::kNoData, "no data available"},
};

// Whether to wait no longer. What has arrived until the deadline counts, also if the machine was too busy to
// read it; a flood of frames does not prolong the wait for ever.
bool is_over(Clock::time_point deadline, bool has_received) {
  const auto now = Clock::now();
  return now >= deadline &&
         (!has_received || now >= deadline + std::chrono::microseconds(SdoTransfer::kTimeout_us));
}

bool answers_second_sdo(sim_board::Transport& transport, std::uint8_t node_id) {
  if (!sim_board::has_pc_sdo(node_id)) return false;
  for (int attempt = 0; attempt < 2; ++attempt) {
    send_surely(transport, device_type_request(node_id, true));
    const auto deadline = Clock::now() + std::chrono::microseconds(kSecondSdoTimeout_us);
    for (;;) {
      const auto frame = transport.receive();
      if (frame && frame->identifier == sim_board::pc_sdo_response(node_id) && frame->size == 8 &&
          !frame->remote)
        return true;
      if (is_over(deadline, frame.has_value())) break;
      if (!frame) wait_for_frames(transport, 1'000);
    }
  }
  return false;
}

}  // namespace

std::string text_of(AbortCode code) {
  const auto* found = std::ranges::find(kTexts, code, &std::pair<AbortCode, const char*>::first);
  return found == std::end(kTexts) ? "a code that CiA 301 does not know" : found->second;
}

SdoAborted::SdoAborted(AbortCode code)
    : std::runtime_error(
          fmt::format("SDO abort 0x{:08X}: {}", static_cast<std::uint32_t>(code), text_of(code))),
      code_(code) {}

SdoTransfer::SdoTransfer(sim_board::Transport& transport, std::uint8_t node_id)
    : SdoTransfer(transport, static_cast<std::uint16_t>(canopen::kSdoRequestBase + node_id),
                  static_cast<std::uint16_t>(canopen::kSdoResponseBase + node_id)) {}

SdoTransfer second_sdo(sim_board::Transport& transport, std::uint8_t node_id) {
  if (!sim_board::has_pc_sdo(node_id))
    throw std::invalid_argument(
        fmt::format("found node {}, which has no second SDO channel, expected a drive, {}; or use the first "
                    "channel, --first, while no controller uses it",
                    node_id, sim_board::kPcSdoNodesText));
  return {transport, sim_board::pc_sdo_request(node_id), sim_board::pc_sdo_response(node_id)};
}

hal::CanFrame device_type_request(std::uint8_t node_id, bool on_second) {
  return {.identifier = on_second ? sim_board::pc_sdo_request(node_id)
                                  : static_cast<std::uint16_t>(canopen::kSdoRequestBase + node_id),
          .size = 8,
          .data = sdo::message(sdo::kInitiateUploadRequest, kDeviceType, 0)};
}

SdoTransfer open_sdo(sim_board::Transport& transport, std::uint8_t node_id, SdoChannel channel) {
  if (channel == SdoChannel::kSecond) return second_sdo(transport, node_id);
  if (channel == SdoChannel::kAutomatic && answers_second_sdo(transport, node_id))
    return second_sdo(transport, node_id);
  return {transport, node_id};
}

// --- One message

void SdoTransfer::send(const Data& data) {
  send_surely(transport_, {.identifier = request_, .size = 8, .data = data});
}

// Whether a message answers this client, not another one of the channel. The server whose transfer another
// client's request has ended refuses the next segment, and then names the other's object or none.
bool SdoTransfer::is_answer(const Data& data, Kind kind, std::uint8_t specifier) const {
  const bool is_ours = sdo::address_of(data) == address_;
  if (data[0] == sdo::kAbort)
    return is_ours || (kind != Kind::kInitiate && is_disturbance(static_cast<AbortCode>(sdo::data_of(data))));
  if (kind == Kind::kBlockSegment) return true;
  return (data[0] & sdo::kSpecifierMask) == specifier && (kind == Kind::kMessage || is_ours);
}

SdoTransfer::Data SdoTransfer::receive(Kind kind, std::uint8_t specifier) {
  const Clock::time_point deadline = Clock::now() + std::chrono::microseconds(kTimeout_us);
  for (;;) {
    const auto frame = transport_.receive();
    if (frame && frame->identifier == response_ && frame->size == 8 && !frame->remote &&
        is_answer(frame->data, kind, specifier)) {
      if (frame->data[0] == sdo::kAbort) throw SdoAborted(static_cast<AbortCode>(sdo::data_of(frame->data)));
      return frame->data;
    }
    if (is_over(deadline, frame.has_value())) break;
    if (!frame) wait_for_frames(transport_, 1'000);
  }
  throw NoSdoAnswer(
      fmt::format("no SDO answer with identifier 0x{:03X} within {} ms", response_, kTimeout_us / 1000));
}

template <typename Action>
auto SdoTransfer::repeat(bool is_read, const Action& action) {
  for (int attempt = 1;; ++attempt) {
    try {
      return action();
    } catch (const SdoAborted& aborted) {
      if (attempt >= kAttempts || !is_disturbance(aborted.code())) throw;
    } catch (const NoSdoAnswer&) {
      if (attempt >= kSilentAttempts || !is_read) throw;  // a write may have been executed
    }
    std::this_thread::sleep_for(kPause * (1 << attempt));
  }
}

void SdoTransfer::abort(AbortCode code) {
  send(sdo::message(sdo::kAbort, address_, static_cast<std::uint32_t>(code)));
  throw SdoAborted(code);
}

// --- Expedited and by segments

std::vector<std::uint8_t> SdoTransfer::read(ObjectAddress address) {
  return repeat(true, [&] { return read_once(address); });
}

std::vector<std::uint8_t> SdoTransfer::read_once(ObjectAddress address) {
  address_ = address;
  const Data answer = ask(Kind::kInitiate, sdo::message(sdo::kInitiateUploadRequest, address, 0),
                          sdo::kInitiateUploadResponse);
  if (sdo::is_expedited(answer[0], sdo::kInitiateUploadResponse)) {
    const auto first = answer.begin() + 4;
    return {first, first + static_cast<std::ptrdiff_t>(sdo::expedited_size(answer[0]))};
  }
  return read_segments((answer[0] & sdo::kSizeIndicated) != 0 ? sdo::data_of(answer) : 0);
}

std::vector<std::uint8_t> SdoTransfer::read_segments(std::size_t size) {
  std::vector<std::uint8_t> data;
  for (std::uint8_t toggle = 0;; toggle ^= sdo::kToggle) {
    Data request{};
    request[0] = static_cast<std::uint8_t>(sdo::kUploadSegmentRequest | toggle);
    const Data answer = ask(Kind::kMessage, request, sdo::kUploadSegmentResponse);
    if ((answer[0] & sdo::kToggle) != toggle) abort(AbortCode::kToggleBitNotAlternated);
    data.insert(data.end(), answer.begin() + 1,
                answer.begin() + 1 + static_cast<std::ptrdiff_t>(sdo::segment_size(answer[0])));
    if ((answer[0] & sdo::kLastSegment) != 0) break;
  }
  if (size != 0 && data.size() != size) abort(AbortCode::kLengthMismatch);
  return data;
}

void SdoTransfer::write(ObjectAddress address, std::span<const std::uint8_t> data) {
  repeat(false, [&] { write_once(address, data); });
}

void SdoTransfer::write_once(ObjectAddress address, std::span<const std::uint8_t> data) {
  address_ = address;
  if (data.size() <= 4 && !data.empty()) {
    Data request = sdo::message(sdo::expedited(sdo::kInitiateDownloadRequest, data.size()), address, 0);
    std::ranges::copy(data, request.begin() + 4);
    ask(Kind::kInitiate, request, sdo::kInitiateDownloadResponse);
    return;
  }
  ask(Kind::kInitiate,
      sdo::message(sdo::kInitiateDownloadRequest | sdo::kSizeIndicated, address,
                   static_cast<std::uint32_t>(data.size())),
      sdo::kInitiateDownloadResponse);
  write_segments(data);
}

void SdoTransfer::write_segments(std::span<const std::uint8_t> data) {
  std::uint8_t toggle = 0;
  do {
    const std::size_t count = std::min(data.size(), sdo::kSegmentBytes);
    const std::uint8_t last = count == data.size() ? sdo::kLastSegment : 0;
    Data request{};
    request[0] = static_cast<std::uint8_t>(sdo::kDownloadSegmentRequest | toggle |
                                           (sdo::kSegmentBytes - count) << 1 | last);
    std::ranges::copy(data.first(count), request.begin() + 1);
    const Data answer = ask(Kind::kMessage, request, sdo::kDownloadSegmentResponse);
    if ((answer[0] & sdo::kToggle) != toggle) abort(AbortCode::kToggleBitNotAlternated);
    toggle ^= sdo::kToggle;
    data = data.subspan(count);
  } while (!data.empty());
}

// --- By blocks

std::vector<std::uint8_t> SdoTransfer::upload(ObjectAddress address, const SdoProgress& progress) {
  return repeat(true, [&] { return upload_once(address, progress); });
}

std::vector<std::uint8_t> SdoTransfer::upload_once(ObjectAddress address, const SdoProgress& progress) {
  address_ = address;
  Data request = sdo::message(sdo::kBlockUploadRequest | sdo::kBlockCrc, address, 0);
  request[4] = sdo::kMaxBlockSize;
  const Data answer = ask(Kind::kInitiate, request, sdo::kBlockUploadResponse);
  const std::size_t size = (answer[0] & sdo::kBlockSizeIndicated) != 0 ? sdo::data_of(answer) : 0;
  send({sdo::kBlockUploadRequest | sdo::kBlockStartUpload});
  return read_blocks(size, (answer[0] & sdo::kBlockCrc) != 0, progress);
}

std::vector<std::uint8_t> SdoTransfer::read_blocks(std::size_t size, bool with_crc,
                                                   const SdoProgress& progress) {
  std::vector<std::uint8_t> data;
  for (;;) {
    std::uint8_t expected = 1;
    bool last = false;
    for (std::uint8_t sequence = 0; !last && sequence < sdo::kMaxBlockSize;) {
      const Data segment = receive(Kind::kBlockSegment);
      sequence = segment[0] & ~sdo::kBlockLastSegment & 0xFF;
      if (sequence != expected) {
        // Segments before the last are lost: request them again.
        if ((segment[0] & sdo::kBlockLastSegment) != 0) break;
        continue;
      }
      last = (segment[0] & sdo::kBlockLastSegment) != 0;
      data.insert(data.end(), segment.begin() + 1, segment.end());
      ++expected;
    }
    send({sdo::kBlockUploadRequest | sdo::kBlockConfirm, static_cast<std::uint8_t>(expected - 1),
          sdo::kMaxBlockSize});
    if (progress) progress(data.size(), size);
    if (last) break;
  }
  end_upload(data, with_crc);
  if (size != 0 && data.size() != size) abort(AbortCode::kLengthMismatch);
  return data;
}

void SdoTransfer::end_upload(std::vector<std::uint8_t>& data, bool with_crc) {
  const Data end = receive(Kind::kMessage, sdo::kBlockUploadResponse);
  if ((end[0] & (sdo::kSpecifierMask | sdo::kBlockEnd)) != (sdo::kBlockUploadResponse | sdo::kBlockEnd))
    abort(AbortCode::kCommandSpecifierUnknown);
  const std::size_t unused = sdo::kSegmentBytes - sdo::block_end_size(end[0]);  // of the last segment
  if (data.size() < unused) abort(AbortCode::kLengthMismatch);
  data.erase(data.end() - static_cast<std::ptrdiff_t>(unused), data.end());
  if (with_crc && canopen::load_u16(&end[1]) != canopen::crc16(0, data)) abort(AbortCode::kCrcError);
  send({sdo::kBlockUploadRequest | sdo::kBlockEnd});
}

void SdoTransfer::download(ObjectAddress address, std::span<const std::uint8_t> data,
                           const SdoProgress& progress) {
  repeat(false, [&] { download_once(address, data, progress); });
}

void SdoTransfer::download_once(ObjectAddress address, std::span<const std::uint8_t> data,
                                const SdoProgress& progress) {
  address_ = address;
  const Data answer = ask(Kind::kInitiate,
                          sdo::message(sdo::kBlockDownloadRequest | sdo::kBlockCrc | sdo::kBlockSizeIndicated,
                                       address, static_cast<std::uint32_t>(data.size())),
                          sdo::kBlockDownloadResponse);
  write_blocks(data, answer[4], progress);
  const std::size_t rest = data.size() % sdo::kSegmentBytes;
  const std::size_t unused = rest == 0 && !data.empty() ? 0 : sdo::kSegmentBytes - rest;
  Data end{};
  end[0] = static_cast<std::uint8_t>(sdo::kBlockDownloadRequest | sdo::kBlockEnd | unused << 2);
  const bool with_crc = (answer[0] & sdo::kBlockCrc) != 0;
  canopen::store_u16(&end[1], with_crc ? canopen::crc16(0, data) : std::uint16_t{0});
  ask(Kind::kMessage, end, sdo::kBlockDownloadResponse);
}

void SdoTransfer::write_blocks(std::span<const std::uint8_t> data, std::uint8_t block,
                               const SdoProgress& progress) {
  std::size_t done = 0;  // segments that the server has
  const std::size_t all = std::max<std::size_t>(segments_of(data.size()), 1);
  while (done < all) {
    if (!sdo::is_block_size(block)) abort(AbortCode::kInvalidBlockSize);
    const std::size_t count = std::min<std::size_t>(block, all - done);
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t begin = (done + i) * sdo::kSegmentBytes;
      const auto part = data.subspan(begin, std::min(sdo::kSegmentBytes, data.size() - begin));
      Data segment{};
      segment[0] = static_cast<std::uint8_t>((i + 1) | (done + i + 1 == all ? sdo::kBlockLastSegment : 0));
      std::ranges::copy(part, segment.begin() + 1);
      send(segment);
    }
    const Data answer = receive(Kind::kMessage, sdo::kBlockDownloadResponse);
    if (answer[0] != (sdo::kBlockDownloadResponse | sdo::kBlockConfirm) || answer[1] > count)
      abort(AbortCode::kInvalidSequenceNumber);
    done += answer[1];
    block = answer[2];
    if (progress) progress(std::min(done * sdo::kSegmentBytes, data.size()), data.size());
  }
}

}  // namespace koboshi::bus
