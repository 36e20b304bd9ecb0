#include "firmware/app/network_watch.h"

#include "firmware/app/dictionary.h"
#include "firmware/fixed/saturating.h"

namespace koboshi::app {

using behaviour::Reason;

std::uint64_t NetworkWatch::begin_boot(std::uint64_t now_us) {
  started_us_ = now_us;
  impostors_ = 0;
  const std::uint64_t reset_us = listens_ ? now_us + kListen_us : now_us;
  listens_ = false;
  return reset_us;
}

bool NetworkWatch::on_impostor() {
  impostor_heard_ = true;
  listens_ = listens_ || drives_.resetting();
  return drives_.resetting();
}

drive::Starting NetworkWatch::starting(std::uint32_t nmt_startup) const {
  if (!operational()) return drive::Starting::kLater;
  if ((nmt_startup & kNoSlaveStart) != 0) return drive::Starting::kByOthers;
  return (nmt_startup & kStartsTogether) != 0 ? drive::Starting::kTogether : drive::Starting::kEach;
}

behaviour::NetworkStatus NetworkWatch::update(bool boots, std::uint64_t now_us) {
  behaviour::NetworkStatus status;
  // Outside operational no target reaches a drive. Only a boot may wait in pre-operational, until it has to
  // start the drives.
  const bool waits = boots && !drives_.configured() && node_.state() == canopen::NmtState::kPreOperational;
  status.left = !operational() && !waits;
  status.sensors_starting = !operational() || now_us - started_us_ < kSensorStart_us;
  status.bus = watch_bus(now_us);
  const bool second_master = watch_impostors();
  if (status.bus == Reason::kNone && second_master) status.bus = Reason::kSecondMaster;
  return status;
}

Reason NetworkWatch::watch_bus(std::uint64_t now_us) {
  can_status_ = can_.status();
  hal::CanStatus status = can_status_;
  // A lone node is error-passive, since nobody acknowledges its frames. While the drives boot, that is no
  // error.
  const bool booting = now_us - started_us_ < kBusTimeout_us;
  if (booting && status.state == hal::CanErrorState::kErrorPassive)
    status.state = hal::CanErrorState::kErrorActive;
  node_.on_can_status(status, now_us);
  if (status.state == hal::CanErrorState::kBusOff) {
    can_.recover();
    return Reason::kBusOff;
  }
  // If drives answer, the bus is disturbed but works, and the emergency message is enough.
  const bool alone = status.state == hal::CanErrorState::kErrorPassive && !drives_.answering();
  return alone ? Reason::kNoAcknowledge : Reason::kNone;
}

// Tolerates single frames, which a person may send with cansend.
bool NetworkWatch::watch_impostors() {
  if (impostor_heard_) {
    impostors_ = fixed::add_saturated(impostors_, std::uint8_t{2});
  } else if (impostors_ > 0) {
    --impostors_;
  }
  impostor_heard_ = false;
  if (impostors_ < kMaxImpostors) return false;
  listens_ = true;
  return true;
}

}  // namespace koboshi::app
