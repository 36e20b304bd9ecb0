#include "bus/dictionary/formats.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <string_view>
#include <vector>

#include <fmt/core.h>

namespace koboshi::bus {
namespace {

using Text = std::back_insert_iterator<std::string>;

// CiA 306-1 requires a date; a fixed one keeps the bytes the same.
constexpr std::string_view kDate = "01-01-2026";
constexpr std::string_view kTime = "12:00AM";

void add_file_info(std::string& eds, const NodeKind& kind) {
  fmt::format_to(Text(eds), "[FileInfo]\nFileName={}.eds\nFileVersion=1\nFileRevision=0\nEDSVersion=4.0\n",
                 kind.name);
  fmt::format_to(Text(eds), "Description={}\n", kind.description.device_name);
  for (const std::string_view verb : {"Creation", "Modification"}) {
    fmt::format_to(Text(eds), "{0}Time={1}\n{0}Date={2}\n", verb, kTime, kDate);
  }
  eds += "CreatedBy=koboshi dictionary\nModifiedBy=koboshi dictionary\n";
}

void add_device_info(std::string& eds, const NodeKind& kind) {
  const canopen::NodeDescription& node = kind.description;
  fmt::format_to(Text(eds), "\n[DeviceInfo]\nVendorName=Koboshi\nVendorNumber=0x{:08X}\nProductName={}\n",
                 node.vendor_id, node.device_name);
  fmt::format_to(Text(eds), "ProductNumber=0x{:08X}\nRevisionNumber=0x{:08X}\nOrderCode={}\n",
                 node.product_code, node.revision_number, kind.name);
  for (const int kilobaud : {10, 20, 50, 125, 250, 500, 800, 1000}) {
    fmt::format_to(Text(eds), "BaudRate_{}={}\n", kilobaud, kilobaud == 1000 ? 1 : 0);
  }
  fmt::format_to(Text(eds), "SimpleBootUpMaster={}\nSimpleBootUpSlave={}\nGranularity=8\n",
                 node.sync_producer ? 1 : 0, node.sync_producer ? 0 : 1);
  eds += "DynamicChannelsSupported=0\nCompactPDO=0\nGroupMessaging=0\n";
  fmt::format_to(Text(eds), "NrOfRXPDO={}\nNrOfTXPDO={}\nLSS_Supported={}\n", kind.capacity.rpdos,
                 kind.capacity.tpdos, node.field_device ? 1 : 0);
}

// An RPDO may hold gaps of all integers (CiA 301, 7.4.7.2).
void add_dummy_usage(std::string& eds) {
  eds += "\n[DummyUsage]\n";
  for (int type = 1; type <= 7; ++type) fmt::format_to(Text(eds), "Dummy{:04}=1\n", type);
}

void add_comments(std::string& eds, const NodeKind& kind) {
  std::vector<std::string> lines{
      "Written by `koboshi dictionary write` from the table that the node itself is made of.",
      "What the values mean: docs/reference/object-dictionary.md"};
  if (kind.name == "controller") {
    lines.emplace_back("Defaults are those of one robot: PDOs and heartbeats of its drives, and its factory");
    lines.emplace_back("parameters. Another robot: koboshi dictionary --robot FILE eds controller");
  }
  fmt::format_to(Text(eds), "\n[Comments]\nLines={}\n", lines.size());
  for (std::size_t i = 0; i < lines.size(); ++i) {
    fmt::format_to(Text(eds), "Line{}={}\n", i + 1, lines[i]);
  }
}

// The section of an object (CiA 306-1, 7.1.3).
enum class Section { kMandatory, kOptional, kManufacturer };

Section section_of(std::uint16_t index) {
  if (index == 0x1000 || index == 0x1001 || index == 0x1018) return Section::kMandatory;
  return index >= 0x2000 && index <= 0x5FFF ? Section::kManufacturer : Section::kOptional;
}

void add_type_and_value(std::string& eds, const ObjectItem& item) {
  fmt::format_to(Text(eds), "DataType=0x{:04X}\nAccessType={}\n", item.data_type, item.access);
  if (item.limits) {
    fmt::format_to(Text(eds), "LowLimit={}\nHighLimit={}\n", item.limits->low, item.limits->high);
  }
  // The entry is optional in CiA 306-1; readers refuse an empty one.
  if (!item.default_value.empty()) fmt::format_to(Text(eds), "DefaultValue={}\n", item.default_value);
  fmt::format_to(Text(eds), "PDOMapping={}\n", item.mappable == canopen::Mappable::kNo ? 0 : 1);
}

void add_value(std::string& eds, const ObjectItem& item) {
  const bool domain = item.data_type == static_cast<std::uint8_t>(canopen::DataType::kDomain);
  fmt::format_to(Text(eds), "ObjectType=0x{}\n", domain ? 2 : 7);
  add_type_and_value(eds, item);
}

// A long array of equal elements has one section (CiA 306-1, 7.1.4.2): their names are its name and a number.
bool is_compact(const Object& object) {
  constexpr std::size_t kMaxSections = 64;
  if (object.type != ObjectType::kArray || object.items.size() <= kMaxSections) return false;
  const std::string& family = object.items.back().family;
  return !family.empty() && std::all_of(object.items.begin() + 1, object.items.end(),
                                        [&](const ObjectItem& item) { return item.family == family; });
}

void add_object_section(std::string& eds, const Object& object) {
  if (is_compact(object)) {
    const ObjectItem& element = object.items.back();
    fmt::format_to(Text(eds), "\n[{:04X}]\nParameterName={}\nObjectType=0x{:X}\nCompactSubObj={}\n",
                   object.index, element.family, static_cast<int>(object.type), object.items.size() - 1);
    return add_type_and_value(eds, element);
  }
  fmt::format_to(Text(eds), "\n[{:04X}]\nParameterName={}\n", object.index, object.name);
  if (object.type == ObjectType::kVariable) return add_value(eds, object.items.front());
  fmt::format_to(Text(eds), "ObjectType=0x{:X}\nSubNumber={}\n", static_cast<int>(object.type),
                 object.items.size());
  for (const ObjectItem& item : object.items) {
    fmt::format_to(Text(eds), "\n[{:04X}sub{:X}]\nParameterName={}\n", object.index, item.address.subindex,
                   item.name);
    add_value(eds, item);
  }
}

void add_section(std::string& eds, const NodeKind& kind, Section section, std::string_view title) {
  std::vector<const Object*> objects;
  for (const Object& object : kind.objects) {
    if (section_of(object.index) == section) objects.push_back(&object);
  }
  fmt::format_to(Text(eds), "\n[{}]\nSupportedObjects={}\n", title, objects.size());
  for (std::size_t i = 0; i < objects.size(); ++i) {
    fmt::format_to(Text(eds), "{}=0x{:04X}\n", i + 1, objects[i]->index);
  }
  for (const Object* object : objects) add_object_section(eds, *object);
}

}  // namespace

std::string eds_text(const NodeKind& kind) {
  std::string eds;
  add_file_info(eds, kind);
  add_device_info(eds, kind);
  add_dummy_usage(eds);
  add_comments(eds, kind);
  add_section(eds, kind, Section::kMandatory, "MandatoryObjects");
  add_section(eds, kind, Section::kOptional, "OptionalObjects");
  add_section(eds, kind, Section::kManufacturer, "ManufacturerObjects");
  return eds;
}

}  // namespace koboshi::bus
