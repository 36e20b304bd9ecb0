#pragma once

#include <vector>

#include "hal/port/can.h"
#include "tests/support/random_frames.h"

namespace koboshi::test {

// Predicts from a client's view which requests an SDO server must answer (CiA 301, 7.2.4.3). It uses only the
// frames and shares no code with the server.
class SdoOracle {
 public:
  enum class Answer {
    kNone,
    kPerhapsAbort,  // no answer or an abort, within a block
    kOne,           // one or more answers, or an abort
  };
  // Returns the answer that CiA 301 requires to this request.
  Answer owed(const canopen::sdo::Data& request) const;
  // Records a request and the server's answers.
  void note(const canopen::sdo::Data& request, const std::vector<hal::CanFrame>& answers);
  // Returns a valid next request of the present transfer, or a random request if there is none.
  canopen::sdo::Data next(Random& random, canopen::ObjectAddress address) const;

  // Number of transfers that were completed, by kind.
  struct Completed {
    int expedited_downloads = 0;
    int segmented_downloads = 0;
    int block_downloads = 0;
    int expedited_uploads = 0;
    int segmented_uploads = 0;
    int block_uploads = 0;
  };
  const Completed& completed() const { return completed_; }

 private:
  enum class Phase {
    kIdle,
    kDownload,
    kUpload,
    kBlockDownload,
    kBlockDownloadEnd,
    kBlockUploadStart,
    kBlockUpload,
    kBlockUploadEnd,
  };

  void note_initiated(const canopen::sdo::Data& request, const canopen::sdo::Data& answer);
  void note_segment(const canopen::sdo::Data& request, const canopen::sdo::Data& answer);
  void note_block_segment(const canopen::sdo::Data& request, const std::vector<hal::CanFrame>& answers);
  void note_block_upload(const canopen::sdo::Data& request, const std::vector<hal::CanFrame>& answers);
  static canopen::sdo::Data begin(Random& random, canopen::ObjectAddress address);

  Phase phase_ = Phase::kIdle;
  bool toggle_ = false;
  std::uint8_t sequence_ = 0;  // sequence number of the last segment of the block, sent in order or received
  bool last_ = false;          // that segment was the last of the transfer
  Completed completed_;
};

}  // namespace koboshi::test
