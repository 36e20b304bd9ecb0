#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/text/text.h"

namespace koboshi {

// Schema of a kind of XML file. Elements and attributes without a rule are errors.

enum class XmlCount { kOptional, kRequired, kRepeated };

enum class XmlContent {
  kChildren,  // elements only, those of the rule
  kText,      // as name_fault() permits
  kNumbers,   // as many as the rule requires, finite and within its range
  kInteger,
  kAnything  // not checked
};

// Description of an element or attribute for people: pages, schemas and editors print it; the reader does not
// use it.
struct XmlNote {
  std::string unit = {};  // "kg"; "1" for a ratio or a count; empty for names and for groups
  std::string fallback =
      {};  // value that holds if the element or attribute is missing; empty: none, or required
  std::string meaning = {};  // a phrase without a full stop
  std::string source = {};   // document that defines the quantity
};

struct XmlAttributeRule {
  std::string name;
  XmlContent content = XmlContent::kText;
  bool required = true;
  NumberRange range = {};
  std::vector<std::string> choices = {};  // the only values; empty: all that `content` and `range` permit
  XmlNote note = {};
};

struct XmlRule {
  std::string name;
  XmlContent content = XmlContent::kChildren;
  XmlCount count = XmlCount::kOptional;
  std::vector<XmlAttributeRule> attributes = {};
  std::vector<XmlRule> children = {};
  std::size_t numbers = 1;
  NumberRange range = {};
  std::vector<std::string> choices = {};  // as in XmlAttributeRule
  XmlNote note = {};
  // A required element is required only if its parent has no such element: a child, or that child's child, as
  // "axis/mimic".
  std::string unless = {};

  bool is_always_required() const { return count == XmlCount::kRequired && unless.empty(); }
};

// Parses finite numbers separated by blanks. Returns nothing if any word is not a number.
std::optional<std::vector<double>> parse_numbers(std::string_view text);

// Whether a text is a value that a rule permits.
bool is_valid_value(const std::string& text, XmlContent content, std::size_t numbers,
                    const NumberRange& range, const std::vector<std::string>& choices);

// Describes the permitted values of a rule: "a number from 1e-06 to 1000", "3 times a number from -1 to 1",
// "a whole number from 1 to 127", "left or right", "a text"; empty for elements without a value.
std::string describe_values(XmlContent content, std::size_t numbers, const NumberRange& range,
                            const std::vector<std::string>& choices);

}  // namespace koboshi
