#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "firmware/canopen/dictionary.h"
#include "firmware/canopen/frame.h"
#include "firmware/canopen/sdo/objects.h"
#include "firmware/canopen/sdo/protocol.h"
#include "firmware/canopen/transmit_queue.h"

// SDO server (CiA 301, 7.2.4).
namespace koboshi::canopen {

// The object's end of an SDO transfer: a number, a text or a DOMAIN as a sequence of bytes, independent of
// the protocol that carries them.
class SdoTransfer {
 public:
  explicit SdoTransfer(ObjectServer& objects) : objects_(objects) {}

  AbortCode begin_upload(ObjectAddress address);
  // Copies bytes of the object from `position` on; fewer than requested only at its end.
  std::size_t read(std::uint32_t position, std::span<std::uint8_t> bytes);
  // The size of an upload in bytes; Domain::kUnknownSize if the DOMAIN does not know it.
  std::uint32_t size() const { return size_; }
  // Whether an expedited response can carry the value, a number of value().size() bytes.
  bool fits_expedited() const { return domain_ == nullptr && !value_.is_text() && size_ >= 1 && size_ <= 4; }
  const ObjectValue& value() const { return value_; }

  // `size` in bytes as the client indicates it; nullopt: it does not. kLengthTooHigh if no object is so long.
  AbortCode begin_download(ObjectAddress address, std::optional<std::uint32_t> size);
  AbortCode write(std::span<const std::uint8_t> bytes);
  // Makes the object take the bytes written. Without `size_indicated` a number takes as many as its type has.
  AbortCode commit(bool size_indicated = true);

  // Ends the transfer, if there is one.
  void end();

  ObjectAddress address() const { return address_; }
  bool uses(const Domain& domain) const { return domain_ == &domain; }

 private:
  ObjectServer& objects_;
  ObjectAddress address_;
  Domain* domain_ = nullptr;
  ObjectValue value_;                     // of an upload
  std::array<std::uint8_t, 4> number_{};  // of a download
  std::uint32_t position_ = 0;            // bytes written so far
  std::uint32_t size_ = Domain::kUnknownSize;
};

// The identifiers of an SDO channel, as seen from the server. With bit 31 of either the channel is invalid.
struct SdoChannel {
  std::uint32_t request_cob_id = kCobIdInvalid;   // from client to server
  std::uint32_t response_cob_id = kCobIdInvalid;  // from server to client
  bool plus_node_id = false;                      // in a NodeDescription: both are bases
};

// The server of one SDO channel (CiA 301, 7.2.4): expedited, segmented and block transfers, one at a time. A
// request that begins a transfer ends the one before. Every request is answered, by a response or an abort,
// except those that the protocol leaves unanswered: an abort, a frame that is not 8 bytes long, the end of a
// block upload, and the segments within a block.
//
// A request whose object is busy is repeated in each `process`, until the object takes it or kBusyTimeout_us
// have passed. A segment of a block is dropped instead, as if it had been lost, and the confirmation makes
// the client send it again.
class SdoServer {
 public:
  // Silence of a client in a transfer. Set by hand (2026-11-21): longer than a busy PC pauses, and short
  // enough that a transfer which its client has abandoned soon frees its object.
  static constexpr std::uint32_t kTimeout_us = 1'000'000;
  // Silence within a block after which the server confirms the segments that have arrived, since the last
  // ones may be lost.
  static constexpr std::uint32_t kBlockTimeout_us = kTimeout_us / 2;
  // How long an object may be busy before the transfer is aborted with 0504 0000. Saving parameters takes
  // 0.1 s; the rest is margin.
  static constexpr std::uint32_t kBusyTimeout_us = 5'000'000;
  // Segments of an uploaded block in one call of `process`, a millisecond: two take 0.27 ms at 1 Mbit/s, and
  // leave room for other services.
  static constexpr int kSegmentsPerProcess = 2;

  SdoServer(ObjectServer& objects, TransmitQueue& queue) : transfer_(objects), queue_(queue) {}

  // Sets the channel, and ends a transfer of the old one without a message.
  void configure(const SdoChannel& channel);
  const SdoChannel& channel() const { return channel_; }

  // Above 0x7FF if the channel is invalid.
  std::uint16_t request_identifier() const { return request_identifier_; }
  bool takes(const hal::CanFrame& frame) const { return frame.identifier == request_identifier_; }
  void on_request(const hal::CanFrame& request, std::uint64_t now_us);
  // Sends further segments of a block, repeats a request whose object was busy, and checks the time-outs.
  void process(std::uint64_t now_us) {
    if (state_ != State::kIdle || waits_) advance(now_us);
  }
  // Ends a transfer without a message.
  void reset();
  bool uses(const Domain& domain) const { return transfer_.uses(domain); }

 private:
  enum class State : std::uint8_t {
    kIdle,
    kUpload,              // waits for the request of a segment
    kDownload,            // waits for a segment
    kExpeditedDownload,   // waits for the object to take the bytes of the request
    kExpeditedEnd,        // waits for the object, which has them
    kDownloadEnd,         // waits for the object, which has all bytes
    kBlockDownload,       // waits for segments of a block
    kBlockDownloadEnd,    // waits for the end message
    kBlockUploadStart,    // waits for the client's start
    kBlockUpload,         // sends segments of a block
    kBlockUploadConfirm,  // waits for the block's confirmation
    kBlockUploadEnd,      // waits for the answer to the end message
  };

  // How far a block transfer has come.
  struct Block {
    std::uint32_t start = 0;      // upload: bytes before this block
    std::uint32_t crc_bytes = 0;  // upload: bytes that the CRC covers; those of repeated segments count once
    std::uint16_t crc = 0;
    std::uint8_t size = 0;       // segments in a block
    std::uint8_t sequence = 0;   // number of the last segment sent, or received in order
    std::uint8_t last_size = 0;  // upload: bytes in the last segment
    bool last = false;           // the last segment was sent or received
    bool with_crc = false;       // the client supports CRCs
    bool holds = false;          // download: `held` has a segment whose number of bytes is not known yet
    bool prompted = false;       // download: the block was confirmed because the client was silent
    std::array<std::uint8_t, sdo::kSegmentBytes> held{};
  };

  // Each answers the request, or returns why it is refused.
  AbortCode respond(const sdo::Data& request);
  AbortCode begin_download(const sdo::Data& request);
  AbortCode download_expedited(const sdo::Data& request);
  AbortCode store_expedited(const sdo::Data& request);
  AbortCode download_segment(const sdo::Data& request);
  AbortCode begin_upload(const sdo::Data& request);
  AbortCode respond_upload();
  AbortCode upload_segment(const sdo::Data& request);
  AbortCode expect_segment(State state, std::uint8_t command);

  // Block transfers (block_transfer.cc)
  AbortCode respond_block_download(const sdo::Data& request);
  AbortCode begin_block_download(const sdo::Data& request);
  AbortCode block_segment(const sdo::Data& segment);
  AbortCode pass_on_held(std::size_t size);
  void confirm_block();
  AbortCode end_block_download(const sdo::Data& request);
  AbortCode respond_block_upload(const sdo::Data& request);
  AbortCode begin_block_upload(const sdo::Data& request);
  AbortCode on_block_confirmed(const sdo::Data& request);
  bool send_block_segment();
  void end_block_upload();

  AbortCode repeat();
  void conclude(AbortCode refusal, std::uint64_t now_us);
  void advance(std::uint64_t now_us);
  void on_silence(std::uint64_t now_us);
  void begin(ObjectAddress address);
  void abort(AbortCode code);
  void send(const sdo::Data& data);
  hal::CanFrame frame_of(const sdo::Data& data) const;

  static constexpr std::uint16_t kNoIdentifier = 0xFFFF;

  SdoChannel channel_;
  std::uint16_t request_identifier_ = kNoIdentifier;
  State state_ = State::kIdle;
  bool toggle_ = false;
  ObjectAddress address_;
  SdoTransfer transfer_;
  TransmitQueue& queue_;
  std::uint32_t position_ = 0;  // bytes uploaded in segments so far
  std::uint64_t deadline_us_ = 0;
  bool waits_ = false;                  // `request_` waits for its object
  std::uint64_t busy_deadline_us_ = 0;  // until when it waits
  sdo::Data request_{};
  Block block_;
};

}  // namespace koboshi::canopen
