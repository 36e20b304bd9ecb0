#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>

#include "base/xml/xml_schema.h"

namespace koboshi::tools {

// Values that are proposed instead of faulty ones.

// Returns the inertia matrix of a rigid body that is nearest to this one by the Frobenius norm: its principal
// moments are positive and none exceeds the sum of the others. A plate gets 1e-4 of thickness. Nothing for a
// matrix without a positive moment.
[[nodiscard]] std::optional<Eigen::Matrix3d> nearest_inertia(const Eigen::Matrix3d& inertia);

// Returns the permitted value that is nearest to a text: in range, with a decimal point, whole, spelt right.
// Nothing if none is near.
[[nodiscard]] std::optional<std::string> nearest_value(const std::string& text, XmlContent content,
                                                       std::size_t numbers, const NumberRange& range,
                                                       const std::vector<std::string>& choices);

// Returns the direction of a vector of three numbers as a text; nothing for a vector without a direction.
[[nodiscard]] std::optional<std::string> unit_vector_text(const Eigen::Vector3d& vector);

// Returns the file with the nearest name in the folder that a missing file should be in, as the path is
// written: "meshes/servo.stl" for "meshes/sevro.stl". Nothing if no name is near.
[[nodiscard]] std::optional<std::string> nearest_file(const std::filesystem::path& folder,
                                                      const std::string& written);

// Rounds to six significant digits.
[[nodiscard]] std::string short_number(double value);

}  // namespace koboshi::tools
