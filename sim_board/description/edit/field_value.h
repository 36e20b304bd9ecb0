#pragma once

#include <string>

#include "sim_board/description/edit/model_field.h"

namespace koboshi::sim_board {

// Returns the text for a file of a value as people type it. Numbers may have a unit (split_units) that
// differs from the field's: "150 deg", "60g", "0 0 -65 mm". Throws InputError unless the value fits the
// field; `document` gives file and line.
[[nodiscard]] std::string file_text(const XmlDocument& document, const ModelField& field,
                                    const std::string& typed);

// Returns the file's unit, in which a typed number without a unit is taken: "kg". Empty if a unit was typed,
// and for texts, ratios and counts.
[[nodiscard]] std::string assumed_unit(const ModelField& field, const std::string& typed);

// Returns a value of the file in the unit in which people read it, without the unit: "150" for 2.617994 rad.
// Equal to the value where there is no such unit.
[[nodiscard]] std::string shown_text(const ModelField& field, const std::string& value);
// That unit: "deg", "mm", "g", or the field's own. Empty for texts and for ratios.
[[nodiscard]] std::string shown_unit(const ModelField& field);

}  // namespace koboshi::sim_board
