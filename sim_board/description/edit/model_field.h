#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "base/edit/xml_document.h"
#include "base/xml/xml_schema.h"

namespace koboshi::sim_board {

// A part of a value of six numbers, x y z roll pitch yaw.
enum class PosePart { kWhole, kPosition, kRotation };

// A value in a robot's file that can be edited: the text of an element, an attribute of one, or half of a
// pose. It holds for the document that it was found in until the next edit of it.
struct ModelField {
  // The elements from the child of <model> to the one with the value. `number` is that among all elements of
  // its parent; none: the file lacks the element.
  struct Step {
    const XmlRule* rule = nullptr;
    std::optional<std::size_t> number{};
    std::string name{};  // of a named element
  };

  std::vector<Step> steps{};
  const XmlAttributeRule* attribute = nullptr;  // nullptr: the element's text
  PosePart part = PosePart::kWhole;
  std::vector<std::string> words{};    // of the key
  std::string path{};                  // shortest text that find_field() understands
  std::optional<std::string> value{};  // as in the file; none: the file lacks it

  const XmlRule& rule() const { return *steps.back().rule; }
  XmlContent content() const { return attribute != nullptr ? attribute->content : rule().content; }
  const NumberRange& range() const { return attribute != nullptr ? attribute->range : rule().range; }
  // The only values that a text may have; empty: any.
  const std::vector<std::string>& choices() const;
  const XmlNote& note() const { return attribute != nullptr ? attribute->note : rule().note; }
  bool is_required() const;
  // How many numbers the value has.
  std::size_t numbers() const;
  // "kg"; "m" and "rad" for the halves of a pose. Empty for texts.
  std::string unit() const;
  // The value of a field that the file lacks; empty: none.
  std::string fallback() const;
  // "a number from 0 to 1 in kg": what a value must be.
  std::string expected() const;
  // Tags, names and the last word, without "koboshi:", joined by dots: one field has no other's key.
  std::string key() const;
  // The last word of the key: the tag or attribute, "position" or "rotation".
  const std::string& last_word() const { return words.back(); }
  // The elements' numbers from the root of the document; none if the file lacks one of them.
  std::optional<XmlPath> element_path(const XmlDocument& document) const;
};

// A named or single element below <model>: a link, joint, type of servo, or the battery.
struct ModelElement {
  const XmlRule* rule = nullptr;
  std::size_t number = 0;  // among the elements of <model>
  std::string name{};      // its name, or the tag of an element without one

  bool is(std::string_view tag) const { return rule->name == tag; }
};

// In the order of the file.
[[nodiscard]] std::vector<ModelElement> model_elements(const XmlDocument& document);

// Everything that can be edited in an element, in the order of the table of keys; also values that the file
// lacks, except within repeated elements.
[[nodiscard]] std::vector<ModelField> model_fields(const XmlDocument& document, const ModelElement& element);

// Finds a field by a path such as left_shank.mass (docs/reference/model-set.md). Throws InputError.
[[nodiscard]] ModelField find_field(const XmlDocument& document, const std::string& path);

// Returns the usual name of the value: "axis" for xyz, "zoom" for scale.
[[nodiscard]] std::string field_label(const ModelField& field);

// The nearest field among these that the words match, as find_field() does; nullptr: none, or several.
[[nodiscard]] const ModelField* match_field(const std::vector<ModelField>& fields,
                                            const std::vector<std::string>& words);

// Splits at dots.
[[nodiscard]] std::vector<std::string> path_words(const std::string& path);

// "joint" for "koboshi:joint".
[[nodiscard]] std::string plain_tag(const std::string& tag);

}  // namespace koboshi::sim_board
