#include "simulation/scenario/object_access.h"

#include <algorithm>
#include <span>

#include "firmware/canopen/sdo/protocol.h"
#include "sim_board/drive/pc_sdo.h"

namespace koboshi::simulation {
namespace {

using canopen::AbortCode;
namespace sdo = canopen::sdo;

std::uint16_t request_identifier(std::uint8_t node_id) {
  return sim_board::has_pc_sdo(node_id) ? sim_board::pc_sdo_request(node_id)
                                        : static_cast<std::uint16_t>(canopen::kSdoRequestBase + node_id);
}

std::uint16_t response_identifier(std::uint8_t node_id) {
  return sim_board::has_pc_sdo(node_id) ? sim_board::pc_sdo_response(node_id)
                                        : static_cast<std::uint16_t>(canopen::kSdoResponseBase + node_id);
}

}  // namespace

void ObjectAccess::process(std::uint64_t now_us) {
  if (active_ && now_us >= deadline_us_) abort(AbortCode::kTimedOut, now_us);
  if (!active_ && !waiting_.empty()) begin(now_us);
}

void ObjectAccess::begin(std::uint64_t now_us) {
  active_ = std::move(waiting_.front());
  waiting_.pop_front();
  read_.clear();
  written_ = 0;
  toggle_ = 0;
  segmented_ = false;
  const std::size_t size = active_->data.size();
  if (size > 4)
    return send(sdo::message(sdo::kInitiateDownloadRequest | sdo::kSizeIndicated, active_->address,
                             static_cast<std::uint32_t>(size)),
                now_us);
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < size; ++i) value |= std::uint32_t{active_->data[i]} << (8 * i);
  send(size == 0 ? sdo::message(sdo::kInitiateUploadRequest, active_->address, 0)
                 : sdo::message(sdo::expedited(sdo::kInitiateDownloadRequest, size), active_->address, value),
       now_us);
}

void ObjectAccess::send(const Data& data, std::uint64_t now_us) {
  const bool stores = active_->data.size() > 4;
  deadline_us_ = now_us + (stores ? std::max(timeout_us_, kStoreTimeout_us) : timeout_us_);
  // Without room for the frame, the node does not answer either.
  static_cast<void>(
      sink_.send({.identifier = request_identifier(active_->node_id), .size = 8, .data = data}));
}

bool ObjectAccess::on_frame(const hal::CanFrame& frame, std::uint64_t time_us) {
  if (!active_ || frame.remote || frame.size != 8 ||
      frame.identifier != response_identifier(active_->node_id))
    return false;
  // An answer about another object is for another client of the channel, or late.
  const bool is_ours = sdo::address_of(frame.data) == active_->address;
  if (frame.data[0] == sdo::kAbort) {
    if (!is_ours) return false;
    end(static_cast<AbortCode>(sdo::data_of(frame.data)), time_us);
  } else if (segmented_) {
    active_->data.empty() ? accept_segment(frame.data, time_us) : accept_written(frame.data, time_us);
  } else {
    if (!is_ours) return false;
    accept(frame.data, time_us);
  }
  return true;
}

void ObjectAccess::accept(const Data& answer, std::uint64_t time_us) {
  const std::uint8_t specifier = answer[0] & sdo::kSpecifierMask;
  const bool reads = active_->data.empty();
  if (specifier != (reads ? sdo::kInitiateUploadResponse : sdo::kInitiateDownloadResponse))
    return abort(AbortCode::kCommandSpecifierUnknown, time_us);
  if (!reads) {
    segmented_ = active_->data.size() > 4;
    return segmented_ ? send_segment(time_us) : end(AbortCode::kNone, time_us);
  }
  if (!sdo::is_expedited(answer[0], sdo::kInitiateUploadResponse)) {
    segmented_ = true;
    return request_segment(time_us);
  }
  read_.assign(answer.begin() + 4,
               answer.begin() + 4 + static_cast<std::ptrdiff_t>(sdo::expedited_size(answer[0])));
  end(AbortCode::kNone, time_us);
}

void ObjectAccess::request_segment(std::uint64_t now_us) {
  Data request{};
  request[0] = static_cast<std::uint8_t>(sdo::kUploadSegmentRequest | toggle_);
  send(request, now_us);
}

void ObjectAccess::send_segment(std::uint64_t now_us) {
  const std::span rest = std::span(active_->data).subspan(written_);
  const std::size_t count = std::min(rest.size(), sdo::kSegmentBytes);
  Data request{};
  request[0] =
      static_cast<std::uint8_t>(sdo::kDownloadSegmentRequest | toggle_ | (sdo::kSegmentBytes - count) << 1 |
                                (count == rest.size() ? sdo::kLastSegment : 0));
  std::ranges::copy(rest.first(count), request.begin() + 1);
  written_ += count;
  send(request, now_us);
}

void ObjectAccess::accept_written(const Data& answer, std::uint64_t time_us) {
  if ((answer[0] & sdo::kSpecifierMask) != sdo::kDownloadSegmentResponse)
    return abort(AbortCode::kCommandSpecifierUnknown, time_us);
  if ((answer[0] & sdo::kToggle) != toggle_) return abort(AbortCode::kToggleBitNotAlternated, time_us);
  if (written_ == active_->data.size()) return end(AbortCode::kNone, time_us);
  toggle_ ^= sdo::kToggle;
  send_segment(time_us);
}

void ObjectAccess::accept_segment(const Data& answer, std::uint64_t time_us) {
  if ((answer[0] & sdo::kSpecifierMask) != sdo::kUploadSegmentResponse)
    return abort(AbortCode::kCommandSpecifierUnknown, time_us);
  if ((answer[0] & sdo::kToggle) != toggle_) return abort(AbortCode::kToggleBitNotAlternated, time_us);
  const std::size_t size = sdo::segment_size(answer[0]);
  if (read_.size() + size > kMaxBytes) return abort(AbortCode::kOutOfMemory, time_us);
  read_.insert(read_.end(), answer.begin() + 1, answer.begin() + 1 + static_cast<std::ptrdiff_t>(size));
  if ((answer[0] & sdo::kLastSegment) != 0) return end(AbortCode::kNone, time_us);
  toggle_ ^= sdo::kToggle;
  request_segment(time_us);
}

void ObjectAccess::abort(AbortCode code, std::uint64_t time_us) {
  send(sdo::message(sdo::kAbort, active_->address, static_cast<std::uint32_t>(code)), time_us);
  end(code, time_us);
}

void ObjectAccess::end(AbortCode code, std::uint64_t time_us) {
  ObjectAnswer answer{.number = active_->number, .time_us = time_us, .abort = code};
  if (code == AbortCode::kNone) answer.data = std::exchange(read_, {});
  answers_.push_back(std::move(answer));
  active_.reset();
}

void ObjectAccess::archive(sim_board::StateArchive& archive) {
  archive(waiting_, active_, answers_, read_, written_, toggle_, segmented_, deadline_us_);
}

}  // namespace koboshi::simulation
