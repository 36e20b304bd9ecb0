#include "firmware/canopen/sdo/server.h"

#include <algorithm>

#include "firmware/canopen/sdo/protocol.h"

// Block transfers of the SDO server (CiA 301, 7.2.4.3.9 to 7.2.4.3.15).
namespace koboshi::canopen {

// --- Block download (7.2.4.3.9 to 7.2.4.3.11): the client sends up to 127 segments, the server confirms how
// many have arrived in order, and the client continues behind those.

AbortCode SdoServer::respond_block_download(const sdo::Data& request) {
  return (request[0] & 1) == sdo::kBlockEnd ? end_block_download(request) : begin_block_download(request);
}

AbortCode SdoServer::begin_block_download(const sdo::Data& request) {
  begin(sdo::address_of(request));
  const bool announced = (request[0] & sdo::kBlockSizeIndicated) != 0;
  const AbortCode begun =
      transfer_.begin_download(address_, announced ? std::optional(sdo::data_of(request)) : std::nullopt);
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
  // A segment after a lost one, or one for which the object is busy, is dropped; the confirmation makes the
  // client repeat it.
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

// Passes the held segment on. Only the end message indicates how many bytes of the last segment count, so
// each segment is held until the next.
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

// --- Block upload (7.2.4.3.12 to 7.2.4.3.15): the server sends as many segments as the client requested, the
// client confirms how many have arrived in order, and the server continues behind those.

AbortCode SdoServer::respond_block_upload(const sdo::Data& request) {
  const std::uint8_t subcommand = request[0] & sdo::kBlockSubcommandMask;
  if (subcommand == sdo::kBlockInitiate) return begin_block_upload(request);
  if (subcommand == sdo::kBlockConfirm &&
      (state_ == State::kBlockUpload || state_ == State::kBlockUploadConfirm)) {
    return on_block_confirmed(request);
  }
  if (subcommand == sdo::kBlockStartUpload && state_ == State::kBlockUploadStart) {
    state_ = State::kBlockUpload;
    return AbortCode::kNone;
  }
  if (subcommand == sdo::kBlockEnd && state_ == State::kBlockUploadEnd) {
    reset();
    return AbortCode::kNone;
  }
  return AbortCode::kCommandSpecifierUnknown;
}

AbortCode SdoServer::begin_block_upload(const sdo::Data& request) {
  begin(sdo::address_of(request));
  const std::uint8_t block_size = request[4];
  const std::uint8_t switch_threshold = request[5];
  if (!sdo::is_block_size(block_size)) return AbortCode::kInvalidBlockSize;
  const AbortCode begun = transfer_.begin_upload(address_);
  if (begun != AbortCode::kNone) return begun;
  // Up to the threshold of the client, data go by expedited or segmented transfer; a threshold of 0 forbids
  // it.
  if (transfer_.size() <= switch_threshold && switch_threshold != 0) return respond_upload();
  block_.size = block_size;
  block_.with_crc = (request[0] & sdo::kBlockCrc) != 0;
  state_ = State::kBlockUploadStart;
  const bool known = transfer_.size() != Domain::kUnknownSize;
  const int command = sdo::kBlockUploadResponse | sdo::kBlockCrc | (known ? sdo::kBlockSizeIndicated : 0);
  send(sdo::message(static_cast<std::uint8_t>(command), address_, known ? transfer_.size() : 0));
  return AbortCode::kNone;
}

// Sends the next segment; false when the queue has no room.
bool SdoServer::send_block_segment() {
  const auto position = block_.start + static_cast<std::uint32_t>(block_.sequence * sdo::kSegmentBytes);
  // Reads one byte more than a segment holds, to see whether it is the last.
  std::array<std::uint8_t, sdo::kSegmentBytes + 1> bytes;
  const std::size_t found = transfer_.read(position, bytes);
  const std::size_t size = std::min(found, sdo::kSegmentBytes);
  const bool last = found <= sdo::kSegmentBytes;
  sdo::Data segment{};
  segment[0] = static_cast<std::uint8_t>((block_.sequence + 1) | (last ? sdo::kBlockLastSegment : 0));
  std::copy_n(bytes.begin(), size, segment.begin() + 1);
  if (!queue_.offer(frame_of(segment))) return false;
  if (position == block_.crc_bytes) {
    block_.crc = crc16(block_.crc, std::span(bytes).first(size));
    block_.crc_bytes += static_cast<std::uint32_t>(size);
  }
  ++block_.sequence;
  block_.last = last;
  block_.last_size = static_cast<std::uint8_t>(size);
  if (last || block_.sequence == block_.size) state_ = State::kBlockUploadConfirm;
  return true;
}

AbortCode SdoServer::on_block_confirmed(const sdo::Data& request) {
  const std::uint8_t arrived = request[1];
  const std::uint8_t next_size = request[2];
  if (arrived > block_.sequence) return AbortCode::kInvalidSequenceNumber;
  if (!sdo::is_block_size(next_size)) return AbortCode::kInvalidBlockSize;
  if (block_.last && arrived == block_.sequence) {
    end_block_upload();
    return AbortCode::kNone;
  }
  block_.start += static_cast<std::uint32_t>(arrived * sdo::kSegmentBytes);
  block_.sequence = 0;
  block_.last = false;
  block_.size = next_size;
  state_ = State::kBlockUpload;
  return AbortCode::kNone;
}

void SdoServer::end_block_upload() {
  sdo::Data end{};
  end[0] = static_cast<std::uint8_t>(sdo::kBlockUploadResponse | sdo::kBlockEnd |
                                     ((sdo::kSegmentBytes - block_.last_size) << 2));
  if (block_.with_crc) store_u16(&end[1], block_.crc);
  state_ = State::kBlockUploadEnd;
  send(end);
}

}  // namespace koboshi::canopen
