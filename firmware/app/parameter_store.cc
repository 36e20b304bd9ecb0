#include "firmware/app/parameter_store.h"

#include <algorithm>
#include <array>
#include <utility>

#include "firmware/app/dictionary.h"
#include "firmware/canopen/frame.h"

namespace koboshi::app {

using canopen::AbortCode;
using canopen::ObjectAddress;

namespace {

constexpr std::size_t kRecordSize = 8;

bool is_parameter(const canopen::Entry& row) {
  return row.access == canopen::Access::kReadWrite && row.mappable == canopen::Mappable::kNo &&
         row.type != canopen::DataType::kDomain;
}

}  // namespace

struct ParameterStore::Record {
  std::array<std::uint8_t, kRecordSize> bytes{};

  Record() = default;
  Record(ObjectAddress address, const canopen::ObjectValue& value) {
    canopen::store_u16(&bytes[0], address.index);
    bytes[2] = address.subindex;
    bytes[3] = static_cast<std::uint8_t>(value.size());
    canopen::store_u32(&bytes[4], value.number());
  }
  explicit Record(std::span<const std::byte> stored) {
    std::ranges::transform(stored, bytes.begin(), std::to_integer<std::uint8_t>);
  }
  ObjectAddress address() const { return {canopen::load_u16(&bytes[0]), bytes[2]}; }
  std::uint32_t value() const { return canopen::load_u32(&bytes[4]); }
  friend bool operator==(const Record&, const Record&) = default;
};

// Parameter `number`, counted through the table.
bool ParameterStore::find(std::size_t number, Record& record) const {
  for (const canopen::Entry& row : kControllerNode.rows) {
    if (!is_parameter(row)) continue;
    if (number >= row.count) {
      number -= row.count;
      continue;
    }
    const ObjectAddress address{row.index, static_cast<std::uint8_t>(row.subindex + number)};
    canopen::ObjectValue value;
    if (node_.read_object(address, value) != AbortCode::kNone) return false;
    record = Record(address, value);
    return true;
  }
  return false;
}

void ParameterStore::load(std::uint16_t last) {
  for (auto rest = items_.find(ItemKind::kParameters, 0); rest.size() >= kRecordSize;
       rest = rest.subspan(kRecordSize)) {
    const Record record(rest.first(kRecordSize));
    const auto row = std::ranges::find_if(kControllerNode.rows, [&](const canopen::Entry& candidate) {
      return candidate.index == record.address().index && is_parameter(candidate);
    });
    // Another firmware's may be unknown here, or out of range.
    if (row == kControllerNode.rows.end() || row->index > last) continue;
    static_cast<void>(node_.set_value(record.address(), record.value(), record.bytes[3]));
  }
}

bool ParameterStore::is_stored(Wanted wanted) const {
  auto stored = items_.find(ItemKind::kParameters, 0);
  if (wanted == Wanted::kFactory) return stored.empty();
  Record present;
  for (std::size_t number = 0; find(number, present); ++number) {
    if (stored.size() < kRecordSize || Record(stored.first(kRecordSize)) != present) return false;
    stored = stored.subspan(kRecordSize);
  }
  return stored.empty();
}

AbortCode ParameterStore::store(Wanted wanted, bool may_begin) {
  if (busy_) return AbortCode::kBusy;
  if (failure_ != AbortCode::kNone) return std::exchange(failure_, AbortCode::kNone);
  if (is_stored(wanted)) return AbortCode::kNone;
  if (!may_begin) return AbortCode::kDeviceState;
  busy_ = true;
  wanted_ = wanted;
  next_ = 0;
  return AbortCode::kBusy;
}

void ParameterStore::go_on() {
  const AbortCode code = advance();
  if (code == AbortCode::kBusy) return;
  if (begun_) items_.release();
  busy_ = false;
  begun_ = false;
  failure_ = code;
}

AbortCode ParameterStore::advance() {
  if (!begun_) {
    const AbortCode code = items_.begin(ItemKind::kParameters, 0);
    if (code != AbortCode::kNone) return code;
    begun_ = true;
  }
  Record record;
  for (; wanted_ == Wanted::kPresent && find(next_, record); ++next_) {
    const AbortCode code = items_.append(std::as_bytes(std::span(record.bytes)));
    if (code != AbortCode::kNone) return code;
  }
  return items_.commit();
}

}  // namespace koboshi::app
