#include "simulation/motion_language/parse/reader.h"

#include <algorithm>

#include "base/text/units.h"
#include "base/yaml/yaml_reader.h"
#include "simulation/motion_language/parse/codes.h"

namespace koboshi::simulation {

namespace {

Place place_of(const YamlNode& node, int line, int column, std::size_t length) {
  Place place{.line = line, .column = column, .length = static_cast<int>(std::max<std::size_t>(length, 1))};
  if (node.line == 0) place.option = node.source.path().string();
  return place;
}

}  // namespace

Place Reader::key_place(const YamlNode& node) {
  if (node.key.empty()) return value_place(node);
  return place_of(node, node.line, node.column, node.key.size());
}

Place Reader::value_place(const YamlNode& node) {
  const bool is_scalar = node.kind == YamlNode::Kind::kScalar;
  const bool one_line = node.scalar.find('\n') == std::string::npos;
  return place_of(node, node.value_line, node.value_column,
                  is_scalar && one_line ? node.scalar.size() + (node.quoted ? 2 : 0) : 1);
}

void Reader::error(const char* code, Place place, std::string found, std::string expected, std::string hint,
                   std::string limit) {
  diagnostics_.add({.code = code,
                    .place = std::move(place),
                    .found = std::move(found),
                    .expected = std::move(expected),
                    .hint = std::move(hint),
                    .limit = std::move(limit)});
}

void Reader::bad_value(const YamlNode& node, const std::string& expected, std::string hint) {
  // The line in short messages is that of the key, where a reader looks.
  Place place = value_place(node);
  if (place.line != node.line) place = key_place(node);
  error(code::kBadValue, place, describe_found(node), expected, std::move(hint), node.path + ", " + expected);
}

std::optional<double> Reader::number(const YamlNode& node, const NumberRange& range) {
  const bool plain = node.kind == YamlNode::Kind::kScalar && !node.quoted;
  const auto value = plain ? parse_number(node.scalar) : std::nullopt;
  if (value && *value >= range.min && *value <= range.max) return value;
  // The tools that edit motions read the numbers of the text.
  const auto typed = plain && !value ? split_units(node.scalar) : std::nullopt;
  bad_value(node, koboshi::describe(range) + (typed && !typed->unit.empty() ? " without a unit" : ""));
  return std::nullopt;
}

std::optional<std::int64_t> Reader::integer(const YamlNode& node, const IntegerRange& range) {
  const bool plain = node.kind == YamlNode::Kind::kScalar && !node.quoted;
  const auto value = plain ? parse_integer(node.scalar) : std::nullopt;
  if (value && *value >= range.min && *value <= range.max) return value;
  bad_value(node, koboshi::describe(range));
  return std::nullopt;
}

std::optional<std::string> Reader::text(const YamlNode& node) {
  const bool is_text = node.kind == YamlNode::Kind::kScalar && !node.scalar.empty();
  const std::string fault = is_text ? name_fault(node.scalar) : std::string();
  if (is_text && fault.empty()) return node.scalar;
  bad_value(node, is_text ? "a text without " + fault : "a text");
  return std::nullopt;
}

std::optional<std::string> Reader::one_of(const YamlNode& node, const std::vector<std::string>& names) {
  if (node.kind == YamlNode::Kind::kScalar &&
      std::find(names.begin(), names.end(), node.scalar) != names.end()) {
    return node.scalar;
  }
  bad_value(node, join_alternatives(names), did_you_mean(node.scalar, names));
  return std::nullopt;
}

bool Reader::is_map(const YamlNode& node) {
  if (node.kind == YamlNode::Kind::kMap) return true;
  bad_value(node, "a map");
  return false;
}

bool Reader::is_list(const YamlNode& node) {
  if (node.kind == YamlNode::Kind::kList) return true;
  bad_value(node, "a list");
  return false;
}

const YamlNode* Reader::require(const YamlNode& map, const std::string& key, const std::string& expected) {
  const YamlNode* node = map.find(key);
  if (node != nullptr) return node;
  const std::string path = map.path.empty() ? key : map.path + "." + key;
  error(code::kMissingKey, key_place(map), "no key " + one_line(path), expected);
  return nullptr;
}

void Reader::check_keys(const YamlNode& map, const std::vector<std::string>& known) {
  for (const YamlNode& item : map.items) {
    if (std::find(known.begin(), known.end(), item.key) != known.end()) continue;
    error(code::kUnknownKey, key_place(item), "the unknown key " + one_line(item.path),
          known.empty() ? "no key here" : join_alternatives(known), did_you_mean(item.key, known));
  }
}

}  // namespace koboshi::simulation
