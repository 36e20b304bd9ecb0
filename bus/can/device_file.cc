#include "bus/can/device_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <charconv>
#include <map>
#include <string_view>

#include "base/text/error.h"
#include "base/text/foreign_text.h"
#include "base/text/text.h"

namespace koboshi::bus {
namespace {

// --- The file as sections with keys

struct Value {
  std::string text;
  int line = 0;
};

struct Section {
  int line = 0;
  std::map<std::string, Value> values;  // keys in lower case

  const Value* find(const std::string& key) const {
    const auto found = values.find(key);
    return found == values.end() || found->second.text.empty() ? nullptr : &found->second;
  }
};

using Sections = std::map<std::string, Section>;  // names in lower case

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t");
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(" \t") - begin + 1);
}

std::string lower(std::string_view text) {
  std::string result(text);
  std::ranges::transform(result, result.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return result;
}

Sections read_sections(const std::filesystem::path& file) {
  const std::string text = with_line_feeds(read_text_file(file, "an EDS or DCF file"));
  Sections sections;
  Section* section = nullptr;
  int number = 0;
  for (std::size_t begin = 0; begin < text.size(); ++number) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    std::string_view line = trimmed(std::string_view(text).substr(begin, end - begin));
    begin = end + 1;
    if (line.empty() || line.front() == ';' || line.front() == '#') continue;
    if (line.front() == '[' && line.back() == ']') {
      section = &sections[lower(trimmed(line.substr(1, line.size() - 2)))];
      section->line = number + 1;
      continue;
    }
    const std::size_t equals = line.find('=');
    if (equals == std::string_view::npos || section == nullptr)
      throw InputError(file, number + 1, one_line(line),
                       section == nullptr ? "a [section] of an EDS or DCF file" : "KEY=VALUE or [SECTION]");
    section->values[lower(trimmed(line.substr(0, equals)))] = {std::string(trimmed(line.substr(equals + 1))),
                                                               number + 1};
  }
  return sections;
}

// --- Values

// Data types (CiA 301, table 44).
enum Type : std::uint32_t {
  kBoolean = 0x01,
  kReal32 = 0x08,
  kVisibleString = 0x09,
  kOctetString = 0x0A,
  kDomain = 0x0F,
  kReal64 = 0x11,
};

// The size of an integer in bytes; 0 for other types.
std::size_t integer_bytes(std::uint32_t type) {
  static const std::map<std::uint32_t, std::size_t> kSizes{
      {kBoolean, 1}, {0x02, 1}, {0x03, 2}, {0x04, 4}, {0x05, 1}, {0x06, 2}, {0x07, 4}, {0x10, 3}, {0x12, 5},
      {0x13, 6},     {0x14, 7}, {0x15, 8}, {0x16, 3}, {0x18, 5}, {0x19, 6}, {0x1A, 7}, {0x1B, 8}};
  const auto found = kSizes.find(type);
  return found == kSizes.end() ? 0 : found->second;
}

class Reader {
 public:
  Reader(const std::filesystem::path& file, std::uint8_t node_id)
      : file_(file), node_id_(node_id), sections_(read_sections(file)) {}

  DeviceFile read() {
    DeviceFile result;
    if (!sections_.contains("deviceinfo") && !sections_.contains("mandatoryobjects"))
      throw InputError(file_, 0, "no section DeviceInfo", "an EDS or DCF file");
    const Section& device = sections_["deviceinfo"];
    if (const Value* vendor = device.find("vendornumber")) result.vendor_id = number_of(*vendor, 4);
    if (const Value* product = device.find("productnumber")) result.product_code = number_of(*product, 4);
    const auto commissioning = sections_.find("devicecomissioning");  // as CiA 306 spells it
    if (commissioning != sections_.end()) {
      result.is_dcf = true;
      if (const Value* id = commissioning->second.find("nodeid"))
        result.node_id = static_cast<std::uint8_t>(number_of(*id, 1));
    }
    for (const auto& [name, section] : sections_) add_objects(name, section, result.objects);
    std::ranges::sort(result.objects, {}, &FileObject::address);
    result.is_dcf = result.is_dcf || std::ranges::any_of(result.objects, &FileObject::is_parameter);
    return result;
  }

 private:
  [[noreturn]] void fail(const Value& value, const std::string& expected) const {
    throw InputError(file_, value.line, one_line(value.text), expected);
  }

  // The number of 0x.., octal 0.., decimal and negative numbers, all with $NODEID+ before or after.
  std::uint64_t number_of(const Value& value, std::size_t bytes) const {
    std::string text;
    std::uint64_t sum = 0;
    const std::string all = lower(value.text) + '+';
    for (std::size_t begin = 0; begin < all.size();) {
      const std::size_t end = all.find('+', begin);
      const std::string_view term = trimmed(std::string_view(all).substr(begin, end - begin));
      begin = end + 1;
      const auto number =
          term == "$nodeid" ? std::optional<std::uint64_t>(node_id_) : plain_number(term, bytes);
      if (!number) fail(value, fmt::format("a number of {} bits", 8 * bytes));
      sum += *number;
    }
    const std::uint64_t mask = bytes < 8 ? (std::uint64_t{1} << 8 * bytes) - 1 : ~std::uint64_t{0};
    return sum & mask;
  }

  static std::optional<std::uint64_t> plain_number(std::string_view text, std::size_t bytes) {
    const bool negative = text.starts_with('-');
    if (negative) text.remove_prefix(1);
    const int base = text.starts_with("0x") ? 16 : text.size() > 1 && text.starts_with('0') ? 8 : 10;
    if (base == 16) text.remove_prefix(2);
    std::uint64_t number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number, base);
    const std::uint64_t most = bytes < 8 ? std::uint64_t{1} << 8 * bytes : 0;
    const bool too_large = most != 0 && (negative ? number > most / 2 : number >= most);
    if (text.empty() || error != std::errc() || end != text.data() + text.size() || too_large)
      return std::nullopt;
    return negative ? ~number + 1 : number;
  }

  static std::vector<std::uint8_t> little_endian(std::uint64_t number, std::size_t bytes) {
    std::vector<std::uint8_t> data(bytes);
    for (std::size_t i = 0; i < bytes; ++i) data[i] = static_cast<std::uint8_t>(number >> 8 * i);
    return data;
  }

  // The value on the bus; nothing for a type without a text in the file.
  std::optional<std::vector<std::uint8_t>> data_of(const Value& value, std::uint32_t type) const {
    if (const std::size_t bytes = integer_bytes(type); bytes != 0)
      return little_endian(number_of(value, bytes), bytes);
    if (type == kReal32 || type == kReal64) {
      const auto number = koboshi::parse_number(value.text);
      if (!number) fail(value, "a number");
      return type == kReal32 ? little_endian(std::bit_cast<std::uint32_t>(static_cast<float>(*number)), 4)
                             : little_endian(std::bit_cast<std::uint64_t>(*number), 8);
    }
    if (type == kVisibleString) return std::vector<std::uint8_t>(value.text.begin(), value.text.end());
    if (type == kOctetString) return octets_of(value);
    return std::nullopt;
  }

  std::vector<std::uint8_t> octets_of(const Value& value) const {
    std::string digits = value.text;
    std::erase(digits, ' ');
    std::vector<std::uint8_t> data(digits.size() / 2);
    for (std::size_t i = 0; i < data.size(); ++i) {
      const char* const begin = digits.data() + 2 * i;
      const auto [end, error] = std::from_chars(begin, begin + 2, data[i], 16);
      if (error != std::errc() || end != begin + 2) fail(value, "bytes in hexadecimal");
    }
    if (digits.size() % 2 != 0) fail(value, "bytes in hexadecimal, two digits each");
    return data;
  }

  // --- Objects

  // [1018], [1018sub1]; other sections are no objects.
  static std::optional<canopen::ObjectAddress> address_of(const std::string& name) {
    std::uint16_t index = 0;
    std::uint8_t subindex = 0;
    const char* const end = name.data() + name.size();
    const auto [after, error] = std::from_chars(name.data(), end, index, 16);
    if (error != std::errc() || after != name.data() + 4) return std::nullopt;
    if (after == end) return canopen::ObjectAddress{index, 0};
    constexpr std::string_view kSub = "sub";
    if (!std::string_view(name).substr(4).starts_with(kSub)) return std::nullopt;
    const auto [last, sub_error] = std::from_chars(after + kSub.size(), end, subindex, 16);
    if (sub_error != std::errc() || last != end) return std::nullopt;
    return canopen::ObjectAddress{index, subindex};
  }

  void add_objects(const std::string& name, const Section& section, std::vector<FileObject>& objects) const {
    const auto address = address_of(name);
    if (!address) return;
    if (const Value* compact = section.find("compactsubobj")) {
      const auto count = static_cast<std::uint8_t>(number_of(*compact, 1));
      if (count > 0) return add_compact(*address, name, section, count, objects);
    }
    // Arrays and records have their values in their sub-indices.
    if (section.find("datatype") != nullptr) objects.push_back(object_of(*address, section, nullptr));
  }

  // The elements of a long array have one section, and those with values of their own another (CiA 306-1).
  void add_compact(canopen::ObjectAddress address, const std::string& name, const Section& section,
                   std::uint8_t count, std::vector<FileObject>& objects) const {
    const auto values = sections_.find(name + "value");
    for (int subindex = 1; subindex <= count; ++subindex) {
      address.subindex = static_cast<std::uint8_t>(subindex);
      const Value* own = values == sections_.end() ? nullptr : values->second.find(std::to_string(subindex));
      objects.push_back(object_of(address, section, own));
    }
  }

  // `own`: the value of an element of a compact array.
  FileObject object_of(canopen::ObjectAddress address, const Section& section, const Value* own) const {
    FileObject object{.address = address};
    if (const Value* name = section.find("parametername")) object.name = name->text;
    const Value* const type_value = section.find("datatype");
    if (type_value == nullptr)
      throw InputError(file_, section.line, "an object without DataType", "one with a DataType");
    const auto type = static_cast<std::uint32_t>(number_of(*type_value, 2));
    object.is_domain = type == kDomain;
    object.is_text = type == kVisibleString;
    set_access(section, object);
    const Value* value = own != nullptr ? own : section.find("parametervalue");
    object.is_parameter = value != nullptr;
    if (value == nullptr) value = section.find("defaultvalue");
    if (value != nullptr && !object.is_domain) object.value = data_of(*value, type);
    return object;
  }

  void set_access(const Section& section, FileObject& object) const {
    const Value* const access = section.find("accesstype");
    const std::string name = access == nullptr ? "ro" : lower(access->text);
    constexpr std::array kNames{"ro", "wo", "rw", "rwr", "rww", "const"};
    if (std::ranges::find(kNames, name) == kNames.end()) fail(*access, "ro, wo, rw, rwr, rww or const");
    object.readable = name != "wo";
    object.writable = name != "ro" && name != "const";
    const Value* const flags = section.find("objflags");
    if (flags == nullptr) return;
    const std::uint64_t bits =
        number_of(*flags, 4);  // CiA 306-1: 1 refuse write on download, 2 refuse read on scan
    object.writable = object.writable && (bits & 1) == 0;
    object.readable = object.readable && (bits & 2) == 0;
  }

  std::filesystem::path file_;
  std::uint8_t node_id_;
  Sections sections_;
};

}  // namespace

DeviceFile read_device_file(const std::filesystem::path& file, std::uint8_t node_id) {
  return Reader(file, node_id).read();
}

}  // namespace koboshi::bus
