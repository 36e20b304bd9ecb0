#include "sim_board/state/archive.h"

#include <algorithm>

namespace koboshi::sim_board {
namespace {

constexpr std::byte kErased{0xFF};

[[noreturn]] void refuse() {
  throw std::logic_error("a state is restored into objects of another number than it was saved from");
}

}  // namespace

void StateArchive::bytes(std::span<std::byte> bytes) {
  if (writes()) {
    to_->bytes_.insert(to_->bytes_.end(), bytes.begin(), bytes.end());
  } else {
    std::ranges::copy(next_bytes(bytes.size()), bytes.begin());
  }
}

void StateArchive::flash(std::span<std::byte> bytes) {
  const auto last =
      std::find_if(bytes.rbegin(), bytes.rend(), [](std::byte byte) { return byte != kErased; });
  std::size_t used = static_cast<std::size_t>(bytes.rend() - last);
  visit(used);
  this->bytes(bytes.first(used));
  if (!writes()) std::ranges::fill(bytes.subspan(used), kErased);
}

void StateArchive::same(std::size_t count) {
  std::size_t saved = count;
  visit(saved);
  if (saved != count) refuse();
}

void StateArchive::end() const {
  if (next_byte_ != from_->bytes_.size() || next_copy_ != from_->copies_.size()) refuse();
}

std::span<const std::byte> StateArchive::next_bytes(std::size_t count) {
  if (count > from_->bytes_.size() - next_byte_) refuse();
  const auto bytes = std::span(from_->bytes_).subspan(next_byte_, count);
  next_byte_ += count;
  return bytes;
}

const void* StateArchive::next_copy() {
  if (next_copy_ == from_->copies_.size()) refuse();
  return from_->copies_[next_copy_++].get();
}

}  // namespace koboshi::sim_board
