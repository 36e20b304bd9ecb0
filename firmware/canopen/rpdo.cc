#include "firmware/canopen/rpdo.h"

#include <algorithm>

namespace koboshi::canopen {

void RpdoSet::on_changed(std::size_t number) {
  pdos_[number].pending = false;
  pdos_[number].deadline_us = Rpdo::kNever;
  slots_.clear();
  for (std::size_t i = 0; i < pdos_.size(); ++i) {
    if (pdos_[i].record.valid()) slots_.insert(pdos_[i].record.identifier(), static_cast<std::uint8_t>(i));
  }
}

void RpdoSet::stop() {
  for (Rpdo& pdo : pdos_) {
    pdo.pending = false;
    pdo.deadline_us = Rpdo::kNever;
  }
}

bool RpdoSet::any(Reception reception) const {
  return std::ranges::any_of(pdos_, [reception](const Rpdo& pdo) { return pdo.reception == reception; });
}

void RpdoSet::set_deadline(Rpdo& pdo, std::uint64_t deadline_us) {
  pdo.deadline_us = deadline_us;
  earliest_us_ = std::min(earliest_us_, deadline_us);
}

bool RpdoSet::find_silent(std::uint64_t now_us, std::size_t& number) {
  earliest_us_ = Rpdo::kNever;
  for (const Rpdo& pdo : pdos_) earliest_us_ = std::min(earliest_us_, pdo.deadline_us);
  if (now_us < earliest_us_) return false;
  const auto silent =
      std::ranges::find_if(pdos_, [now_us](const Rpdo& pdo) { return now_us >= pdo.deadline_us; });
  silent->deadline_us = Rpdo::kNever;
  number = static_cast<std::size_t>(silent - pdos_.begin());
  return true;
}

}  // namespace koboshi::canopen
