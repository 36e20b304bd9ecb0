#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "base/edit/xml_document.h"
#include "sim_board/description/edit/model_field.h"

namespace koboshi::studio {

// A number of a robot's file in which the simulated robot can differ from the firmware's model: a value of
// the table of keys (sim_board/description/schema), or one component of it. All numbers are in `unit`, the
// one in which people read the quantity.
struct PlantQuantity {
  sim_board::ModelField field{};  // of the model
  std::string path{};             // shortest usual name that the reader takes: left_shank.com
  std::size_t component = 0;      // of a vector
  std::string group{};            // "collision sole"
  std::string label{};            // "centre of mass z"
  std::string unit{};             // "mm"; empty for ratios and counts
  std::string plant_text{};       // of the whole value, as in a file
  double model = 0.0;             // the default where the file has no value
  double plant = 0.0;
  // Numbers that the reader of the file permits.
  double low = 0.0;
  double high = 0.0;
  // A part of them around the model's value, for a slider. Contains both values.
  double slider_low = 0.0;
  double slider_high = 0.0;
  int decimals = 0;  // tell a thousandth of the slider's range apart, and all digits of the model's value

  // A name of its own among all quantities: "left_shank.mass", "left_shank.com z".
  std::string name() const;
  bool differs() const { return model != plant; }
};

// The links, joints and types of servo of a robot, and its battery, in the order of the file.
[[nodiscard]] std::vector<sim_board::ModelElement> plant_elements(const XmlDocument& model);

// The quantities of an element: masses and inertias first, the rest in the order of the table of keys.
// `plant`: the model's text after simulation::apply_plant(). The look of the robot, what only its maker's
// files use, and the identity of a drive on the bus are no quantities. Empty for an unknown element.
[[nodiscard]] std::vector<PlantQuantity> plant_quantities(const XmlDocument& model, const XmlDocument& plant,
                                                          const std::string& element);

// The whole value, as people type it, with which the quantity becomes `value` and its other components stay:
// "80 g", "0 0 10 mm".
[[nodiscard]] std::string typed_value(const PlantQuantity& quantity, const XmlDocument& model, double value);

// Whether two texts of a file are the same numbers, or else the same text.
[[nodiscard]] bool same_value(const std::string& one, const std::string& other);

// The value of a field in a robot's text with its unit, "50 g", also a default; empty if there is none.
[[nodiscard]] std::string shown_value(const sim_board::ModelField& field);

// The same of a value that somebody has typed; a text that does not fit stays.
[[nodiscard]] std::string shown_typed(const XmlDocument& model, const sim_board::ModelField& field,
                                      const std::string& typed);

}  // namespace koboshi::studio
