#include "bus/dictionary/object_dictionary.h"

#include <algorithm>
#include <bit>
#include <utility>

#include <fmt/core.h>

#include "bus/dictionary/communication_area.h"
#include "firmware/canopen/dictionary.h"

namespace koboshi::bus {
namespace {

using canopen::DataType;
using canopen::DescribedObject;
using canopen::Entry;

std::string access_of(const Entry& row) {
  if (row.offset == Entry::kConstant && row.type != DataType::kDomain) return "const";
  switch (row.access) {
    case canopen::Access::kReadOnly:
      return "ro";
    case canopen::Access::kWriteOnly:
      return "wo";
    case canopen::Access::kReadWrite:
      break;
  }
  return row.mappable == canopen::Mappable::kRpdo ? "rww" : "rw";
}

// Only settings have a default: neither measurements nor objects that RPDOs carry. A default outside of its
// limits differs between nodes.
std::string default_of(const ObjectItem& item, const Entry& row, std::span<const std::byte> values) {
  if (row.offset == Entry::kComputed) return {};
  if (row.access == canopen::Access::kReadOnly && row.offset != Entry::kConstant) return {};
  if (row.mappable == canopen::Mappable::kRpdo || row.mappable == canopen::Mappable::kBoth) return {};
  std::vector<std::byte> copy(values.begin(), values.end());
  const canopen::Dictionary dictionary({&row, 1}, copy);
  canopen::ObjectValue value;
  if (dictionary.read(item.address, value) != canopen::AbortCode::kNone) return {};
  const std::int64_t number = canopen::integer_of(value.number(), row.type);
  const bool outside = item.limits && (number < item.limits->low || number > item.limits->high);
  return outside ? std::string() : fmt::format("{}", number);
}

std::string name_of(const DescribedObject& described, std::size_t element) {
  const canopen::ObjectText& text = described.text;
  if (described.entry.count == 1) return std::string(text.name);
  if (text.elements.empty()) return fmt::format("{} {}", text.name, element + 1);
  return fmt::format("{} {}", text.name, text.elements[element]);
}

ObjectItem make_item(const DescribedObject& described, std::size_t element,
                     std::span<const std::byte> values) {
  const Entry& row = described.entry;
  ObjectItem item;
  item.address = {row.index, static_cast<std::uint8_t>(row.subindex + element)};
  item.name = name_of(described, element);
  item.data_type = static_cast<std::uint8_t>(row.type);
  item.access = access_of(row);
  item.mappable = row.mappable;
  const std::uint32_t highest =
      row.listed ? row.low + static_cast<std::uint32_t>(std::bit_width(row.high)) - 1 : row.high;
  if (row.limited || row.listed)
    item.limits = {canopen::integer_of(row.low, row.type), canopen::integer_of(highest, row.type)};
  item.default_value = default_of(item, row, values);
  item.unit = described.text.unit;
  item.values = described.text.values;
  item.comment = described.text.comment;
  if (row.count > 1 && described.text.elements.empty()) item.family = described.text.name;
  return item;
}

// An index with sub-indices is an array when all are of one row, and else a record.
void add_row(std::vector<Object>& objects, const DescribedObject& described,
             std::span<const std::byte> values) {
  const Entry& row = described.entry;
  const std::string name(described.text.name);
  const std::string comment(described.text.comment);
  if (described.is_heading()) {
    objects.push_back({row.index, ObjectType::kArray, name, {highest_subindex(row.index, 0)}, comment, {}});
    return;
  }
  if (row.subindex == 0) {
    objects.push_back(
        {row.index, ObjectType::kVariable, name, {make_item(described, 0, values)}, comment, {}});
    return;
  }
  Object& object = objects.back();
  if (object.items.size() > 1) object.type = ObjectType::kRecord;
  for (std::size_t i = 0; i < row.count; ++i) object.items.push_back(make_item(described, i, values));
  object.items.front().default_value = fmt::format("{}", object.items.back().address.subindex);
}

}  // namespace

const ObjectItem* NodeKind::find(canopen::ObjectAddress address) const {
  const auto object = std::find_if(objects.begin(), objects.end(),
                                   [&](const Object& other) { return other.index == address.index; });
  if (object == objects.end()) return nullptr;
  const auto item = std::find_if(object->items.begin(), object->items.end(),
                                 [&](const ObjectItem& other) { return other.address == address; });
  return item == object->items.end() ? nullptr : &*item;
}

NodeKind make_node_kind(std::string name, const canopen::NodeDescription& description,
                        const NodeCapacity& capacity, std::span<const DescribedObject> table,
                        std::span<const std::byte> values, const InstanceDefaults& instance) {
  NodeKind kind{std::move(name), description, capacity, communication_area(description, capacity, instance)};
  for (const DescribedObject& described : table) add_row(kind.objects, described, values);
  return kind;
}

unsigned size_bits(std::uint8_t data_type) {
  return 8u * canopen::size_bytes(static_cast<DataType>(data_type));
}

bool is_signed(std::uint8_t data_type) { return canopen::is_signed(static_cast<DataType>(data_type)); }

std::string data_type_name(std::uint8_t data_type) {
  if (data_type == kVisibleString) return "VISIBLE_STRING";
  if (data_type == static_cast<std::uint8_t>(DataType::kBoolean)) return "BOOLEAN";
  if (data_type == static_cast<std::uint8_t>(DataType::kDomain)) return "DOMAIN";
  return fmt::format("{}{}", is_signed(data_type) ? "INTEGER" : "UNSIGNED", size_bits(data_type));
}

std::string unit_text(const canopen::Unit& unit) {
  if (unit.resolution != canopen::Resolution::kNone) return fmt::format("counts, in {}", unit.name);
  if (unit.denominator == 1 && unit.numerator == 1) return std::string(unit.name);
  if (unit.denominator == 10 && unit.numerator == 1) return fmt::format("0.1 {}", unit.name);
  return fmt::format("{}/{} {}", unit.numerator, unit.denominator, unit.name);
}

}  // namespace koboshi::bus
