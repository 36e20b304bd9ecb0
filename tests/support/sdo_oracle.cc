#include "tests/support/sdo_oracle.h"

#include <algorithm>

namespace koboshi::test {

namespace sdo = canopen::sdo;
using sdo::Data;

namespace {

constexpr std::uint8_t kSequenceMask = 0x7F;

std::uint8_t specifier(const Data& data) { return data[0] & sdo::kSpecifierMask; }
std::uint8_t subcommand(const Data& data) { return data[0] & sdo::kBlockSubcommandMask; }
bool is_last_of_block(const Data& data) { return (data[0] & sdo::kBlockLastSegment) != 0; }

}  // namespace

SdoOracle::Answer SdoOracle::owed(const Data& request) const {
  if (request[0] == sdo::kAbort) return Answer::kNone;
  if (phase_ == Phase::kBlockDownload) {
    const std::uint8_t sequence = request[0] & kSequenceMask;
    const bool ends_block = sequence == sdo::kMaxBlockSize || is_last_of_block(request);
    return sequence == 0 || ends_block ? Answer::kOne : Answer::kPerhapsAbort;
  }
  const bool ends_block_upload = phase_ == Phase::kBlockUploadEnd &&
                                 specifier(request) == sdo::kBlockUploadRequest &&
                                 subcommand(request) == sdo::kBlockEnd;
  return ends_block_upload ? Answer::kNone : Answer::kOne;
}

void SdoOracle::note(const Data& request, const std::vector<hal::CanFrame>& answers) {
  const bool aborted =
      std::ranges::any_of(answers, [](const hal::CanFrame& answer) { return answer.data[0] == sdo::kAbort; });
  if (request[0] == sdo::kAbort || aborted) {
    phase_ = Phase::kIdle;
    return;
  }
  if (phase_ == Phase::kBlockDownload) return note_block_segment(request, answers);
  if (owed(request) == Answer::kNone) {
    ++completed_.block_uploads;
    phase_ = Phase::kIdle;
    return;
  }
  if (answers.empty()) return;  // the test fails
  const Data& answer = answers.front().data;
  const bool carries_on_block_upload =
      specifier(request) == sdo::kBlockUploadRequest && subcommand(request) != sdo::kBlockInitiate;
  if (carries_on_block_upload) return note_block_upload(request, answers);
  switch (specifier(request)) {
    case sdo::kDownloadSegmentRequest:
    case sdo::kUploadSegmentRequest:
      return note_segment(request, answer);
    case sdo::kBlockDownloadRequest:
      if ((request[0] & 1) == sdo::kBlockEnd) {
        ++completed_.block_downloads;
        phase_ = Phase::kIdle;
        return;
      }
      break;
    default:
      break;
  }
  note_initiated(request, answer);
}

void SdoOracle::note_initiated(const Data& request, const Data& answer) {
  toggle_ = false;
  sequence_ = 0;
  last_ = false;
  phase_ = Phase::kIdle;
  switch (specifier(answer)) {
    case sdo::kInitiateDownloadResponse:
      if (sdo::is_expedited(request[0], sdo::kInitiateDownloadRequest)) {
        ++completed_.expedited_downloads;
      } else {
        phase_ = Phase::kDownload;
      }
      return;
    case sdo::kInitiateUploadResponse:
      if (sdo::is_expedited(answer[0], sdo::kInitiateUploadResponse)) {
        ++completed_.expedited_uploads;
      } else {
        phase_ = Phase::kUpload;
      }
      return;
    case sdo::kBlockDownloadResponse:
      phase_ = Phase::kBlockDownload;
      return;
    case sdo::kBlockUploadResponse:
      phase_ = Phase::kBlockUploadStart;
      return;
    default:
      return;
  }
}

void SdoOracle::note_segment(const Data& request, const Data& answer) {
  toggle_ = !toggle_;
  if (phase_ == Phase::kDownload && (request[0] & sdo::kLastSegment) != 0) {
    ++completed_.segmented_downloads;
    phase_ = Phase::kIdle;
  }
  if (phase_ == Phase::kUpload && (answer[0] & sdo::kLastSegment) != 0) {
    ++completed_.segmented_uploads;
    phase_ = Phase::kIdle;
  }
}

void SdoOracle::note_block_segment(const Data& request, const std::vector<hal::CanFrame>& answers) {
  const std::uint8_t sequence = request[0] & kSequenceMask;
  if (sequence == sequence_ + 1) {
    sequence_ = sequence;
    last_ = is_last_of_block(request);
  }
  if (answers.empty()) return;
  // Resends the segments that the server did not accept.
  if (last_ && answers.front().data[1] == sequence_) phase_ = Phase::kBlockDownloadEnd;
  sequence_ = 0;
  last_ = false;
}

void SdoOracle::note_block_upload(const Data& request, const std::vector<hal::CanFrame>& answers) {
  const bool confirms_all = subcommand(request) == sdo::kBlockConfirm && last_ && request[1] == sequence_;
  if (confirms_all) {
    phase_ = Phase::kBlockUploadEnd;
    return;
  }
  phase_ = Phase::kBlockUpload;
  sequence_ = answers.back().data[0] & kSequenceMask;
  last_ = is_last_of_block(answers.back().data);
}

Data SdoOracle::next(Random& random, canopen::ObjectAddress address) const {
  const auto toggle = static_cast<std::uint8_t>(toggle_ ? sdo::kToggle : 0);
  Data data{};
  for (std::uint8_t& byte : data) byte = static_cast<std::uint8_t>(random.next());
  const std::uint8_t unused = static_cast<std::uint8_t>(random.below(8));  // 7: a segment without data
  const bool ends = random.below(3) == 0;
  switch (phase_) {
    case Phase::kIdle:
      return begin(random, address);
    case Phase::kDownload:
      data[0] = static_cast<std::uint8_t>(sdo::kDownloadSegmentRequest | toggle | unused << 1 |
                                          (ends ? sdo::kLastSegment : 0));
      return data;
    case Phase::kUpload:
      data[0] = sdo::kUploadSegmentRequest | toggle;
      return data;
    case Phase::kBlockDownload:
      data[0] = static_cast<std::uint8_t>((sequence_ + 1) | (ends ? sdo::kBlockLastSegment : 0));
      return data;
    case Phase::kBlockDownloadEnd:
      data[0] = static_cast<std::uint8_t>(sdo::kBlockDownloadRequest | sdo::kBlockEnd | unused << 2);
      return data;
    case Phase::kBlockUploadStart:
      data[0] = sdo::kBlockUploadRequest | sdo::kBlockStartUpload;
      return data;
    case Phase::kBlockUpload:
      data[0] = sdo::kBlockUploadRequest | sdo::kBlockConfirm;
      data[1] = ends ? static_cast<std::uint8_t>(random.below(sequence_ + 1u)) : sequence_;
      data[2] = static_cast<std::uint8_t>(1 + random.below(sdo::kMaxBlockSize));
      return data;
    case Phase::kBlockUploadEnd:
      data[0] = sdo::kBlockUploadRequest | sdo::kBlockEnd;
      return data;
  }
  return data;
}

// Announces sizes that are small, zero or far too large.
Data SdoOracle::begin(Random& random, canopen::ObjectAddress address) {
  static constexpr std::uint8_t kCommands[] = {0x20, 0x21, 0x22, 0x23, 0x27, 0x2B, 0x2F, 0x40,
                                               0x40, 0xA0, 0xA4, 0xC0, 0xC2, 0xC4, 0xC6};
  const std::uint32_t value = random.below(2) == 0 ? random.below(8) : random.next() >> random.below(32);
  Data data = sdo::message(random.one_of(kCommands), address, value);
  if (specifier(data) == sdo::kBlockUploadRequest)
    data[4] = static_cast<std::uint8_t>(random.below(sdo::kMaxBlockSize + 2u));
  return data;
}

}  // namespace koboshi::test
