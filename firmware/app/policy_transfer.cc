#include "firmware/app/policy_transfer.h"

#include "firmware/canopen/node/stored_parameters.h"

namespace koboshi::app {

using canopen::abort_code_of;
using canopen::AbortCode;

AbortCode PolicyTransfer::commit() {
  if (!checked_) {
    const AbortCode flushed = abort_code_of(items_.flush());
    if (flushed != AbortCode::kNone) return flushed;
    const bool valid = policy::Policy::open(items_.written(), model_, policy_).ok();
    if (!valid || policy_.image_size_bytes() != items_.written().size()) return AbortCode::kInvalidValue;
    checked_ = true;
  }
  const AbortCode committed = abort_code_of(items_.commit());
  if (committed == AbortCode::kNone) slot_.add(policy_);
  return committed;
}

}  // namespace koboshi::app
