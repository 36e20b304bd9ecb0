#include "studio/plant/plant_quantity.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <sstream>
#include <string_view>

#include "base/text/error.h"
#include "base/text/text.h"
#include "base/text/units.h"
#include "base/text/user_units.h"
#include "sim_board/description/edit/field_value.h"
#include "studio/model/field_labels.h"

namespace koboshi::studio {
namespace {

using sim_board::ModelField;

constexpr int kMaxDecimals = 9;
// Ranges of sliders, set by hand (2026-11-28) so that a slider covers what a robot can have: a third of its
// length is the model's value; positions move by a few centimetres, angles by some degrees.
constexpr double kTimesOfModel = 3.0;
constexpr double kShareOfModel = 0.1;
constexpr double kReachOfPosition_m = 0.02;
constexpr double kReachOfAngle_rad = 20.0 * kRadPerDegree;
constexpr double kReachOfInertia_kg_m2 = 1e-5;
constexpr double kSliderSteps = 1000.0;

std::vector<double> numbers_of(const std::string& text) {
  std::istringstream stream(text);
  std::vector<double> numbers;
  for (std::string word; stream >> word;)
    if (const auto number = parse_number(word)) numbers.push_back(*number);
  return numbers;
}

std::string text_in_file(const ModelField& field) { return field.value.value_or(field.fallback()); }

double from_file(const ModelField& field, double value) {
  const auto factor = unit_factor(field.unit(), sim_board::shown_unit(field));
  if (!factor || *factor == 1.0) return value;
  return parse_number(sim_board::shown_text(field, number_text(value))).value_or(value * *factor);
}

// An end of the range that the reader permits.
double end_of(const ModelField& field, double end) {
  constexpr double kUnlimited = 1e9;
  return std::abs(end) >= NumberRange().max ? std::copysign(kUnlimited, end) : from_file(field, end);
}

double rounded(double value, int decimals) {
  const double step = std::pow(10.0, decimals);
  return std::round(value * step) / step;
}

bool has_tag(const ModelField& field, std::string_view tag) {
  return std::ranges::any_of(field.steps, [&](const auto& step) { return step.rule->name == tag; });
}

bool is_plant_field(const ModelField& field) {
  const bool is_number = field.content() == XmlContent::kNumbers || field.content() == XmlContent::kInteger;
  const bool is_identity = has_tag(field, "koboshi:drive") && field.content() == XmlContent::kInteger;
  return is_number && is_shown(field) && !is_identity && !has_tag(field, "visual") &&
         !has_tag(field, "koboshi:maker");
}

// The least difference that a slider covers to both sides of a value that may be zero.
double reach_of(const std::string& unit) {
  if (unit == "m") return kReachOfPosition_m;
  if (unit == "rad") return kReachOfAngle_rad;
  if (unit == "kg m^2") return kReachOfInertia_kg_m2;
  return 1.0;
}

// In the file's unit. `size`: magnitude of the model's value, for a vector of the whole.
NumberRange slider_range(const ModelField& field, double model, double size) {
  const NumberRange& range = field.range();
  NumberRange slider{.min = model - std::max(size / 2.0, reach_of(field.unit())),
                     .max = model + std::max(size / 2.0, reach_of(field.unit()))};
  if (range.min >= 0.0) {
    slider.min = range.min > 0.0 ? kShareOfModel * model : 0.0;
    const double without_model = range.max < NumberRange().max ? range.max : reach_of(field.unit());
    slider.max = model > 0.0 ? kTimesOfModel * model : without_model;
  }
  return {.min = std::clamp(slider.min, range.min, range.max),
          .max = std::clamp(slider.max, range.min, range.max)};
}

// Digits behind the point of a number in its shortest decimal notation.
int decimals_of(double value) {
  double scaled = std::abs(value);
  for (int decimals = 0; decimals < kMaxDecimals; ++decimals, scaled *= 10.0)
    if (std::abs(scaled - std::round(scaled)) < 1e-6 * std::max(scaled, 1e-3)) return decimals;
  return kMaxDecimals;
}

void set_ranges(PlantQuantity& quantity, double model, double size) {
  const ModelField& field = quantity.field;
  const NumberRange slider = slider_range(field, model, size);
  quantity.low = end_of(field, field.range().min);
  quantity.high = end_of(field, field.range().max);
  quantity.slider_low = std::min({from_file(field, slider.min), quantity.model, quantity.plant});
  quantity.slider_high = std::max({from_file(field, slider.max), quantity.model, quantity.plant});
  if (field.content() == XmlContent::kInteger) return;
  const double step = (quantity.slider_high - quantity.slider_low) / kSliderSteps;
  const int decimals = step > 0.0 ? static_cast<int>(std::ceil(-std::log10(step) - 1e-9)) : 0;
  quantity.decimals = std::max(
      {std::clamp(decimals, 0, kMaxDecimals), decimals_of(quantity.model), decimals_of(quantity.plant)});
  // Rounded to the inside of what the reader permits.
  const double scale = std::pow(10.0, quantity.decimals);
  quantity.low = std::ceil(quantity.low * scale - 1e-6) / scale;
  quantity.high = std::floor(quantity.high * scale + 1e-6) / scale;
  quantity.slider_low = std::max(quantity.slider_low, quantity.low);
  quantity.slider_high = std::min(quantity.slider_high, quantity.high);
}

std::string component_name(std::size_t component, std::size_t components) {
  constexpr std::array kAxes = {"x", "y", "z"};
  constexpr std::array kTurns = {"x", "y", "z", "roll", "pitch", "yaw"};
  if (components == 1) return {};
  if (components == kAxes.size()) return std::string(" ") + kAxes.at(component);
  return components == kTurns.size() ? std::string(" ") + kTurns.at(component)
                                     : " " + std::to_string(component + 1);
}

// "torque constant" for torque_constant_Nm_per_A: the unit is beside the number.
std::string label_without_unit(std::string label) {
  constexpr std::array<std::string_view, 13> kUnits{"Nm", "per", "A",   "ohm", "V", "kg", "m2",
                                                    "s",  "ms",  "rad", "C",   "K", "W"};
  for (std::size_t at = label.rfind('_'); at != std::string::npos && at > 0; at = label.rfind('_')) {
    if (std::ranges::find(kUnits, std::string_view(label).substr(at + 1)) == kUnits.end()) break;
    label.resize(at);
  }
  std::ranges::replace(label, '_', ' ');
  return label;
}

// The usual name of a value, if it is the reader's name of this field; else the field's path.
std::string usual_path(const std::vector<ModelField>& fields, const ModelField& field,
                       const std::string& element) {
  for (const std::string& word : {std::string("com"), sim_board::field_label(field)})
    if (sim_board::match_field(fields, {element, word}) == &field) return element + "." + word;
  return field.path;
}

std::vector<PlantQuantity> quantities_of(const ModelField& model, const ModelField& plant,
                                         const std::string& path) {
  const std::vector<double> before = numbers_of(text_in_file(model));
  const std::vector<double> now = numbers_of(text_in_file(plant));
  double size = 0.0;
  for (const double number : before) size = std::hypot(size, number);
  std::vector<PlantQuantity> quantities;
  const std::size_t components = model.content() == XmlContent::kInteger ? 1 : model.numbers();
  // A value that both lack has no number to begin with.
  if (before.size() != components || now.size() != components) return quantities;
  for (std::size_t i = 0; i < components; ++i) {
    PlantQuantity& quantity = quantities.emplace_back();
    quantity.field = model;
    quantity.component = i;
    quantity.path = path;
    quantity.plant_text = text_in_file(plant);
    quantity.group = group_of(model);
    quantity.label = label_without_unit(label_of(model)) + component_name(i, components);
    quantity.unit = sim_board::shown_unit(model);
    quantity.model = from_file(model, before[i]);
    quantity.plant = from_file(model, now[i]);
    set_ranges(quantity, before[i], size);
  }
  return quantities;
}

std::vector<ModelField> fields_of(const XmlDocument& document, const std::string& element) {
  for (const sim_board::ModelElement& one : plant_elements(document))
    if (one.name == element) return sim_board::model_fields(document, one);
  return {};
}

std::string joined_numbers(const std::vector<double>& numbers, const std::string& unit) {
  std::string text;
  for (const double number : numbers) text += (text.empty() ? "" : " ") + number_text(number);
  return unit.empty() ? text : text + " " + unit;
}

}  // namespace

std::string PlantQuantity::name() const {
  return path + component_name(component, std::max<std::size_t>(field.numbers(), 1));
}

std::vector<sim_board::ModelElement> plant_elements(const XmlDocument& model) {
  std::vector<sim_board::ModelElement> elements = sim_board::model_elements(model);
  std::erase_if(elements, [](const sim_board::ModelElement& element) {
    return !element.is("link") && !element.is("joint") && !element.is("koboshi:servo_type") &&
           !element.is("koboshi:battery");
  });
  return elements;
}

std::vector<PlantQuantity> plant_quantities(const XmlDocument& model, const XmlDocument& plant,
                                            const std::string& element) {
  const std::vector<ModelField> changed = fields_of(plant, element);
  std::vector<PlantQuantity> all;
  const std::vector<ModelField> fields = fields_of(model, element);
  for (const ModelField& field : fields) {
    if (!is_plant_field(field)) continue;
    const auto other = std::ranges::find(changed, field.key(), &ModelField::key);
    if (other == changed.end()) continue;
    const std::vector<PlantQuantity> quantities =
        quantities_of(field, *other, usual_path(fields, field, element));
    all.insert(all.end(), quantities.begin(), quantities.end());
  }
  const auto rank = [](const PlantQuantity& quantity) {
    if (quantity.field.last_word() == "mass") return 0;
    return quantity.group == "inertial" ? 1 : 2;
  };
  std::ranges::stable_sort(all, {}, rank);
  return all;
}

// The other components, and the model's value, keep their digits: where the unit of people would round them,
// the text is in the file's.
std::string typed_value(const PlantQuantity& quantity, const XmlDocument& model, double value) {
  const ModelField& field = quantity.field;
  if (field.content() == XmlContent::kInteger) return number_text(std::round(value));
  const std::vector<double> in_file = numbers_of(quantity.plant_text);
  std::vector<double> shown;
  for (const double number : in_file) shown.push_back(from_file(field, number));
  const bool is_of_model = value == quantity.model;
  shown.at(quantity.component) = is_of_model ? value : rounded(value, quantity.decimals);
  std::string typed = joined_numbers(shown, quantity.unit);
  std::vector<double> read;
  try {
    read = numbers_of(sim_board::file_text(model, field, typed));
  } catch (const InputError&) {
    return typed;  // the reader says why
  }
  std::vector<double> wanted = in_file;
  wanted.at(quantity.component) =
      is_of_model ? numbers_of(text_in_file(field)).at(quantity.component) : read.at(quantity.component);
  return read == wanted ? typed : joined_numbers(wanted, {});
}

bool same_value(const std::string& one, const std::string& other) {
  const std::vector<double> numbers = numbers_of(one);
  return one == other || (!numbers.empty() && numbers == numbers_of(other));
}

std::string shown_value(const ModelField& field) {
  const std::string value = text_in_file(field);
  const std::string unit = sim_board::shown_unit(field);
  if (value.empty()) return {};
  return sim_board::shown_text(field, value) + (unit.empty() ? "" : " " + unit);
}

std::string shown_typed(const XmlDocument& model, const ModelField& field, const std::string& typed) {
  try {
    ModelField changed = field;
    changed.value = sim_board::file_text(model, field, typed);
    return shown_value(changed);
  } catch (const InputError&) {
    return typed;
  }
}

}  // namespace koboshi::studio
