#include "base/text/text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <system_error>
#include <vector>

#include "base/text/error.h"
#include "base/text/user_units.h"

namespace koboshi {
namespace {

// Far above the size of any hand-written file. It also terminates the reading of /dev/zero.
constexpr std::size_t kMaxFileSize = 16u << 20;
constexpr std::size_t kMaxQuoteLength = 80;

std::string_view trim(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r\n";
  const auto first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

bool is_continuation(char c) { return (static_cast<unsigned char>(c) & 0xC0U) == 0x80; }

// Bytes of the character that begins at `at`, in valid UTF-8.
std::size_t character_length(std::string_view text, std::size_t at) {
  std::size_t length = 1;
  while (at + length < text.size() && is_continuation(text[at + length])) ++length;
  return length;
}

// Unicode's property White_Space, and the marks without width that no one can see either.
bool is_blank(std::string_view character) {
  static constexpr std::array<std::string_view, 27> kBlanks{
      " ",      "\t",     "\n",     "\r",     "\v",     "\f",     "\u00A0", "\u1680", "\u2000",
      "\u2001", "\u2002", "\u2003", "\u2004", "\u2005", "\u2006", "\u2007", "\u2008", "\u2009",
      "\u200A", "\u200B", "\u2028", "\u2029", "\u202F", "\u205F", "\u2060", "\u3000", "\uFEFF"};
  return std::find(kBlanks.begin(), kBlanks.end(), character) != kBlanks.end();
}

// C0, DEL, C1 (U+0080 to U+009F), and the two line separators of Unicode.
bool is_control(std::string_view character) {
  const auto first = static_cast<unsigned char>(character.front());
  if (character.size() == 1) return first < 0x20 || first == 0x7F;
  if (character.size() == 2) return first == 0xC2 && static_cast<unsigned char>(character[1]) < 0xA0;
  return character == "\u2028" || character == "\u2029";
}

// The number of a character in valid UTF-8.
char32_t code_point(std::string_view character) {
  static constexpr std::array<unsigned char, 5> kFirstBits{0, 0x7F, 0x1F, 0x0F, 0x07};
  char32_t code = static_cast<unsigned char>(character.front()) & kFirstBits[character.size()];
  for (const char next : character.substr(1)) code = code << 6 | (static_cast<unsigned char>(next) & 0x3FU);
  return code;
}

// Characters of Unicode that have no shape of their own, or change the order of others: controls but for tab
// and line feed, blanks other than the plain one, and the property Default_Ignorable_Code_Point.
bool is_hidden(char32_t code) {
  struct Range {
    char32_t first, last;
  };
  static constexpr std::array<Range, 26> kHidden{
      {{0x00, 0x08},       {0x0B, 0x1F},       {0x7F, 0xA0},       {0xAD, 0xAD},       {0x34F, 0x34F},
       {0x61C, 0x61C},     {0x115F, 0x1160},   {0x1680, 0x1680},   {0x17B4, 0x17B5},   {0x180B, 0x180F},
       {0x2000, 0x200F},   {0x2028, 0x202F},   {0x205F, 0x206F},   {0x2800, 0x2800},   {0x3000, 0x3000},
       {0x3164, 0x3164},   {0xFE00, 0xFE0F},   {0xFEFF, 0xFEFF},   {0xFFA0, 0xFFA0},   {0xFFF0, 0xFFFB},
       {0x13430, 0x1343F}, {0x1BCA0, 0x1BCA3}, {0x1D159, 0x1D159}, {0x1D173, 0x1D17A}, {0xE0000, 0xE0FFF},
       {0x16FE4, 0x16FE4}}};
  return std::ranges::any_of(
      kHidden, [code](const Range& range) { return code >= range.first && code <= range.last; });
}

std::string hex_digits(char32_t value, int digits) {
  std::string text;
  for (int shift = 4 * (digits - 1); shift >= 0; shift -= 4) text += "0123456789ABCDEF"[value >> shift & 15U];
  return text;
}

// \x1B, \u202E or \U000E0001.
std::string escape(char32_t code) {
  if (code < 0x80) return "\\x" + hex_digits(code, 2);
  return code < 0x10000 ? "\\u" + hex_digits(code, 4) : "\\U" + hex_digits(code, 8);
}

template <class Value>
std::optional<Value> parse_whole(std::string_view text) {
  text = trim(text);
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  Value value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

template <class Range>
std::string describe_range(const Range& range, const std::string& kind,
                           std::string (*to_text)(decltype(Range::min))) {
  const bool has_min = range.min != Range{}.min;
  const bool has_max = range.max != Range{}.max;
  if (has_min && has_max) return kind + " from " + to_text(range.min) + " to " + to_text(range.max);
  if (has_min) return kind + " of " + to_text(range.min) + " or more";
  if (has_max) return kind + " of " + to_text(range.max) + " or less";
  return kind;
}

// Optimal string alignment distance by dynamic programming: rows[i][j] is the distance between the first i
// letters of a and the first j letters of b.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::vector<std::size_t>> rows(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) {
    for (std::size_t j = 0; j <= b.size(); ++j) {
      if (i == 0 || j == 0) {
        rows[i][j] = i + j;
        continue;
      }
      const std::size_t substituted = rows[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      rows[i][j] = std::min({substituted, rows[i - 1][j] + 1, rows[i][j - 1] + 1});
      const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped) rows[i][j] = std::min(rows[i][j], rows[i - 2][j - 2] + 1);
    }
  }
  return rows[a.size()][b.size()];
}

}  // namespace

std::string read_text_file(const std::filesystem::path& file, const std::string& expected) {
  std::error_code ignored;
  if (std::filesystem::is_directory(file, ignored)) throw InputError(file, 0, "a folder", expected);
  errno = 0;
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw InputError(file, 0, errno == ENOENT ? "no such file" : std::strerror(errno), expected);
  std::string text;
  std::array<char, 4096> chunk;
  while (stream.read(chunk.data(), chunk.size()), stream.gcount() > 0) {
    text.append(chunk.data(), static_cast<std::size_t>(stream.gcount()));
    if (text.size() > kMaxFileSize) throw InputError(file, 0, "more than 16 MiB", expected);
  }
  return text;
}

std::size_t find_invalid_utf8(std::string_view text) {
  // The second byte's range excludes overlong forms, surrogates and numbers above 10FFFF.
  struct Form {
    unsigned char first, last;  // of the first byte
    std::size_t more;           // bytes that follow
    unsigned char low, high;    // of the second byte
  };
  static constexpr std::array<Form, 9> kForms{{{0x00, 0x7F, 0, 0, 0},
                                               {0xC2, 0xDF, 1, 0x80, 0xBF},
                                               {0xE0, 0xE0, 2, 0xA0, 0xBF},
                                               {0xE1, 0xEC, 2, 0x80, 0xBF},
                                               {0xED, 0xED, 2, 0x80, 0x9F},
                                               {0xEE, 0xEF, 2, 0x80, 0xBF},
                                               {0xF0, 0xF0, 3, 0x90, 0xBF},
                                               {0xF1, 0xF3, 3, 0x80, 0xBF},
                                               {0xF4, 0xF4, 3, 0x80, 0x8F}}};
  for (std::size_t i = 0; i < text.size();) {
    const auto byte = static_cast<unsigned char>(text[i]);
    const auto form = std::find_if(kForms.begin(), kForms.end(), [&](const Form& other) {
      return byte >= other.first && byte <= other.last;
    });
    if (form == kForms.end() || text.size() - i <= form->more) return i;
    for (std::size_t k = 1; k <= form->more; ++k) {
      const auto next = static_cast<unsigned char>(text[i + k]);
      if (next < (k == 1 ? form->low : 0x80) || next > (k == 1 ? form->high : 0xBF)) return i;
    }
    i += 1 + form->more;
  }
  return std::string_view::npos;
}

void require_utf8(std::string_view text, const std::filesystem::path& source, bool has_lines) {
  const std::size_t bad = find_invalid_utf8(text);
  if (bad == std::string_view::npos) return;
  const auto line = std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(bad), '\n') + 1;
  throw InputError(source, has_lines ? static_cast<int>(line) : 0, "a byte that is not UTF-8", "UTF-8 text");
}

std::string name_fault(std::string_view name) {
  if (name.empty()) return "an empty text";
  if (find_invalid_utf8(name) != std::string_view::npos) return "a byte that is not UTF-8";
  bool is_first = true;
  bool was_blank = false;
  for (std::size_t i = 0; i < name.size();) {
    const std::size_t length = character_length(name, i);
    const std::string_view character = name.substr(i, length);
    if (is_control(character)) return "a control character";
    was_blank = is_blank(character);
    if (was_blank && is_first) return "white space at its beginning";
    is_first = false;
    i += length;
  }
  return was_blank ? "white space at its end" : "";
}

std::string_view trimmed_name(std::string_view text) {
  while (!text.empty()) {
    const std::string_view first = text.substr(0, character_length(text, 0));
    if (!is_blank(first) && !is_control(first)) break;
    text.remove_prefix(first.size());
  }
  while (!text.empty()) {
    std::size_t begin = text.size() - 1;
    while (begin > 0 && is_continuation(text[begin])) --begin;
    const std::string_view last = text.substr(begin);
    if (!is_blank(last) && !is_control(last)) break;
    text.remove_suffix(last.size());
  }
  return text;
}

std::optional<double> parse_number(std::string_view text) {
  const auto value = parse_whole<double>(text);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

std::optional<std::int64_t> parse_integer(std::string_view text) { return parse_whole<std::int64_t>(text); }

std::optional<std::int64_t> parse_hexadecimal(std::string_view text) {
  if (!text.starts_with("0x")) return std::nullopt;
  text.remove_prefix(2);
  std::uint32_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, 16);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::string describe(const NumberRange& range) { return describe_range(range, "a number", number_text); }

std::string describe(const IntegerRange& range) {
  return describe_range<IntegerRange>(range, "an integer",
                                      [](std::int64_t value) { return std::to_string(value); });
}

std::string join_alternatives(std::span<const std::string> names) {
  std::string joined;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i > 0) joined += i + 1 == names.size() ? " or " : ", ";
    joined += names[i];
  }
  return joined;
}

std::optional<std::string> nearest_name(std::string_view misspelt, std::span<const std::string> names) {
  misspelt = misspelt.substr(0, kMaxQuoteLength);
  std::size_t least = std::max<std::size_t>(misspelt.size() / 3, 1) + 1;
  std::optional<std::string> nearest;
  for (const std::string& name : names) {
    const std::size_t distance = edit_distance(misspelt, name);
    if (distance >= least) continue;
    least = distance;
    nearest = name;
  }
  return nearest;
}

std::string expected_names(std::string_view misspelt, std::span<const std::string> names) {
  constexpr std::size_t kLongList = 24;
  const std::optional<std::string> nearest = nearest_name(misspelt, names);
  if (nearest && names.size() > kLongList)
    return *nearest + ", the nearest of " + std::to_string(names.size()) + " names";
  return join_alternatives(names) + (nearest && names.size() > 1 ? "; the nearest is " + *nearest : "");
}

std::string count_text(std::uint64_t count, const std::string& singular) {
  return std::to_string(count) + " " + singular + (count == 1 ? "" : "s");
}

std::string degrees_text(double angle_rad) {
  return number_text(std::round(angle_rad * kDegreesPerRad * 1e4) / 1e4);
}

std::string number_text(double value) {
  std::array<char, 32> buffer;
  const auto result = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  return std::string(buffer.data(), result.ptr);
}

// Messages must neither look like other text nor control the terminal.
std::string utf8_text(std::string_view text) {
  std::string valid;
  while (!text.empty()) {
    const std::size_t bad = std::min(find_invalid_utf8(text), text.size());
    for (std::size_t i = 0; i < bad;) {
      const std::size_t length = std::min(character_length(text, i), bad - i);
      const std::string_view character = text.substr(i, length);
      const char32_t code = code_point(character);
      valid += is_hidden(code) ? escape(code) : std::string(character);
      i += length;
    }
    if (bad == text.size()) break;
    valid += "\\x" + hex_digits(static_cast<unsigned char>(text[bad]), 2);
    text.remove_prefix(bad + 1);
  }
  return valid;
}

std::string utf8_line(std::string_view text) {
  std::string line;
  for (const char c : utf8_text(text)) {
    if (c == '\n')
      line += escape(U'\n');
    else
      line += c;
  }
  return line;
}

std::string one_line(std::string_view text) {
  std::size_t length = std::min(text.size(), kMaxQuoteLength);
  while (length < text.size() && length > 0 && is_continuation(text[length])) --length;
  std::string line(text.substr(0, length));
  for (char& c : line) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) c = ' ';
  }
  line = utf8_text(line);
  if (text.size() > length) line += "...";
  return line;
}

}  // namespace koboshi
