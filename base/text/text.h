#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace koboshi {

// Functions shared by the YAML and the XML reader: text files, numbers, and texts of error messages.

// An inclusive range.
struct NumberRange {
  double min = -std::numeric_limits<double>::max();
  double max = std::numeric_limits<double>::max();
};
struct IntegerRange {
  std::int64_t min = std::numeric_limits<std::int64_t>::min();
  std::int64_t max = std::numeric_limits<std::int64_t>::max();
};

// Reads a file of at most 16 MiB. Throws InputError with `expected` (e.g. "a YAML file") if it cannot be
// read.
std::string read_text_file(const std::filesystem::path& file, const std::string& expected);

// Returns the offset of the first byte that is not part of a character in UTF-8 (RFC 3629, section 4);
// std::string_view::npos if there is none.
std::size_t find_invalid_utf8(std::string_view text);

// Throws InputError with the line of the first byte that is not UTF-8. `has_lines`: whether `source` is a
// file.
void require_utf8(std::string_view text, const std::filesystem::path& source, bool has_lines = true);
// Returns the text with \xNN for bytes that are not UTF-8, and escapes for characters that one cannot see.
std::string utf8_text(std::string_view text);
// The same on one line: a line feed becomes \x0A.
std::string utf8_line(std::string_view text);

// The rule for all names (of robots, links, joints, servo types, materials, motions, poses, files): at least
// one character, no control characters (also U+0080 to U+009F), no white space at either end. Returns the
// violation, "white space at its end"; empty if there is none.
std::string name_fault(std::string_view name);
// Returns the text without white space and control characters at its ends.
std::string_view trimmed_name(std::string_view text);

// Parses a finite decimal number, with optional surrounding blanks. Returns nothing for any other text.
// Independent of the locale.
std::optional<double> parse_number(std::string_view text);
std::optional<std::int64_t> parse_integer(std::string_view text);
// Parses 0x and hexadecimal digits (YAML 1.2.2, core schema). Returns nothing for other text and for values
// from 2^32 on.
std::optional<std::int64_t> parse_hexadecimal(std::string_view text);

// Describes a range: "a number from 0.01 to 3600", "an integer of 1 or more", ...
std::string describe(const NumberRange& range);
std::string describe(const IntegerRange& range);
// Joins names to "a, b or c".
std::string join_alternatives(std::span<const std::string> names);
// Returns the name nearest to a misspelt one, by the optimal string alignment distance (insertions,
// deletions, substitutions and transpositions). Returns nothing if more than a third of the letters differ.
std::optional<std::string> nearest_name(std::string_view misspelt, std::span<const std::string> names);
// Describes the names that are valid instead of a misspelt one: "a, b or c; the nearest is b", or for a long
// list only the nearest.
std::string expected_names(std::string_view misspelt, std::span<const std::string> names);
// Returns the shortest text that reads back as the same number.
std::string number_text(double value);
// Formats a count with its noun: "1 fault", "2 faults".
std::string count_text(std::uint64_t count, const std::string& singular);
// Formats an angle in degrees, rounded to 1e-4.
std::string degrees_text(double angle_rad);
// Converts text from a file for one line of a message: replaces control characters, escapes bytes that are
// not UTF-8 as utf8_text() does, and truncates long text between two characters.
std::string one_line(std::string_view text);

}  // namespace koboshi
