#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "firmware/canopen/abort_code.h"
#include "firmware/canopen/dictionary.h"
#include "firmware/canopen/frame.h"
#include "firmware/canopen/sdo_protocol.h"

namespace koboshi::canopen {

// The objects behind an SDO server.
class ObjectServer {
 public:
  virtual AbortCode read_object(ObjectAddress address, ObjectValue& value) = 0;
  // `size` in bytes; 0 when the client has not told it and the object's own counts.
  virtual AbortCode write_object(ObjectAddress address, std::uint32_t value, std::size_t size) = 0;

 protected:
  ~ObjectServer() = default;
};

// One SDO channel from the server's side (CiA 301, 7.2.4): expedited and segmented transfers.
class SdoServer {
 public:
  static constexpr std::uint32_t kTimeout_us = 1'000'000;  // between two segments

  SdoServer(std::uint16_t request_identifier, std::uint16_t response_identifier)
      : request_identifier_(request_identifier), response_identifier_(response_identifier) {}

  std::uint16_t request_identifier() const { return request_identifier_; }
  // Answers a request; every request but an abort has exactly one response.
  void on_request(const hal::CanFrame& request, ObjectServer& objects, FrameSink& sink, std::uint64_t now_us);
  // Aborts a segmented transfer whose client has fallen silent.
  void process(FrameSink& sink, std::uint64_t now_us) {
    if (transfer_ != Transfer::kNone && now_us >= deadline_us_) abort(AbortCode::kTimedOut, sink);
  }
  // Ends a transfer without a word.
  void reset() { transfer_ = Transfer::kNone; }

 private:
  enum class Transfer : std::uint8_t { kNone, kUpload, kDownload };

  // Each fills the response, or returns why the request is refused.
  AbortCode respond(const sdo::Data& request, ObjectServer& objects, sdo::Data& response);
  AbortCode begin_download(const sdo::Data& request, ObjectServer& objects, sdo::Data& response);
  AbortCode download_segment(const sdo::Data& request, ObjectServer& objects, sdo::Data& response);
  AbortCode begin_upload(const sdo::Data& request, ObjectServer& objects, sdo::Data& response);
  AbortCode upload_segment(const sdo::Data& request, sdo::Data& response);

  void begin(ObjectAddress address);
  AbortCode expect_segment(Transfer transfer, std::uint8_t command);
  void abort(AbortCode code, FrameSink& sink);
  void send(const sdo::Data& data, FrameSink& sink);

  std::uint16_t request_identifier_;
  std::uint16_t response_identifier_;
  Transfer transfer_ = Transfer::kNone;
  bool toggle_ = false;
  ObjectAddress address_;
  std::size_t position_ = 0;          // bytes transferred so far
  std::uint32_t announced_size_ = 0;  // of a download; 0: not announced
  ObjectValue upload_;
  std::array<std::uint8_t, 4> download_{};
  std::uint64_t deadline_us_ = 0;
};

}  // namespace koboshi::canopen
