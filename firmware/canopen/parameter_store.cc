#include "firmware/canopen/parameter_store.h"

#include <array>
#include <cstring>
#include <utility>

#include "firmware/canopen/frame.h"

namespace koboshi::canopen {
namespace {

constexpr std::size_t kRecordSize = 8;

}  // namespace

struct ParameterStore::Record {
  std::array<std::uint8_t, kRecordSize> bytes{};

  explicit Record(const ParameterValue& parameter) {
    store_u16(&bytes[0], parameter.address.index);
    bytes[2] = parameter.address.subindex;
    bytes[3] = parameter.size_bytes;
    store_u32(&bytes[4], parameter.value);
  }
};

namespace {

// The record at `offset`; false where there is none.
bool read(std::span<const std::byte> stored, std::size_t offset, ParameterValue& parameter) {
  if (stored.size() < offset + kRecordSize) return false;
  std::array<std::uint8_t, kRecordSize> bytes;
  std::memcpy(bytes.data(), stored.data() + offset, kRecordSize);
  parameter = {{load_u16(&bytes[0]), bytes[2]}, bytes[3], load_u32(&bytes[4])};
  return true;
}

}  // namespace

// First what is stored of the other groups, then what the node has of this one.
bool ParameterStore::next(Change wanted, Cursor& cursor, ParameterValue& parameter) const {
  const auto stored = items_.find(kind_, 0);
  while (read(stored, cursor.stored, parameter)) {
    cursor.stored += kRecordSize;
    if (!covers(wanted.group, parameter.address.index)) return true;
  }
  while (wanted.keeps && node_.parameter(cursor.present, parameter)) {
    ++cursor.present;
    if (covers(wanted.group, parameter.address.index)) return true;
  }
  return false;
}

void ParameterStore::load(ParameterGroup group) {
  abandon();
  const auto stored = items_.find(kind_, 0);
  ParameterValue parameter;
  for (std::size_t offset = 0; read(stored, offset, parameter); offset += kRecordSize) {
    if (covers(group, parameter.address.index)) node_.restore(parameter);
  }
}

bool ParameterStore::is_stored(Change wanted) const {
  const auto stored = items_.find(kind_, 0);
  Cursor cursor;
  ParameterValue parameter;
  ParameterValue there;
  std::size_t offset = 0;
  for (; next(wanted, cursor, parameter); offset += kRecordSize) {
    if (!read(stored, offset, there) || there != parameter) return false;
  }
  return offset == stored.size();
}

AbortCode ParameterStore::change(Change wanted, bool may_begin) {
  if (busy_) return AbortCode::kBusy;
  if (failure_ != AbortCode::kNone) return std::exchange(failure_, AbortCode::kNone);
  if (is_stored(wanted)) return AbortCode::kNone;
  if (!may_begin) return AbortCode::kDeviceState;
  busy_ = true;
  wanted_ = wanted;
  cursor_ = {};
  return AbortCode::kBusy;
}

void ParameterStore::go_on() {
  const AbortCode code = advance();
  if (code == AbortCode::kBusy) return;
  abandon();
  failure_ = code;
}

void ParameterStore::abandon() {
  if (begun_) items_.release();
  busy_ = false;
  begun_ = false;
  failure_ = AbortCode::kNone;
}

AbortCode ParameterStore::advance() {
  if (!begun_) {
    const AbortCode code = items_.begin(kind_, 0);
    if (code != AbortCode::kNone) return code;
    begun_ = true;
  }
  for (;;) {
    Cursor ahead = cursor_;
    ParameterValue parameter;
    if (!next(wanted_, ahead, parameter)) return items_.commit();
    const Record record(parameter);
    const AbortCode code = items_.append(std::as_bytes(std::span(record.bytes)));
    if (code != AbortCode::kNone) return code;
    cursor_ = ahead;
  }
}

}  // namespace koboshi::canopen
