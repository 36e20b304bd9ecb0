#include "firmware/policy/policy_slot.h"

namespace koboshi::policy {

void PolicySlot::load() {
  ++changes_;
  const auto image = this->image();
  status_ = image.empty() ? PolicyStatus::kTruncated : Policy::open(image, model_, policy_).status;
}

void PolicySlot::add(const Policy& policy) {
  ++changes_;
  policy_ = policy;
  status_ = PolicyStatus::kOk;
}

storage::Status PolicySlot::erase() {
  const storage::Status status = stored_.erase(storage::ItemKind::kPolicy, 0);
  if (status == storage::Status::kOk) load();
  return status;
}

std::span<const std::byte> PolicySlot::image() const {
  const auto stored = stored_.find(storage::ItemKind::kPolicy, 0);
  return stored.empty() ? factory_.find(storage::ItemKind::kPolicy, 0) : stored;
}

// The log moves its items when it needs space.
const Policy* PolicySlot::open() {
  if (status_ != PolicyStatus::kOk) return nullptr;
  const auto image = this->image();
  if (image.size() < policy_.image_size_bytes()) return nullptr;
  policy_.move_to(image.data());
  return &policy_;
}

}  // namespace koboshi::policy
