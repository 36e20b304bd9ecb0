#pragma once

#include <vector>

#include "hal/port/can.h"
#include "tests/support/random_frames.h"

namespace koboshi::test {

// What CiA 301, 7.2.4.3, expects of an SDO server, as its client sees it: which requests are answered. It
// follows the frames alone and knows nothing of the server's code.
class SdoOracle {
 public:
  enum class Answer {
    kNone,
    kPerhapsAbort,  // a segment within a block: none, or an abort
    kOne,           // or several, or an abort
  };
  // What the server owes to this request.
  Answer owed(const canopen::sdo::Data& request) const;
  // The request was made, and these frames came back.
  void note(const canopen::sdo::Data& request, const std::vector<hal::CanFrame>& answers);
  // A request that carries on with the present transfer as a client would; a random one when there is none.
  canopen::sdo::Data next(Random& random, canopen::ObjectAddress address) const;

  // Transfers that came to their proper end, by their kind.
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
  std::uint8_t sequence_ = 0;  // of the last segment of the block, sent in order or received
  bool last_ = false;          // that segment was the last of all
  Completed completed_;
};

}  // namespace koboshi::test
