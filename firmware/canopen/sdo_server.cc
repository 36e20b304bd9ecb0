#include "firmware/canopen/sdo_server.h"

#include <algorithm>

#include "firmware/canopen/sdo_protocol.h"

namespace koboshi::canopen {

void SdoServer::on_request(const hal::CanFrame& request, ObjectServer& objects, FrameSink& sink,
                           std::uint64_t now_us) {
  if (request.size != request.data.size()) return;
  if (request.data[0] == sdo::kAbort) return reset();
  sdo::Data response{};
  const AbortCode refusal = respond(request.data, objects, response);
  if (refusal != AbortCode::kNone) return abort(refusal, sink);
  deadline_us_ = now_us + kTimeout_us;
  send(response, sink);
}

AbortCode SdoServer::respond(const sdo::Data& request, ObjectServer& objects, sdo::Data& response) {
  switch (request[0] & sdo::kSpecifierMask) {
    case sdo::kInitiateDownloadRequest:
      return begin_download(request, objects, response);
    case sdo::kDownloadSegmentRequest:
      return download_segment(request, objects, response);
    case sdo::kInitiateUploadRequest:
      return begin_upload(request, objects, response);
    case sdo::kUploadSegmentRequest:
      return upload_segment(request, response);
    default:
      begin(sdo::address_of(request));
      return AbortCode::kCommandSpecifierUnknown;
  }
}

void SdoServer::begin(ObjectAddress address) {
  transfer_ = Transfer::kNone;
  toggle_ = false;
  address_ = address;
  position_ = 0;
}

AbortCode SdoServer::begin_download(const sdo::Data& request, ObjectServer& objects, sdo::Data& response) {
  begin(sdo::address_of(request));
  response = sdo::message(sdo::kInitiateDownloadResponse, address_, 0);
  const bool size_indicated = (request[0] & sdo::kSizeIndicated) != 0;
  if (sdo::is_expedited(request[0], sdo::kInitiateDownloadRequest)) {
    const std::size_t size = size_indicated ? sdo::expedited_size(request[0]) : 0;
    return objects.write_object(address_, sdo::data_of(request), size);
  }
  announced_size_ = size_indicated ? sdo::data_of(request) : 0;
  // Longer than any object: the attempt names the first thing that is wrong with it.
  if (announced_size_ > download_.size()) return objects.write_object(address_, 0, announced_size_);
  transfer_ = Transfer::kDownload;
  return AbortCode::kNone;
}

AbortCode SdoServer::download_segment(const sdo::Data& request, ObjectServer& objects, sdo::Data& response) {
  const AbortCode expected = expect_segment(Transfer::kDownload, request[0]);
  if (expected != AbortCode::kNone) return expected;
  const std::size_t size = sdo::segment_size(request[0]);
  if (position_ + size > download_.size()) return AbortCode::kLengthTooHigh;
  std::copy_n(request.begin() + 1, size, download_.begin() + static_cast<std::ptrdiff_t>(position_));
  position_ += size;
  response[0] = static_cast<std::uint8_t>(sdo::kDownloadSegmentResponse | (request[0] & sdo::kToggle));
  if ((request[0] & sdo::kLastSegment) == 0) return AbortCode::kNone;
  transfer_ = Transfer::kNone;
  if (announced_size_ != 0 && position_ != announced_size_) return AbortCode::kLengthMismatch;
  if (position_ == 0) return AbortCode::kLengthTooLow;
  return objects.write_object(address_, load_u32(download_.data()), position_);
}

AbortCode SdoServer::begin_upload(const sdo::Data& request, ObjectServer& objects, sdo::Data& response) {
  begin(sdo::address_of(request));
  const AbortCode read = objects.read_object(address_, upload_);
  if (read != AbortCode::kNone) return read;
  const std::uint16_t size = upload_.size();
  if (size >= 1 && size <= 4 && !upload_.is_text()) {
    response = sdo::message(sdo::expedited(sdo::kInitiateUploadResponse, size), address_, upload_.number());
    return AbortCode::kNone;
  }
  response = sdo::message(sdo::kInitiateUploadResponse | sdo::kSizeIndicated, address_, size);
  transfer_ = Transfer::kUpload;
  return AbortCode::kNone;
}

AbortCode SdoServer::upload_segment(const sdo::Data& request, sdo::Data& response) {
  const AbortCode expected = expect_segment(Transfer::kUpload, request[0]);
  if (expected != AbortCode::kNone) return expected;
  const auto rest = upload_.bytes().subspan(position_);
  const std::size_t size = std::min(rest.size(), sdo::kSegmentBytes);
  std::copy_n(rest.begin(), size, response.begin() + 1);
  position_ += size;
  response[0] = static_cast<std::uint8_t>(sdo::kUploadSegmentResponse | (request[0] & sdo::kToggle) |
                                          ((sdo::kSegmentBytes - size) << 1));
  if (size == rest.size()) {
    response[0] |= sdo::kLastSegment;
    transfer_ = Transfer::kNone;
  }
  return AbortCode::kNone;
}

AbortCode SdoServer::expect_segment(Transfer transfer, std::uint8_t command) {
  if (transfer_ != transfer) {
    if (transfer_ == Transfer::kNone) begin({});
    return AbortCode::kCommandSpecifierUnknown;
  }
  if (((command & sdo::kToggle) != 0) != toggle_) return AbortCode::kToggleBitNotAlternated;
  toggle_ = !toggle_;
  return AbortCode::kNone;
}

void SdoServer::abort(AbortCode code, FrameSink& sink) {
  transfer_ = Transfer::kNone;
  send(sdo::message(sdo::kAbort, address_, static_cast<std::uint32_t>(code)), sink);
}

void SdoServer::send(const sdo::Data& data, FrameSink& sink) {
  // Without room the client is left to its time-out; the sink has counted the loss.
  static_cast<void>(sink.send({.identifier = response_identifier_, .size = 8, .data = data}));
}

}  // namespace koboshi::canopen
