#include "base/yaml/yaml_reader.h"

#include <algorithm>

#include "base/text/units.h"

namespace koboshi {
namespace {

bool is_plain(const YamlNode& node) { return node.kind == YamlNode::Kind::kScalar && !node.quoted; }

void check_all_known(const YamlNode& node) {
  for (const YamlNode& item : node.items) {
    if (node.kind == YamlNode::Kind::kMap && !node.asked.contains(item.key)) {
      const std::vector<std::string> known(node.asked.begin(), node.asked.end());
      throw InputError(item.source.path(), item.line, "the unknown key " + one_line(item.path),
                       known.empty() ? "no key here" : expected_names(item.key, known));
    }
    check_all_known(item);
  }
}

}  // namespace

std::string describe_found(const YamlNode& node) {
  const std::string name = node.path.empty() ? "the document" : one_line(node.path);
  switch (node.kind) {
    case YamlNode::Kind::kNull:
      return name + " without a value";
    case YamlNode::Kind::kMap:
      return name + ", a map";
    case YamlNode::Kind::kList:
      return name + ", a list";
    case YamlNode::Kind::kScalar:
      break;
  }
  const std::string quote = node.quoted ? "\"" : "";
  return name + " = " + quote + one_line(node.scalar) + quote;
}

double YamlValue::number(const NumberRange& range) const {
  const std::string unit = unit_of_key(node_->path);
  const auto value = is_plain(*node_) ? parse_quantity(node_->scalar, unit) : std::nullopt;
  if (value && *value >= range.min && *value <= range.max) return *value;
  const auto typed = is_plain(*node_) ? split_units(node_->scalar) : std::nullopt;
  const bool has_bad_unit = !value && typed && !typed->unit.empty() && !unit.empty();
  throw InputError(node_->source.path(), node_->line, describe_found(*node_),
                   describe(range) + (has_bad_unit ? " with " + expected_unit(unit) : ""),
                   node_->path + ", " + describe(range));
}

std::int64_t YamlValue::integer(const IntegerRange& range) const {
  auto value = is_plain(*node_) ? parse_integer(node_->scalar) : std::nullopt;
  if (!value && is_plain(*node_)) value = parse_hexadecimal(node_->scalar);
  if (!value || *value < range.min || *value > range.max) throw error(describe(range));
  return *value;
}

bool YamlValue::boolean() const {
  if (is_plain(*node_) && node_->scalar == "true") return true;
  if (is_plain(*node_) && node_->scalar == "false") return false;
  throw error("true or false");
}

std::string YamlValue::text() const {
  if (node_->kind != YamlNode::Kind::kScalar || node_->scalar.empty()) throw error("a text");
  if (const std::string fault = name_fault(node_->scalar); !fault.empty())
    throw error("a text without " + fault);
  return node_->scalar;
}

std::string YamlValue::one_of(std::span<const std::string> names) const {
  const bool known = node_->kind == YamlNode::Kind::kScalar &&
                     std::find(names.begin(), names.end(), node_->scalar) != names.end();
  if (!known) throw error(expected_names(node_->scalar, names));
  return node_->scalar;
}

YamlMap YamlValue::map() const {
  if (!is_map()) throw error("a map");
  return YamlMap(*node_);
}

std::vector<YamlValue> YamlValue::list() const {
  if (!is_list()) throw error("a list");
  return std::vector<YamlValue>(node_->items.begin(), node_->items.end());
}

std::vector<double> YamlValue::numbers(std::size_t count, const NumberRange& range) const {
  if (!is_list() || node_->items.size() != count)
    throw error("a list of " + std::to_string(count) + " numbers");
  std::vector<double> values;
  for (const YamlValue& item : list()) values.push_back(item.number(range));
  return values;
}

InputError YamlValue::error(const std::string& expected) const {
  return error(describe_found(*node_), expected);
}

InputError YamlValue::error(const std::string& found, const std::string& expected) const {
  return InputError(node_->source.path(), node_->line, found, expected);
}

const YamlNode* YamlMap::find(const std::string& key) const {
  node_->asked.insert(key);
  return node_->find(key);
}

const YamlNode& YamlMap::require(const std::string& key, const std::string& expected) const {
  const YamlNode* node = find(key);
  const std::string path = node_->path.empty() ? key : node_->path + "." + key;
  if (!node) throw InputError(node_->source.path(), node_->line, "no key " + one_line(path), expected);
  return *node;
}

double YamlMap::number(const std::string& key, const NumberRange& range,
                       std::optional<double> fallback) const {
  if (fallback && !has(key)) return *fallback;
  return YamlValue(require(key, describe(range))).number(range);
}

std::int64_t YamlMap::integer(const std::string& key, const IntegerRange& range,
                              std::optional<std::int64_t> fallback) const {
  if (fallback && !has(key)) return *fallback;
  return YamlValue(require(key, describe(range))).integer(range);
}

bool YamlMap::boolean(const std::string& key, std::optional<bool> fallback) const {
  if (fallback && !has(key)) return *fallback;
  return YamlValue(require(key, "true or false")).boolean();
}

std::string YamlMap::text(const std::string& key, std::optional<std::string> fallback) const {
  if (fallback && !has(key)) return *fallback;
  return YamlValue(require(key, "a text")).text();
}

std::string YamlMap::one_of(const std::string& key, const std::vector<std::string>& names,
                            std::optional<std::string> fallback) const {
  if (fallback && !has(key)) return *fallback;
  return YamlValue(require(key, join_alternatives(names))).one_of(names);
}

std::vector<double> YamlMap::numbers(const std::string& key, std::size_t count,
                                     const NumberRange& range) const {
  return YamlValue(require(key, "a list of " + std::to_string(count) + " numbers")).numbers(count, range);
}

YamlMap YamlMap::child(const std::string& key) const { return YamlValue(require(key, "a map")).map(); }

std::optional<YamlMap> YamlMap::optional_child(const std::string& key) const {
  if (!has(key)) return std::nullopt;
  return child(key);
}

std::vector<YamlValue> YamlMap::list(const std::string& key) const {
  return YamlValue(require(key, "a list")).list();
}

YamlValue YamlMap::value(const std::string& key) const { return YamlValue(require(key, "a value")); }

bool YamlMap::has(const std::string& key) const { return find(key) != nullptr; }

std::vector<std::pair<std::string, YamlValue>> YamlMap::entries() const {
  std::vector<std::pair<std::string, YamlValue>> all;
  for (const YamlNode& item : node_->items) {
    node_->asked.insert(item.key);
    all.emplace_back(item.key, YamlValue(item));
  }
  return all;
}

void YamlMap::require_version(std::int64_t version) const {
  const std::string expected = "version " + std::to_string(version);
  const YamlValue found(require("version", expected));
  if (found.integer() != version) throw found.error(expected);
}

int YamlMap::line_of(const std::string& key) const {
  const YamlNode* node = node_->find(key);
  return node ? node->line : node_->line;
}

InputError YamlMap::error_at(const std::string& key, const std::string& found,
                             const std::string& expected) const {
  const YamlNode* node = node_->find(key);
  return YamlValue(node ? *node : *node_).error(found, expected);
}

YamlFile::YamlFile(std::filesystem::path file, std::span<const Override> overrides)
    : path_(std::move(file)), root_(parse_yaml(read_text_file(path_, "a YAML file"), path_)) {
  for (const Override& override_value : overrides) apply_override(root_, override_value);
}

void YamlFile::finish() const { check_all_known(root_); }

}  // namespace koboshi
