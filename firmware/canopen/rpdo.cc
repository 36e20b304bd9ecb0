#include "firmware/canopen/rpdo.h"

#include <algorithm>

namespace koboshi::canopen {

void RpdoSet::update_identifiers() {
  slots_.clear();
  for (std::size_t i = 0; i < pdos_.size(); ++i) {
    if (pdos_[i].record.valid()) slots_.insert(pdos_[i].record.identifier(), static_cast<std::uint8_t>(i));
  }
}

void RpdoSet::clear_pending() {
  for (Rpdo& pdo : pdos_) pdo.pending = false;
}

bool RpdoSet::any(Length length) const {
  return std::any_of(pdos_.begin(), pdos_.end(), [length](const Rpdo& pdo) { return pdo.length == length; });
}

}  // namespace koboshi::canopen
