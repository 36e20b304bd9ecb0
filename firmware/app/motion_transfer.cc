#include "firmware/app/motion_transfer.h"

#include "firmware/canopen/node/stored_parameters.h"

namespace koboshi::app {

using canopen::abort_code_of;
using canopen::AbortCode;

AbortCode MotionTransfer::commit() {
  if (!checked_) {
    const AbortCode flushed = abort_code_of(items_.flush());
    if (flushed != AbortCode::kNone) return flushed;
    const bool valid = motion::Motion::open(items_.written(), model_, motion_).ok();
    if (!valid || motion_.image_size_bytes() != items_.written().size()) return AbortCode::kInvalidValue;
    checked_ = true;
  }
  const AbortCode committed = abort_code_of(items_.commit());
  if (committed == AbortCode::kNone) motions_.add(number_, motion_);
  return committed;
}

}  // namespace koboshi::app
