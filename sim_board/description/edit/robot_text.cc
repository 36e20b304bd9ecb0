#include "sim_board/description/edit/robot_text.h"

#include <algorithm>
#include <sstream>

#include "base/text/error.h"
#include "sim_board/description/edit/field_value.h"
#include "sim_board/description/load.h"

namespace koboshi::sim_board {
namespace {

std::vector<std::string> numbers_of(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

// The numbers of a pose with those of one half replaced; all blanks between them stay.
std::string pose_text(const std::string& pose, PosePart part, const std::string& half) {
  const std::vector<std::string> added = numbers_of(half);
  const std::size_t first = part == PosePart::kPosition ? 0 : 3;
  std::string text;
  std::size_t at = 0;
  for (std::size_t i = 0; at < pose.size(); ++i) {
    const std::size_t begin = std::min(pose.find_first_not_of(" \t\r\n", at), pose.size());
    const std::size_t end = std::min(pose.find_first_of(" \t\r\n", begin), pose.size());
    text += pose.substr(at, begin - at);
    if (begin == end) break;
    text += i >= first && i < first + 3 ? added[i - first] : pose.substr(begin, end - begin);
    at = end;
  }
  return text;
}

// Number of the child before which an element of this rule belongs, by the order of the rules.
std::size_t place_of(const XmlPart& parent, const XmlRule& parent_rule, const XmlRule& rule) {
  const auto order = [&](const std::string& name) {
    const auto found = std::ranges::find(parent_rule.children, name, &XmlRule::name);
    return found - parent_rule.children.begin();
  };
  const auto elements = parent.elements();
  std::size_t place = 0;
  for (std::size_t i = 0; i < elements.size(); ++i)
    if (order(elements[i]->name) < order(rule.name)) place = i + 1;
  return place;
}

// Adds the elements of a field that the file lacks, empty.
XmlPath with_elements(XmlDocument& document, const ModelField& field, const std::string& text) {
  XmlPath path = *ModelField{.steps = {}}.element_path(document);
  for (std::size_t i = 0; i < field.steps.size(); ++i) {
    const ModelField::Step& step = field.steps[i];
    if (step.number) {
      path.push_back(*step.number);
      continue;
    }
    const bool is_last = i + 1 == field.steps.size();
    const std::string& tag = step.rule->name;
    const std::size_t place = place_of(*document.find(path), *field.steps[i - 1].rule, *step.rule);
    const bool has_text = is_last && field.attribute == nullptr;
    document.insert_element(path, place,
                            has_text ? "<" + tag + ">" + text + "</" + tag + ">" : "<" + tag + "/>");
    path.push_back(place);
  }
  return path;
}

void set_file_text(XmlDocument& document, const ModelField& field, const std::string& value) {
  std::string text = value;
  if (field.part != PosePart::kWhole) {
    const auto path = field.element_path(document);
    const XmlPart* part = path ? document.find(*path) : nullptr;
    text = pose_text(part != nullptr ? part->content() : "0 0 0 0 0 0", field.part, value);
    const std::size_t begin = std::min(text.find_first_not_of(" \t\r\n"), text.size());
    text = text.substr(begin, text.find_last_not_of(" \t\r\n") + 1 - begin);
  }
  XmlDocument edited = document;
  const XmlPath path = with_elements(edited, field, text);
  if (field.attribute != nullptr) {
    edited.set_attribute(path, field.attribute->name, text);
  } else {
    const bool is_name = field.content() == XmlContent::kText;
    edited.set_text(path, text, is_name ? XmlDocument::Blanks::kGo : XmlDocument::Blanks::kStay);
  }
  document = std::move(edited);
}

}  // namespace

void set_field(XmlDocument& document, const ModelField& field, const std::string& typed) {
  set_file_text(document, field, file_text(document, field, typed));
}

void erase_field(XmlDocument& document, const ModelField& field) {
  const auto path = field.element_path(document);
  if (!field.value || !path || field.is_required() || field.part != PosePart::kWhole)
    throw InputError(document.source(), path ? document.find(*path)->line : 0,
                     field.path + " without a value",
                     field.value && path ? field.expected() : "an optional value that is in the file");
  if (field.attribute != nullptr) return document.erase_attribute(*path, field.attribute->name);
  document.erase_element(*path);
}

void edit_settings(XmlDocument& document, const std::vector<ModelSetting>& settings, Sides sides) {
  XmlDocument edited = document;
  for (const ModelSetting& setting : settings) {
    const ModelField field = find_field(edited, setting.path);
    if (setting.value.empty()) {
      if (sides == Sides::kBoth)
        erase_field(edited, mirrored_value(edited, field, field.value.value_or("")).field);
      erase_field(edited, find_field(edited, setting.path));
      continue;
    }
    const std::string value = file_text(edited, field, setting.value);
    if (sides == Sides::kOne) {
      set_file_text(edited, field, value);
      continue;
    }
    const MirroredValue other = mirrored_value(edited, field, value);
    set_file_text(edited, other.field, other.value);
    set_file_text(edited, find_field(edited, field.key()), value);  // the edit has moved it
  }
  document = std::move(edited);
}

void apply_settings(XmlDocument& document, const std::vector<ModelSetting>& settings, Sides sides) {
  XmlDocument edited = document;
  edit_settings(edited, settings, sides);
  static_cast<void>(load_robot(edited.source(), edited.text()));
  document = std::move(edited);
}

}  // namespace koboshi::sim_board
