#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "sim_board/description/edit/model_field.h"

namespace koboshi::sim_board {

// A path of a field and a value as people type them; an empty value removes an optional value.
struct ModelSetting {
  std::string path{};
  std::string value{};
};

// Whether a setting is made on the other side of the robot, too.
enum class Sides { kOne, kBoth };

// Changes values in a robot's file, byte by byte as XmlDocument does. A value that the file lacks is added in
// the place of the table of keys, with the elements around it. Throws InputError and changes nothing for
// a path or a value that does not fit; what the values mean together only load() checks.
void set_field(XmlDocument& document, const ModelField& field, const std::string& typed);
void erase_field(XmlDocument& document, const ModelField& field);

// Makes settings in their order. Throws InputError and changes nothing for a path or a value that does
// not fit.
void edit_settings(XmlDocument& document, const std::vector<ModelSetting>& settings, Sides sides);
// The same; afterwards the robot must load. Throws InputError and changes nothing otherwise.
void apply_settings(XmlDocument& document, const std::vector<ModelSetting>& settings, Sides sides);

// The field of the other side with the value there that makes both sides mirror images in the plane y = 0, as
// a text for the file. `value`: as in the file. Frames must be mirror images; joints keep the direction in
// which they turn. Throws InputError if there is no other side, or no such value: node ids differ.
struct MirroredValue {
  ModelField field;
  std::string value;
};
[[nodiscard]] MirroredValue mirrored_value(const XmlDocument& document, const ModelField& field,
                                           const std::string& value);
// Whether mirrored_value() has a result; cheaper.
[[nodiscard]] bool has_other_side(const XmlDocument& document, const ModelField& field);

}  // namespace koboshi::sim_board
