#include "firmware/canopen/sdo/server.h"

#include <algorithm>

#include "firmware/canopen/frame.h"

namespace koboshi::canopen {

// --- The object's end of a transfer

AbortCode SdoTransfer::begin_upload(ObjectAddress address) {
  end();
  address_ = address;
  size_ = Domain::kUnknownSize;
  Domain* domain = nullptr;
  const AbortCode opened = objects_.open_domain(address, Access::kReadOnly, domain);
  if (opened != AbortCode::kNone) return opened;
  const AbortCode begun =
      domain != nullptr ? domain->begin_upload(size_) : objects_.read_object(address, value_);
  if (begun != AbortCode::kNone) return begun;
  domain_ = domain;
  if (domain == nullptr) size_ = value_.size();
  return AbortCode::kNone;
}

std::size_t SdoTransfer::read(std::uint32_t position, std::span<std::uint8_t> bytes) {
  if (domain_ != nullptr) return std::min(domain_->read(position, bytes), bytes.size());
  const auto all = value_.bytes();
  const auto rest = all.subspan(std::min<std::size_t>(position, all.size()));
  const std::size_t size = std::min(rest.size(), bytes.size());
  std::copy_n(rest.begin(), size, bytes.begin());
  return size;
}

AbortCode SdoTransfer::begin_download(ObjectAddress address, std::optional<std::uint32_t> size) {
  end();
  address_ = address;
  size_ = size.value_or(Domain::kUnknownSize);
  position_ = 0;
  number_ = {};
  Domain* domain = nullptr;
  const AbortCode opened = objects_.open_domain(address, Access::kWriteOnly, domain);
  if (opened != AbortCode::kNone) return opened;
  if (domain != nullptr) {
    // The largest number means something else to a Domain.
    if (size == Domain::kUnknownSize) return AbortCode::kLengthTooHigh;
    const AbortCode begun = domain->begin_download(size_);
    if (begun == AbortCode::kNone) domain_ = domain;
    return begun;
  }
  // Longer than any number: the attempt returns the first reason to refuse it.
  const bool too_long = size && *size > number_.size();
  return too_long ? objects_.write_object(address, 0, *size) : AbortCode::kNone;
}

AbortCode SdoTransfer::write(std::span<const std::uint8_t> bytes) {
  if (bytes.size() > size_ - position_) return AbortCode::kLengthMismatch;
  if (bytes.empty()) return AbortCode::kNone;
  if (domain_ == nullptr) {
    if (position_ + bytes.size() > number_.size()) return AbortCode::kLengthTooHigh;
    std::copy(bytes.begin(), bytes.end(), number_.begin() + static_cast<std::ptrdiff_t>(position_));
  }
  const AbortCode written = domain_ != nullptr ? domain_->write(bytes) : AbortCode::kNone;
  if (written == AbortCode::kNone) position_ += static_cast<std::uint32_t>(bytes.size());
  return written;
}

AbortCode SdoTransfer::commit(bool size_indicated) {
  if (size_ != Domain::kUnknownSize && position_ != size_) return AbortCode::kLengthMismatch;
  if (domain_ != nullptr) return domain_->commit();
  if (position_ == 0) return AbortCode::kLengthTooLow;
  return objects_.write_object(address_, load_u32(number_.data()), size_indicated ? position_ : 0);
}

void SdoTransfer::end() {
  Domain* const domain = domain_;
  domain_ = nullptr;
  if (domain != nullptr) domain->release();
}

// --- The channel

void SdoServer::configure(const SdoChannel& channel) {
  reset();
  channel_ = channel;
  const bool valid = ((channel.request_cob_id | channel.response_cob_id) & kCobIdInvalid) == 0;
  request_identifier_ =
      valid ? static_cast<std::uint16_t>(channel.request_cob_id & kCobIdMask) : kNoIdentifier;
}

void SdoServer::on_request(const hal::CanFrame& request, std::uint64_t now_us) {
  if (request.size != request.data.size()) return;
  if (request.data[0] == sdo::kAbort) return reset();
  request_ = request.data;
  busy_deadline_us_ = now_us + kBusyTimeout_us;
  conclude(state_ == State::kBlockDownload ? block_segment(request_) : respond(request_), now_us);
}

// Repeats the request whose object was busy.
AbortCode SdoServer::repeat() {
  const bool begun = state_ == State::kExpeditedDownload || state_ == State::kExpeditedEnd;
  return begun ? store_expedited(request_) : respond(request_);
}

void SdoServer::conclude(AbortCode refusal, std::uint64_t now_us) {
  waits_ = refusal == AbortCode::kBusy && now_us < busy_deadline_us_;
  if (refusal == AbortCode::kBusy && !waits_) refusal = AbortCode::kTimedOut;
  if (!waits_ && refusal != AbortCode::kNone) abort(refusal);
  deadline_us_ = now_us + (state_ == State::kBlockDownload ? kBlockTimeout_us : kTimeout_us);
}

AbortCode SdoServer::respond(const sdo::Data& request) {
  switch (request[0] & sdo::kSpecifierMask) {
    case sdo::kInitiateDownloadRequest:
      return begin_download(request);
    case sdo::kDownloadSegmentRequest:
      return download_segment(request);
    case sdo::kInitiateUploadRequest:
      return begin_upload(request);
    case sdo::kUploadSegmentRequest:
      return upload_segment(request);
    case sdo::kBlockDownloadRequest:
      return respond_block_download(request);
    case sdo::kBlockUploadRequest:
      return respond_block_upload(request);
    default:
      begin(sdo::address_of(request));
      return AbortCode::kCommandSpecifierUnknown;
  }
}

// --- Expedited and segmented transfers (CiA 301, 7.2.4.3.3 to 7.2.4.3.8)

AbortCode SdoServer::begin_download(const sdo::Data& request) {
  begin(sdo::address_of(request));
  if (sdo::is_expedited(request[0], sdo::kInitiateDownloadRequest)) return download_expedited(request);
  const bool announced = (request[0] & sdo::kSizeIndicated) != 0;
  const AbortCode begun =
      transfer_.begin_download(address_, announced ? std::optional(sdo::data_of(request)) : std::nullopt);
  if (begun != AbortCode::kNone) return begun;
  state_ = State::kDownload;
  send(sdo::message(sdo::kInitiateDownloadResponse, address_, 0));
  return AbortCode::kNone;
}

// Four bytes if the client has not indicated their number: a number then takes as many as its type has.
AbortCode SdoServer::download_expedited(const sdo::Data& request) {
  const auto size = static_cast<std::uint32_t>(sdo::expedited_size(request[0]));
  const AbortCode begun = transfer_.begin_download(address_, size);
  if (begun != AbortCode::kNone) return begun;
  state_ = State::kExpeditedDownload;
  return store_expedited(request);
}

// Executes each step once, however often the object is busy.
AbortCode SdoServer::store_expedited(const sdo::Data& request) {
  if (state_ == State::kExpeditedDownload) {
    const std::size_t size = sdo::expedited_size(request[0]);
    const AbortCode written = transfer_.write(std::span(request).subspan(4, size));
    if (written != AbortCode::kNone) return written;
    state_ = State::kExpeditedEnd;
  }
  const AbortCode committed = transfer_.commit((request[0] & sdo::kSizeIndicated) != 0);
  if (committed != AbortCode::kNone) return committed;
  reset();
  send(sdo::message(sdo::kInitiateDownloadResponse, address_, 0));
  return AbortCode::kNone;
}

AbortCode SdoServer::download_segment(const sdo::Data& request) {
  if (state_ != State::kDownloadEnd) {
    const AbortCode expected = expect_segment(State::kDownload, request[0]);
    if (expected != AbortCode::kNone) return expected;
    const AbortCode written = transfer_.write(std::span(request).subspan(1, sdo::segment_size(request[0])));
    if (written != AbortCode::kNone) return written;
    toggle_ = !toggle_;
    if ((request[0] & sdo::kLastSegment) != 0) state_ = State::kDownloadEnd;
  }
  if (state_ == State::kDownloadEnd) {
    const AbortCode committed = transfer_.commit();
    if (committed != AbortCode::kNone) return committed;
    reset();
  }
  send({static_cast<std::uint8_t>(sdo::kDownloadSegmentResponse | (request[0] & sdo::kToggle))});
  return AbortCode::kNone;
}

AbortCode SdoServer::begin_upload(const sdo::Data& request) {
  begin(sdo::address_of(request));
  const AbortCode begun = transfer_.begin_upload(address_);
  return begun == AbortCode::kNone ? respond_upload() : begun;
}

AbortCode SdoServer::respond_upload() {
  if (transfer_.fits_expedited()) {
    const ObjectValue& value = transfer_.value();
    const std::uint8_t command = sdo::expedited(sdo::kInitiateUploadResponse, value.size());
    send(sdo::message(command, address_, value.number()));
    reset();
    return AbortCode::kNone;
  }
  const bool known = transfer_.size() != Domain::kUnknownSize;
  const int command = sdo::kInitiateUploadResponse | (known ? sdo::kSizeIndicated : 0);
  send(sdo::message(static_cast<std::uint8_t>(command), address_, known ? transfer_.size() : 0));
  state_ = State::kUpload;
  return AbortCode::kNone;
}

AbortCode SdoServer::upload_segment(const sdo::Data& request) {
  const AbortCode expected = expect_segment(State::kUpload, request[0]);
  if (expected != AbortCode::kNone) return expected;
  toggle_ = !toggle_;
  // Reads one byte more than a segment holds, to see whether it is the last.
  sdo::Data bytes;
  const std::size_t found = transfer_.read(position_, bytes);
  const std::size_t size = std::min(found, sdo::kSegmentBytes);
  const bool last = found <= sdo::kSegmentBytes;
  sdo::Data response{};
  response[0] =
      static_cast<std::uint8_t>(sdo::kUploadSegmentResponse | (request[0] & sdo::kToggle) |
                                ((sdo::kSegmentBytes - size) << 1) | (last ? sdo::kLastSegment : 0));
  std::copy_n(bytes.begin(), size, response.begin() + 1);
  position_ += static_cast<std::uint32_t>(size);
  send(response);
  if (last) reset();
  return AbortCode::kNone;
}

AbortCode SdoServer::expect_segment(State state, std::uint8_t command) {
  if (state_ != state) {
    if (state_ == State::kIdle) begin({});
    return AbortCode::kCommandSpecifierUnknown;
  }
  return ((command & sdo::kToggle) != 0) == toggle_ ? AbortCode::kNone : AbortCode::kToggleBitNotAlternated;
}

// --- Common to all transfers

void SdoServer::advance(std::uint64_t now_us) {
  if (waits_) return conclude(repeat(), now_us);
  for (int i = 0; i < kSegmentsPerProcess && state_ == State::kBlockUpload; ++i) {
    if (!send_block_segment()) break;
    deadline_us_ = now_us + kTimeout_us;
  }
  if (now_us >= deadline_us_) on_silence(now_us);
}

void SdoServer::on_silence(std::uint64_t now_us) {
  const bool within_block = state_ == State::kBlockDownload && !block_.prompted;
  if (!within_block) return abort(AbortCode::kTimedOut);
  confirm_block();
  block_.prompted = true;
  deadline_us_ = now_us + kTimeout_us - kBlockTimeout_us;
}

void SdoServer::begin(ObjectAddress address) {
  reset();
  address_ = address;
  toggle_ = false;
  position_ = 0;
  block_ = {};
}

void SdoServer::reset() {
  state_ = State::kIdle;
  waits_ = false;
  transfer_.end();
}

void SdoServer::abort(AbortCode code) {
  reset();
  send(sdo::message(sdo::kAbort, address_, static_cast<std::uint32_t>(code)));
}

hal::CanFrame SdoServer::frame_of(const sdo::Data& data) const {
  return {.identifier = static_cast<std::uint16_t>(channel_.response_cob_id & kCobIdMask),
          .size = 8,
          .data = data};
}

void SdoServer::send(const sdo::Data& data) {
  // Without room the client runs into its time-out; the queue has counted the loss.
  static_cast<void>(queue_.send(frame_of(data)));
}

}  // namespace koboshi::canopen
