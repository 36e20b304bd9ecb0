#include "tools/dictionary/parameters.h"

#include <algorithm>
#include <cctype>
#include <iterator>

#include <fmt/format.h>

#include "firmware/app/controller_objects.h"
#include "sim_board/input/text.h"
#include "tools/dictionary/node_kinds.h"

namespace koboshi::tools {
namespace {

constexpr std::string_view kParametersIntroduction =
    R"(# Parameters of the controller

Every number of the controller that a scenario, a parameter file or a study may set, by the key that it has there
(`parameters` in [scenario-format.md](scenario-format.md)). The end of a key names the unit. How the robot walks is
explained in [walking.md](../design/walking.md), and getting up in [getting-up.md](../design/getting-up.md). A client on the
bus writes the same numbers in counts of the wire: [object-dictionary.md](object-dictionary.md) has the scale of each object.
Written by `koboshi dictionary write`.

| key | range | default | object | meaning |
| --- | --- | --- | --- | --- |
)";

std::string replaced(std::string text, std::string_view from, std::string_view to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
  return text;
}

// As the dictionary names it, in small letters and without blanks.
std::string parameter_name(const canopen::DescribedObject& object, std::size_t element) {
  std::string name(object.text.name);
  if (object.entry.count > 1) name.append(" ").append(object.text.elements[element]);
  for (char& c : name) {
    c = std::isalnum(static_cast<unsigned char>(c)) != 0 ? static_cast<char>(std::tolower(c)) : '_';
  }
  return name;
}

// What PDOs write, such as requests and what drives report, is no setting.
bool is_parameter(const canopen::DescribedObject& object) {
  if (object.is_heading() || object.entry.access != canopen::Access::kReadWrite) return false;
  if (object.entry.mappable != canopen::Mappable::kNo) return false;
  return object.entry.count <= 1 || !object.text.elements.empty();
}

std::vector<Parameter> make_parameters() {
  std::vector<Parameter> parameters;
  for (const canopen::DescribedObject& object : app::kControllerObjects) {
    if (!is_parameter(object)) continue;
    const std::string suffix = unit_suffix(object.text.unit.name);
    for (std::uint8_t element = 0; element < object.entry.count; ++element) {
      const std::string name = parameter_name(object, element);
      parameters.push_back({.key = suffix.empty() ? name : name + "_" + suffix,
                            .name_without_unit = name,
                            .object = &object,
                            .element = element});
    }
  }
  std::ranges::sort(parameters, {}, &Parameter::key);
  return parameters;
}

std::string in_units(const Parameter& parameter, std::int64_t raw) {
  return fmt::format("{:.6g}", static_cast<double>(raw) / parameter.raw_per_unit());
}

std::string default_of(const Parameter& parameter, const NodeKind& controller) {
  const ObjectItem* item = controller.find(parameter.address());
  const auto raw = item != nullptr ? sim::parse_integer(item->default_value) : std::nullopt;
  return raw ? in_units(parameter, *raw) : std::string();
}

}  // namespace

canopen::ObjectAddress Parameter::address() const {
  return {object->entry.index, static_cast<std::uint8_t>(object->entry.subindex + element)};
}

double Parameter::raw_per_unit() const {
  return static_cast<double>(object->text.unit.denominator) / object->text.unit.numerator;
}

std::int64_t Parameter::low() const {
  const canopen::Entry& entry = object->entry;
  const bool is_signed = canopen::is_signed(entry.type);
  if (entry.limited) return is_signed ? static_cast<std::int32_t>(entry.low) : std::int64_t{entry.low};
  return is_signed ? -(std::int64_t{1} << (8 * canopen::size_bytes(entry.type) - 1)) : 0;
}

std::int64_t Parameter::high() const {
  const canopen::Entry& entry = object->entry;
  const bool is_signed = canopen::is_signed(entry.type);
  if (entry.limited) return is_signed ? static_cast<std::int32_t>(entry.high) : std::int64_t{entry.high};
  return (std::int64_t{1} << (8 * canopen::size_bytes(entry.type) - (is_signed ? 1 : 0))) - 1;
}

std::span<const Parameter> controller_parameters() {
  static const std::vector<Parameter> kParameters = make_parameters();
  return kParameters;
}

std::string unit_suffix(std::string_view unit) {
  if (unit == "N m") return "Nm";
  return replaced(replaced(replaced(replaced(std::string(unit), "%", "percent"), "^", ""), "/", "_per_"), " ",
                  "_");
}

std::string parameters_page_text(const NodeKind& controller) {
  std::string page(kParametersIntroduction);
  for (const Parameter& parameter : controller_parameters()) {
    const canopen::ObjectAddress address = parameter.address();
    fmt::format_to(std::back_inserter(page), "| `{}` | {} to {} | {} | {:04X}:{:02X} | {} |\n", parameter.key,
                   in_units(parameter, parameter.low()), in_units(parameter, parameter.high()),
                   default_of(parameter, controller), address.index, address.subindex,
                   parameter.object->text.comment);
  }
  return page;
}

}  // namespace koboshi::tools
