#include "base/text/units.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <utility>

#include "base/text/text.h"
#include "base/text/user_units.h"

namespace koboshi {
namespace {

// Units of each quantity and their factors to its first one.
struct Unit {
  std::string_view quantity;
  std::string_view name;  // as canonical() spells it
  double factor;
};
constexpr std::array kConvertible = {
    Unit{"length", "m", 1.0},
    Unit{"length", "cm", 1e-2},
    Unit{"length", "mm", 1e-3},
    Unit{"length", "um", 1e-6},
    Unit{"time", "s", 1.0},
    Unit{"time", "ms", 1e-3},
    Unit{"time", "us", 1e-6},
    Unit{"time", "min", 60.0},
    Unit{"time", "h", 3600.0},
    Unit{"angle", "rad", 1.0},
    Unit{"angle", "deg", kRadPerDegree},
    Unit{"mass", "kg", 1.0},
    Unit{"mass", "g", 1e-3},
    Unit{"force", "N", 1.0},
    Unit{"force", "mN", 1e-3},
    Unit{"force", "kN", 1e3},
    Unit{"torque", "Nm", 1.0},
    Unit{"torque", "mNm", 1e-3},
    Unit{"speed", "m/s", 1.0},
    Unit{"speed", "cm/s", 1e-2},
    Unit{"speed", "mm/s", 1e-3},
    Unit{"angular speed", "rad/s", 1.0},
    Unit{"angular speed", "deg/s", kRadPerDegree},
    Unit{"inertia", "kgm^2", 1.0},
    Unit{"inertia", "gcm^2", 1e-7},
    Unit{"inertia", "gmm^2", 1e-9},
    Unit{"frequency", "Hz", 1.0},
    Unit{"frequency", "kHz", 1e3},
};

using Spelling = std::pair<std::string_view, std::string_view>;
constexpr std::array kSpellings = {
    Spelling{"\u00B0", "deg"}, Spelling{"\u00B2", "^2"}, Spelling{"\u00B5", "u"}, Spelling{"\u03BC", "u"},
    Spelling{"\u00B7", ""},    Spelling{"\u22C5", ""},   Spelling{"*", ""},       Spelling{" ", ""}};

void replace_all(std::string& text, std::string_view from, std::string_view to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
}

std::string canonical(std::string_view unit) {
  std::string text(unit);
  for (const auto& [from, to] : kSpellings) replace_all(text, from, to);
  return text;
}

const Unit* find_unit(const std::string& name) {
  const auto found = std::ranges::find(kConvertible, std::string_view(name), &Unit::name);
  return found == kConvertible.end() ? nullptr : &*found;
}

// Length of the number that begins a text, if it is followed by a blank, the end or a unit; else 0.
std::size_t number_length(std::string_view text) {
  const std::size_t sign = !text.empty() && (text[0] == '+' || text[0] == '-') ? 1 : 0;
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  if (text.size() <= sign || (!is_digit(text[sign]) && text[sign] != '.')) return 0;
  double value = 0.0;
  const char* const begin = text.data() + sign;
  const auto [end, error] = std::from_chars(begin, text.data() + text.size(), value);
  if (error != std::errc()) return 0;
  const auto length = static_cast<std::size_t>(end - text.data());
  if (length == text.size()) return length;
  const char next = text[length];
  const bool is_letter = (next >= 'a' && next <= 'z') || (next >= 'A' && next <= 'Z');
  return is_letter || next == ' ' || next == '\t' || next == '%' || static_cast<unsigned char>(next) >= 0x80
             ? length
             : 0;
}

std::string_view without_blanks(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r\n";
  const std::size_t begin = std::min(text.find_first_not_of(kBlanks), text.size());
  text.remove_prefix(begin);
  return text.substr(0, text.find_last_not_of(kBlanks) + 1);
}

// Removes the unit that begins a text, up to the next number, and returns it.
std::string take_unit(std::string_view& text) {
  std::size_t end = 0;
  while (end < text.size() && (end == 0 || text[end - 1] != ' ' || number_length(text.substr(end)) == 0))
    ++end;
  const std::string unit(without_blanks(text.substr(0, end)));
  text.remove_prefix(end);
  return unit;
}

// The unit of WORD_UNIT or WORD_UNIT_per_UNIT.
std::string unit_of_word(std::string_view word) {
  constexpr std::string_view kPer = "_per_";
  std::string denominator;
  if (const std::size_t per = word.rfind(kPer); per != std::string_view::npos) {
    denominator = "/" + std::string(word.substr(per + kPer.size()));
    word = word.substr(0, per);
  }
  const std::size_t begin = word.rfind('_');
  if (begin == std::string_view::npos) return {};
  const std::string unit = std::string(word.substr(begin + 1)) + denominator;
  return find_unit(unit) != nullptr ? unit : std::string();
}

}  // namespace

std::optional<TypedNumbers> split_units(std::string_view text) {
  TypedNumbers typed;
  std::size_t with_unit = 0;
  for (text = without_blanks(text); !text.empty(); text = without_blanks(text)) {
    const std::size_t length = number_length(text);
    if (length == 0) return std::nullopt;
    typed.texts.emplace_back(text.substr(0, length));
    text = without_blanks(text.substr(length));
    if (text.empty() || number_length(text) != 0) {
      if (with_unit > 0) return std::nullopt;
      continue;
    }
    const std::string unit = take_unit(text);
    if (with_unit++ > 0 && canonical(unit) != canonical(typed.unit)) return std::nullopt;
    typed.unit = unit;
  }
  const bool fits = with_unit <= 1 || with_unit == typed.texts.size();
  return fits && !typed.texts.empty() ? std::optional(typed) : std::nullopt;
}

std::optional<double> unit_factor(std::string_view from, std::string_view to) {
  const std::string source = canonical(from);
  const std::string target = canonical(to);
  if (source == target) return 1.0;
  const Unit* const a = find_unit(source);
  const Unit* const b = find_unit(target);
  if (a == nullptr || b == nullptr || a->quantity != b->quantity) return std::nullopt;
  return a->factor / b->factor;
}

std::vector<std::string> units_for(std::string_view unit) {
  std::vector<std::string> names{std::string(unit)};
  const std::string own = canonical(unit);
  const Unit* const known = find_unit(own);
  if (known == nullptr) return names;
  for (const Unit& other : kConvertible)
    if (other.quantity == known->quantity && other.name != own) names.emplace_back(other.name);
  return names;
}

std::string expected_unit(std::string_view unit) {
  return unit.empty() ? "no unit" : "the unit " + join_alternatives(units_for(unit));
}

std::optional<double> parse_quantity(std::string_view text, std::string_view unit) {
  const auto typed = split_units(text);
  if (!typed || typed->texts.size() != 1) return std::nullopt;
  const auto number = parse_number(typed->texts.front());
  if (!number || typed->unit.empty()) return number;
  const auto factor = unit.empty() ? std::nullopt : unit_factor(typed->unit, unit);
  return factor ? std::optional(*number * *factor) : std::nullopt;
}

std::string unit_of_key(std::string_view path) {
  while (path.ends_with(']')) path = path.substr(0, path.rfind('['));
  const std::size_t dot = path.rfind('.');
  const std::string own = unit_of_word(dot == std::string_view::npos ? path : path.substr(dot + 1));
  if (!own.empty() || dot == std::string_view::npos) return own;
  path = path.substr(0, dot);
  const std::size_t begin = path.rfind('.');
  return unit_of_word(begin == std::string_view::npos ? path : path.substr(begin + 1));
}

double UserUnit::factor() const { return unit_factor(name, of_file).value(); }

std::span<const UserUnit> user_units() {
  static constexpr std::array kUnits = {
      UserUnit{"mm", "m", 1e-9, true},        UserUnit{"cm", "m", 1e-9, false},
      UserUnit{"deg", "rad", 1e-6, true},     UserUnit{"g", "kg", 1e-9, true},
      UserUnit{"deg/s", "rad/s", 1e-6, true}, UserUnit{"g cm^2", "kg m^2", 1e-13, true},
      UserUnit{"ms", "s", 1e-9, true},
  };
  return kUnits;
}

std::string unit_question(std::span<const double> values, std::string_view unit_of_file,
                          const std::function<bool(double)>& is_plausible) {
  for (const UserUnit& unit : user_units()) {
    if (unit.of_file != unit_of_file) continue;
    const double factor = unit.factor();
    if (!std::ranges::all_of(values, [&](double value) { return is_plausible(value * factor); })) continue;
    std::string text = "did you mean ";
    for (const double value : values) text += number_text(value) + " ";
    return text + std::string(unit.name) + "?";
  }
  return {};
}

}  // namespace koboshi
