#include "simulation/assembly/controller_parameters.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <stdexcept>
#include <utility>

#include "firmware/app/controller_objects.h"
#include "firmware/canopen/dictionary.h"
#include "simulation/assembly/parameter_keys.h"

namespace koboshi::simulation {
namespace {

std::string replaced(std::string text, std::string_view from, std::string_view to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
  return text;
}

std::string key_of(const canopen::ObjectAddress& address) {
  const auto found = std::ranges::find(kParameterKeys, address, &ParameterKey::address);
  if (found == std::end(kParameterKeys))
    throw std::logic_error(
        fmt::format("object {:04X}:{:02X} has no key in parameter_keys.h", address.index, address.subindex));
  return std::string(found->key);
}

// Objects that PDOs write, such as requests and feedback from drives, are not parameters, and neither are the
// images of motions and policies.
bool is_parameter(const canopen::DescribedObject& object) {
  if (object.entry.index >= app::kMotionObject) return false;
  if (object.is_heading() || object.entry.access != canopen::Access::kReadWrite) return false;
  if (object.entry.mappable != canopen::Mappable::kNo) return false;
  return object.entry.count <= 1 || !object.text.elements.empty();
}

std::vector<Parameter> make_parameters() {
  std::vector<Parameter> parameters;
  const canopen::DescribedObject* heading = nullptr;
  for (const canopen::DescribedObject& object : app::kControllerObjects) {
    if (object.is_heading()) heading = &object;
    if (!is_parameter(object)) continue;
    const bool is_headed = heading != nullptr && heading->entry.index == object.entry.index;
    const std::string suffix = unit_suffix(object.text.unit.name);
    for (std::uint8_t element = 0; element < object.entry.count; ++element) {
      Parameter parameter{.object = &object, .heading = is_headed ? heading : nullptr, .element = element};
      parameter.key = key_of(parameter.address());
      const std::size_t unit_size = suffix.empty() ? 0 : 1 + suffix.size();
      parameter.name_without_unit = parameter.key.substr(0, parameter.key.size() - unit_size);
      parameters.push_back(std::move(parameter));
    }
  }
  std::ranges::sort(parameters, {}, &Parameter::key);
  return parameters;
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

std::string_view Parameter::effect() const {
  if (!object->text.effect.empty()) return object->text.effect;
  if (heading != nullptr && !heading->text.effect.empty()) return heading->text.effect;
  return "at once";
}

std::int64_t Parameter::raw(double value) const { return std::llround(value * raw_per_unit()); }

double Parameter::value(std::int64_t raw) const { return static_cast<double>(raw) / raw_per_unit(); }

std::optional<double> value_in(const app::ControllerValues& values, const Parameter& parameter) {
  app::ControllerValues copy = values;
  const canopen::Dictionary dictionary(app::kControllerNode.rows,
                                       std::as_writable_bytes(std::span(&copy, 1)));
  canopen::ObjectValue value;
  if (dictionary.read(parameter.address(), value) != canopen::AbortCode::kNone) return std::nullopt;
  const std::int64_t raw = canopen::integer_of(value.number(), parameter.object->entry.type);
  if (raw < parameter.low() || raw > parameter.high()) return std::nullopt;
  return parameter.value(raw);
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

}  // namespace koboshi::simulation
