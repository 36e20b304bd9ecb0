#include "sim_board/description/edit/field_value.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>
#include <vector>

#include "base/text/error.h"
#include "base/text/text.h"
#include "base/text/units.h"

namespace koboshi::sim_board {
namespace {

constexpr double kRounding = 1e-9;  // of a value that is converted to a unit without a rule of its own

const UserUnit* shown_unit_of(const ModelField& field) {
  if (field.content() != XmlContent::kNumbers) return nullptr;
  const std::string unit = field.unit();
  const auto found =
      std::ranges::find_if(user_units(), [&](const UserUnit& u) { return u.is_shown && u.of_file == unit; });
  return found == user_units().end() ? nullptr : &*found;
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
  const auto number = koboshi::parse_number(stream.str());
  return number_text(number.value_or(rounded) + 0.0);  // not -0
}

class Typed {
 public:
  Typed(const XmlDocument& document, const ModelField& field, const std::string& typed)
      : document_(document), field_(field), typed_(typed), words_(words_of(typed)) {}

  std::string text() const {
    if (field_.content() == XmlContent::kInteger) return integer();
    if (field_.content() == XmlContent::kNumbers) return numbers();
    const std::vector<std::string>& choices = field_.choices();
    if (words_.empty() || (!choices.empty() && std::ranges::find(choices, typed_) == choices.end())) fail();
    return typed_;
  }

 private:
  // `question`: as of unit_question() or expected_unit(), or empty.
  [[noreturn]] void fail(const std::string& question = {}) const {
    const auto path = field_.element_path(document_);
    const XmlPart* part = path ? document_.find(*path) : nullptr;
    throw InputError(document_.source(), part != nullptr ? part->line : 0,
                     field_.path + " = " + one_line(typed_),
                     field_.expected() + (question.empty() ? "" : "; " + question));
  }

  bool is_within(double value) const { return value >= field_.range().min && value <= field_.range().max; }

  std::string integer() const {
    const auto value = parse_integer(joined(words_, 0, words_.size()));
    if (!value || !is_within(static_cast<double>(*value))) fail();
    return joined(words_, 0, words_.size());
  }

  std::string numbers() const {
    const auto typed = split_units(typed_);
    if (!typed || typed->texts.size() != field_.numbers()) fail();
    const std::string& unit = typed->unit;
    std::vector<std::string> texts = typed->texts;
    if (!unit.empty()) convert(texts, unit);
    std::vector<double> values;
    for (const std::string& text : texts) values.push_back(*koboshi::parse_number(text));
    if (!std::ranges::all_of(values, [this](double value) { return is_within(value); }))
      fail(unit.empty()
               ? unit_question(values, field_.unit(), [this](double value) { return is_within(value); })
               : std::string());
    return joined(texts, 0, texts.size());
  }

  // Numbers in the file's unit keep their digits.
  void convert(std::vector<std::string>& texts, const std::string& name) const {
    const std::string unit = field_.unit() == "1" ? std::string() : field_.unit();
    const auto factor = unit.empty() ? std::nullopt : unit_factor(name, unit);
    if (!factor) fail(expected_unit(unit));
    if (*factor == 1.0) return;
    const auto rule = std::ranges::find(user_units(), std::string_view(unit), &UserUnit::of_file);
    const double rounding = rule == user_units().end() ? kRounding : rule->rounding;
    for (std::string& text : texts) text = rounded_text(*koboshi::parse_number(text) * *factor, rounding);
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

std::string assumed_unit(const ModelField& field, const std::string& typed) {
  const std::string unit = field.unit();
  if (field.content() != XmlContent::kNumbers || unit == "1") return {};
  const auto numbers = split_units(typed);
  return numbers && numbers->unit.empty() ? unit : std::string();
}

std::string shown_text(const ModelField& field, const std::string& value) {
  const UserUnit* unit = shown_unit_of(field);
  if (unit == nullptr) return value;
  std::string text;
  for (const std::string& word : words_of(value)) {
    const auto number = koboshi::parse_number(word);
    if (!number) return value;
    constexpr double kShownStep = 1e-4;  // of the unit: finer than files written by hand
    text += (text.empty() ? "" : " ") + rounded_text(*number / unit->factor(), kShownStep);
  }
  return text;
}

std::string shown_unit(const ModelField& field) {
  if (const UserUnit* unit = shown_unit_of(field)) return std::string(unit->name);
  const std::string unit = field.unit();
  return unit == "1" ? std::string() : unit;
}

}  // namespace koboshi::sim_board
