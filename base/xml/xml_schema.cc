#include "base/xml/xml_schema.h"

#include <algorithm>

namespace koboshi {
namespace {

bool is_choice(const std::string& text, const std::vector<std::string>& choices) {
  return std::find(choices.begin(), choices.end(), text) != choices.end();
}

}  // namespace

std::optional<std::vector<double>> parse_numbers(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r\n";
  std::vector<double> values;
  for (auto begin = text.find_first_not_of(kBlanks); begin != std::string_view::npos;) {
    const auto end = std::min(text.find_first_of(kBlanks, begin), text.size());
    const auto value = parse_number(text.substr(begin, end - begin));
    if (!value) return std::nullopt;
    values.push_back(*value);
    begin = text.find_first_not_of(kBlanks, end);
  }
  return values;
}

bool is_valid_value(const std::string& text, XmlContent content, std::size_t numbers,
                    const NumberRange& range, const std::vector<std::string>& choices) {
  const auto within = [&](double v) { return v >= range.min && v <= range.max; };
  switch (content) {
    case XmlContent::kText:
      return choices.empty() ? name_fault(text).empty() : is_choice(text, choices);
    case XmlContent::kInteger: {
      const auto value = parse_integer(text);
      if (!value || !within(static_cast<double>(*value))) return false;
      return choices.empty() || is_choice(std::to_string(*value), choices);
    }
    case XmlContent::kNumbers: {
      const auto values = parse_numbers(text);
      return values && values->size() == numbers && std::all_of(values->begin(), values->end(), within);
    }
    case XmlContent::kChildren:
    case XmlContent::kAnything:
      break;
  }
  return true;
}

std::string describe_values(XmlContent content, std::size_t numbers, const NumberRange& range,
                            const std::vector<std::string>& choices) {
  if (!choices.empty()) return join_alternatives(choices);
  switch (content) {
    case XmlContent::kText:
      return "a text";
    case XmlContent::kNumbers:
      return numbers == 1 ? describe(range) : std::to_string(numbers) + " times " + describe(range);
    case XmlContent::kInteger:
      return "a whole number" + describe(range).substr(std::string("a number").size());
    case XmlContent::kChildren:
    case XmlContent::kAnything:
      break;
  }
  return {};
}

}  // namespace koboshi
