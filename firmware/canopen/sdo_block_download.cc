// SDO block download from the server's side (CiA 301, 7.2.4.3.9 to 7.2.4.3.11): the client sends up to 127
// segments, the server confirms how many arrived in order, and the client goes on behind those.

#include <algorithm>

#include "firmware/canopen/crc16.h"
#include "firmware/canopen/sdo_server.h"

namespace koboshi::canopen {

AbortCode SdoServer::respond_block_download(const sdo::Data& request) {
  return (request[0] & 1) == sdo::kBlockEnd ? end_block_download(request) : begin_block_download(request);
}

AbortCode SdoServer::begin_block_download(const sdo::Data& request) {
  begin(sdo::address_of(request));
  const bool announced = (request[0] & sdo::kBlockSizeIndicated) != 0;
  const AbortCode begun =
      transfer_.begin_download(address_, announced ? sdo::data_of(request) : Domain::kUnknownSize);
  if (begun != AbortCode::kNone) return begun;
  block_.with_crc = (request[0] & sdo::kBlockCrc) != 0;
  block_.size = sdo::kMaxBlockSize;
  state_ = State::kBlockDownload;
  send(sdo::message(sdo::kBlockDownloadResponse | sdo::kBlockCrc, address_, block_.size));
  return AbortCode::kNone;
}

AbortCode SdoServer::block_segment(const sdo::Data& segment) {
  const std::uint8_t sequence = segment[0] & ~sdo::kBlockLastSegment & 0xFF;
  const bool last = (segment[0] & sdo::kBlockLastSegment) != 0;
  if (sequence == 0 || sequence > block_.size) return AbortCode::kInvalidSequenceNumber;
  block_.prompted = false;
  // What follows a lost segment, or finds the object busy, is dropped; the confirmation makes the client
  // repeat it.
  if (sequence == block_.sequence + 1) {
    const AbortCode passed = pass_on_held(sdo::kSegmentBytes);
    if (passed == AbortCode::kNone) {
      std::copy_n(segment.begin() + 1, sdo::kSegmentBytes, block_.held.begin());
      block_.holds = true;
      block_.sequence = sequence;
      block_.last = last;
    } else if (passed != AbortCode::kBusy) {
      return passed;
    }
  }
  if (last || sequence == block_.size) confirm_block();
  return AbortCode::kNone;
}

// Only the end message tells how many bytes of the last segment count, so each segment waits for the next.
AbortCode SdoServer::pass_on_held(std::size_t size) {
  if (!block_.holds) return AbortCode::kNone;
  const auto bytes = std::span(block_.held).first(size);
  const AbortCode written = transfer_.write(bytes);
  if (written != AbortCode::kNone) return written;
  block_.holds = false;
  block_.crc = crc16(block_.crc, bytes);
  return AbortCode::kNone;
}

void SdoServer::confirm_block() {
  send({sdo::kBlockDownloadResponse | sdo::kBlockConfirm, block_.sequence, block_.size});
  block_.sequence = 0;
  if (block_.last) state_ = State::kBlockDownloadEnd;
}

AbortCode SdoServer::end_block_download(const sdo::Data& request) {
  if (state_ != State::kBlockDownloadEnd) return AbortCode::kCommandSpecifierUnknown;
  const AbortCode passed = pass_on_held(sdo::block_end_size(request[0]));
  if (passed != AbortCode::kNone) return passed;
  if (block_.with_crc && load_u16(&request[1]) != block_.crc) return AbortCode::kCrcError;
  const AbortCode committed = transfer_.commit();
  if (committed != AbortCode::kNone) return committed;
  reset();
  send({sdo::kBlockDownloadResponse | sdo::kBlockEnd});
  return AbortCode::kNone;
}

}  // namespace koboshi::canopen
