#include "firmware/storage/parameter_store.h"

#include <array>
#include <utility>

#include "firmware/storage/image.h"

namespace koboshi::storage {
namespace {

std::array<std::byte, ParameterRecord::kSize_bytes> encode(const ParameterRecord& record) {
  std::array<std::byte, ParameterRecord::kSize_bytes> bytes;
  FieldWriter writer(bytes);
  writer.u16(record.index);
  writer.u8(record.subindex);
  writer.u8(record.size_bytes);
  writer.u32(record.value);
  return bytes;
}

}  // namespace

bool read_record(std::span<const std::byte> item, std::size_t offset, ParameterRecord& record) {
  if (item.size() < offset + ParameterRecord::kSize_bytes) return false;
  ImageReader reader(item.subspan(offset));
  record.index = reader.u16();
  record.subindex = reader.u8();
  record.size_bytes = reader.u8();
  record.value = reader.u32();
  return true;
}

// First the stored records outside the range, then the owner's present values in it.
bool ParameterStore::next(Change wanted, Cursor& cursor, ParameterRecord& record) const {
  const auto item = stored();
  while (read_record(item, cursor.stored_bytes, record)) {
    cursor.stored_bytes += ParameterRecord::kSize_bytes;
    if (!wanted.range.contains(record.index)) return true;
  }
  while (wanted.keeps && owner_.next_parameter(cursor.present, record)) {
    if (wanted.range.contains(record.index)) return true;
  }
  return false;
}

void ParameterStore::load(IndexRange range) {
  abandon();
  const auto item = stored();
  ParameterRecord record;
  for (std::size_t offset = 0; read_record(item, offset, record); offset += ParameterRecord::kSize_bytes) {
    if (range.contains(record.index)) owner_.restore(record);
  }
}

bool ParameterStore::is_stored(Change wanted) const {
  const auto item = stored();
  Cursor cursor;
  ParameterRecord record;
  ParameterRecord there;
  std::size_t offset = 0;
  for (; next(wanted, cursor, record); offset += ParameterRecord::kSize_bytes) {
    if (!read_record(item, offset, there) || there != record) return false;
  }
  return offset == item.size();
}

std::size_t ParameterStore::size_bytes(Change wanted) const {
  Cursor cursor;
  ParameterRecord record;
  std::size_t size = 0;
  while (next(wanted, cursor, record)) size += ParameterRecord::kSize_bytes;
  return size;
}

Status ParameterStore::change(Change wanted, bool may_write) {
  if (busy_) return Status::kBusy;
  if (failure_ != Status::kOk && failed_ == wanted) return std::exchange(failure_, Status::kOk);
  if (is_stored(wanted)) return Status::kOk;
  if (!may_write) return Status::kNotAllowed;
  busy_ = true;
  wanted_ = wanted;
  size_bytes_ = size_bytes(wanted);
  cursor_ = {};
  return Status::kBusy;
}

void ParameterStore::advance() {
  const Status status = write_records();
  if (status == Status::kBusy) return;
  end();
  if (status == Status::kOk) return;
  failed_ = wanted_;
  failure_ = status;
}

void ParameterStore::abandon() {
  end();
  failure_ = Status::kOk;
}

void ParameterStore::end() {
  if (begun_) items_.release();
  busy_ = false;
  begun_ = false;
}

Status ParameterStore::write_records() {
  if (!begun_) {
    const Status begun = items_.begin(ItemKind::kParameters, 0, size_bytes_);
    if (begun != Status::kOk) return begun;
    begun_ = true;
  }
  for (;;) {
    Cursor ahead = cursor_;
    ParameterRecord record;
    if (!next(wanted_, ahead, record)) return items_.commit();
    const Status appended = items_.append(encode(record));
    if (appended != Status::kOk) return appended;
    cursor_ = ahead;
  }
}

}  // namespace koboshi::storage
