#include "tools/robot/edit/field_value.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <sstream>
#include <string_view>
#include <utility>
#include <vector>

#include "sim_board/input/error.h"
#include "sim_board/input/text.h"

namespace koboshi::tools {
namespace {

struct Unit {
  std::string_view name;
  std::string_view of_file;
  double factor;    // from this unit to that of the file
  double rounding;  // of the file's value, as in files written by hand
  bool is_shown;    // the one in which people read the quantity
};
constexpr double kRadPerDegree = std::numbers::pi / 180.0;
constexpr std::array kUnits = {
    Unit{"mm", "m", 1e-3, 1e-9, true},
    Unit{"cm", "m", 1e-2, 1e-9, false},
    Unit{"deg", "rad", kRadPerDegree, 1e-6, true},
    Unit{"g", "kg", 1e-3, 1e-9, true},
    Unit{"deg/s", "rad/s", kRadPerDegree, 1e-6, true},
    Unit{"g cm^2", "kg m^2", 1e-7, 1e-13, true},
    Unit{"ms", "s", 1e-3, 1e-9, true},
};

const Unit* shown_unit_of(const ModelField& field) {
  if (field.content() != sim::XmlContent::kNumbers) return nullptr;
  const std::string unit = field.unit();
  const auto found =
      std::ranges::find_if(kUnits, [&](const Unit& u) { return u.is_shown && u.of_file == unit; });
  return found == kUnits.end() ? nullptr : &*found;
}

std::vector<std::string> words_of(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

std::string joined(const std::vector<std::string>& words, std::size_t begin, std::size_t end) {
  std::string text;
  for (std::size_t i = begin; i < end; ++i) text += (i > begin ? " " : "") + words[i];
  return text;
}

std::string rounded_text(double value, double unit) {
  const double rounded = std::round(value / unit) * unit;
  // Through a short decimal: multiples of a power of ten are not exact.
  std::ostringstream stream;
  stream.imbue(std::locale::classic());
  stream.precision(13);
  stream << rounded;
  const auto number = sim::parse_number(stream.str());
  return sim::number_text(number.value_or(rounded) + 0.0);  // not -0
}

class Typed {
 public:
  Typed(const XmlDocument& document, const ModelField& field, const std::string& typed)
      : document_(document), field_(field), typed_(typed), words_(words_of(typed)) {}

  std::string text() const {
    if (field_.content() == sim::XmlContent::kInteger) return integer();
    if (field_.content() == sim::XmlContent::kNumbers) return numbers();
    const std::vector<std::string>& choices = field_.choices();
    if (words_.empty() || (!choices.empty() && std::ranges::find(choices, typed_) == choices.end())) fail();
    return typed_;
  }

 private:
  [[noreturn]] void fail() const {
    const auto path = field_.element_path(document_);
    const XmlPart* part = path ? document_.find(*path) : nullptr;
    throw sim::InputError(document_.source(), part != nullptr ? part->line : 0,
                          field_.path + " = " + sim::one_line(typed_), field_.expected());
  }

  bool is_within(double value) const { return value >= field_.range().min && value <= field_.range().max; }

  std::string integer() const {
    const auto value = sim::parse_integer(joined(words_, 0, words_.size()));
    if (!value || !is_within(static_cast<double>(*value))) fail();
    return joined(words_, 0, words_.size());
  }

  std::string numbers() const {
    std::size_t count = 0;
    while (count < words_.size() && sim::parse_number(words_[count])) ++count;
    if (count != field_.numbers()) fail();
    const std::string unit = joined(words_, count, words_.size());
    std::vector<std::string> texts(words_.begin(), words_.begin() + static_cast<std::ptrdiff_t>(count));
    if (!unit.empty() && unit != field_.unit()) convert(texts, unit);
    for (const std::string& text : texts)
      if (!is_within(*sim::parse_number(text))) fail();
    return joined(texts, 0, texts.size());
  }

  void convert(std::vector<std::string>& texts, const std::string& name) const {
    const auto unit = std::ranges::find_if(
        kUnits, [&](const Unit& u) { return u.name == name && u.of_file == field_.unit(); });
    if (unit == kUnits.end()) fail();
    for (std::string& text : texts)
      text = rounded_text(*sim::parse_number(text) * unit->factor, unit->rounding);
  }

  const XmlDocument& document_;
  const ModelField& field_;
  const std::string& typed_;
  const std::vector<std::string> words_;
};

}  // namespace

std::string file_text(const XmlDocument& document, const ModelField& field, const std::string& typed) {
  return Typed(document, field, typed).text();
}

std::string shown_text(const ModelField& field, const std::string& value) {
  const Unit* unit = shown_unit_of(field);
  if (unit == nullptr) return value;
  std::string text;
  for (const std::string& word : words_of(value)) {
    const auto number = sim::parse_number(word);
    if (!number) return value;
    constexpr double kShownStep = 1e-4;  // of the unit: finer than files written by hand
    text += (text.empty() ? "" : " ") + rounded_text(*number / unit->factor, kShownStep);
  }
  return text;
}

std::string shown_unit(const ModelField& field) {
  if (const Unit* unit = shown_unit_of(field)) return std::string(unit->name);
  const std::string unit = field.unit();
  return unit == "1" ? std::string() : unit;
}

}  // namespace koboshi::tools
