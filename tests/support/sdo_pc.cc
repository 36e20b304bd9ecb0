#include "tests/support/sdo_pc.h"

#include <algorithm>

#include "firmware/canopen/sdo/protocol.h"

namespace koboshi::test {

using canopen::AbortCode;
using canopen::ObjectAddress;
namespace sdo = canopen::sdo;

namespace {

constexpr std::uint16_t kRequest = 0x601;
constexpr std::uint16_t kResponse = 0x581;
constexpr int kTimeout_ms = 1'000;
constexpr std::size_t kSegmentsPerMs = 7;  // the bus can carry 8

void copy_segment(std::span<const std::byte> bytes, sdo::Data& data) {
  std::ranges::transform(bytes, data.begin() + 1,
                         [](std::byte byte) { return std::to_integer<std::uint8_t>(byte); });
}

}  // namespace

void SdoPc::begin() {
  refusal = AbortCode::kNone;
  answer_ms = 0;
}

void SdoPc::send(const Data& data) {
  bench_.board.can.deliver({.identifier = kRequest, .size = 8, .data = data});
}

bool SdoPc::ask(const Data& data, Data& answer) {
  send(data);
  return await(answer);
}

bool SdoPc::await(Data& answer) {
  for (int waited_ms = 1; waited_ms <= kTimeout_ms; ++waited_ms) {
    bench_.sent.clear();
    bench_.run_ms(1);
    const auto frame = bench_.last_sent(kResponse);
    if (!frame) continue;
    answer = frame->data;
    answer_ms = std::max(answer_ms, waited_ms);
    if (answer[0] != sdo::kAbort) return true;
    refusal = static_cast<AbortCode>(sdo::data_of(answer));
    return false;
  }
  refusal = AbortCode::kTimedOut;
  return false;
}

AbortCode SdoPc::write(ObjectAddress address, std::int32_t value, std::size_t size) {
  begin();
  Data answer;
  ask(sdo::message(sdo::expedited(sdo::kInitiateDownloadRequest, size), address,
                   static_cast<std::uint32_t>(value)),
      answer);
  return refusal;
}

std::uint32_t SdoPc::read(ObjectAddress address) {
  begin();
  Data answer;
  return ask(sdo::message(sdo::kInitiateUploadRequest, address, 0), answer) ? sdo::data_of(answer) : 0;
}

AbortCode SdoPc::download(ObjectAddress address, std::span<const std::byte> bytes) {
  begin();
  Data answer;
  const auto size = static_cast<std::uint32_t>(bytes.size());
  if (!ask(sdo::message(sdo::kInitiateDownloadRequest | sdo::kSizeIndicated, address, size), answer))
    return refusal;
  for (std::uint8_t toggle = 0; !bytes.empty(); toggle ^= sdo::kToggle) {
    const std::size_t count = std::min(bytes.size(), sdo::kSegmentBytes);
    Data segment{static_cast<std::uint8_t>(toggle | (sdo::kSegmentBytes - count) << 1 |
                                           (count == bytes.size() ? sdo::kLastSegment : 0))};
    copy_segment(bytes.first(count), segment);
    if (!ask(segment, answer)) return refusal;
    bytes = bytes.subspan(count);
  }
  return refusal;
}

AbortCode SdoPc::download_blocks(ObjectAddress address, std::span<const std::byte> bytes) {
  begin();
  Data answer;
  const auto size = static_cast<std::uint32_t>(bytes.size());
  if (!ask(
          sdo::message(sdo::kBlockDownloadRequest | sdo::kBlockCrc | sdo::kBlockSizeIndicated, address, size),
          answer)) {
    return refusal;
  }
  for (std::size_t done = 0; done < bytes.size();) {
    if (!send_block(bytes, done)) return refusal;
  }
  std::uint16_t crc = 0;
  for (const std::byte byte : bytes) {
    const std::uint8_t one[] = {std::to_integer<std::uint8_t>(byte)};
    crc = canopen::crc16(crc, one);
  }
  const std::size_t unused = (sdo::kSegmentBytes - bytes.size() % sdo::kSegmentBytes) % sdo::kSegmentBytes;
  Data end{static_cast<std::uint8_t>(sdo::kBlockDownloadRequest | sdo::kBlockEnd | unused << 2)};
  canopen::store_u16(&end[1], crc);
  ask(end, answer);
  return refusal;
}

bool SdoPc::send_block(std::span<const std::byte> bytes, std::size_t& done) {
  bench_.sent.clear();
  const std::size_t left = (bytes.size() - done + sdo::kSegmentBytes - 1) / sdo::kSegmentBytes;
  const std::size_t segments = std::min<std::size_t>(left, sdo::kMaxBlockSize);
  for (std::size_t i = 1; i <= segments; ++i) {
    const std::size_t from = done + (i - 1) * sdo::kSegmentBytes;
    const std::size_t count = std::min(bytes.size() - from, sdo::kSegmentBytes);
    Data segment{static_cast<std::uint8_t>(i | (i == left ? sdo::kBlockLastSegment : 0))};
    copy_segment(bytes.subspan(from, count), segment);
    send(segment);
    if (i % kSegmentsPerMs == 0 && i != segments) bench_.run_ms(1);
  }
  Data answer;
  if (!await(answer)) return false;
  done = std::min(bytes.size(), done + answer[1] * sdo::kSegmentBytes);
  return true;
}

std::vector<std::byte> SdoPc::upload(ObjectAddress address) {
  begin();
  std::vector<std::byte> bytes;
  Data answer;
  if (!ask(sdo::message(sdo::kInitiateUploadRequest, address, 0), answer)) return {};
  for (std::uint8_t toggle = 0;; toggle ^= sdo::kToggle) {
    if (!ask({static_cast<std::uint8_t>(sdo::kUploadSegmentRequest | toggle)}, answer)) return {};
    if ((answer[0] & sdo::kSpecifierMask) != sdo::kUploadSegmentResponse) return {};
    for (std::size_t i = 0; i < sdo::segment_size(answer[0]); ++i) bytes.push_back(std::byte{answer[1 + i]});
    if ((answer[0] & sdo::kLastSegment) != 0) return bytes;
  }
}

}  // namespace koboshi::test
