#include "tools/robot_file/check/repairs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "mechanics/axes.h"

namespace koboshi::tools {
namespace {

using Eigen::Vector3d;

// Projects onto the moments of which none exceeds the sum of the others, by Dykstra's algorithm: the three
// half-spaces in turn, each with its own correction (Boyle and Dykstra, 1986).
Vector3d nearest_moments(Vector3d moments) {
  constexpr int kMaxRounds = 1000;
  std::array<Vector3d, 3> corrections;
  corrections.fill(Vector3d::Zero());
  for (int round = 0; round < kMaxRounds; ++round) {
    const Vector3d before = moments;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      Vector3d normal = -Vector3d::Ones();
      normal[static_cast<Eigen::Index>(axis)] = 1.0;  // m_axis - m_other - m_other <= 0
      const Vector3d corrected = moments + corrections[axis];
      const double excess = normal.dot(corrected);
      moments = excess > 0.0 ? Vector3d(corrected - excess / 3.0 * normal) : corrected;
      corrections[axis] = corrected - moments;
    }
    if ((moments - before).norm() <= 1e-12 * moments.norm()) break;
  }
  return moments;
}

std::optional<std::vector<double>> numbers_with_comma(std::string text) {
  std::ranges::replace(text, ',', '.');
  return parse_numbers(text);
}

std::optional<std::string> nearest_numbers(const std::string& text, std::size_t numbers,
                                           const NumberRange& range) {
  std::optional<std::vector<double>> values = parse_numbers(text);
  if (!values) values = numbers_with_comma(text);
  if (!values || values->size() != numbers) return std::nullopt;
  std::string nearest;
  for (const double value : *values) {
    // A sign is mistyped more often than a magnitude.
    const bool is_sign = value < range.min && -value >= range.min && -value <= range.max;
    const double valid = is_sign ? -value : std::clamp(value, range.min, range.max);
    nearest += (nearest.empty() ? "" : " ") + number_text(valid);
  }
  return nearest;
}

}  // namespace

std::optional<Eigen::Matrix3d> nearest_inertia(const Eigen::Matrix3d& inertia) {
  const auto [principal_moments, axes] = mechanics::principal_inertia(inertia);
  Vector3d moments = nearest_moments(principal_moments);
  if (!(moments.maxCoeff() > 1e-9)) return std::nullopt;
  // A rod has no moment about its axis, and a plate's largest moment equals the sum of the others. Such
  // limits do not survive the rounding of a file: the result is a little thicker.
  constexpr double kThickness = 1e-4;
  const bool is_thin = 2.0 * moments.maxCoeff() >= moments.sum() * (1.0 - kThickness);
  if (is_thin) moments += Vector3d::Constant(2.0 * kThickness * moments.maxCoeff());
  return axes * moments.asDiagonal() * axes.transpose();
}

std::optional<std::string> nearest_value(const std::string& text, XmlContent content, std::size_t numbers,
                                         const NumberRange& range, const std::vector<std::string>& choices) {
  if (content == XmlContent::kText && choices.empty()) {
    const std::string trimmed(trimmed_name(text));
    return name_fault(trimmed).empty() ? std::optional(trimmed) : std::nullopt;
  }
  if (!choices.empty()) {
    if (choices.size() == 1) return choices.front();
    return nearest_name(text, choices);
  }
  if (content == XmlContent::kNumbers) return nearest_numbers(text, numbers, range);
  if (content != XmlContent::kInteger) return std::nullopt;
  const auto number = parse_numbers(text);
  if (!number || number->size() != 1) return std::nullopt;
  return fmt::format("{:.0f}", std::clamp(std::round(number->front()), range.min, range.max));
}

std::optional<std::string> unit_vector_text(const Vector3d& vector) {
  const double length = vector.norm();
  if (length < 1e-6) return std::nullopt;
  const Vector3d unit = vector / length;
  return short_number(unit.x()) + " " + short_number(unit.y()) + " " + short_number(unit.z());
}

std::optional<std::string> nearest_file(const std::filesystem::path& folder, const std::string& written) {
  const std::filesystem::path path(written);
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder / path.parent_path(), error))
    if (entry.is_regular_file(error)) names.push_back(entry.path().filename().string());
  std::ranges::sort(names);  // the order of a folder is that of its file system
  const auto nearest = nearest_name(path.filename().string(), names);
  if (!nearest) return std::nullopt;
  return (path.parent_path() / *nearest).string();
}

std::string short_number(double value) {
  const std::string text = fmt::format("{:.6g}", value);
  return text == "-0" ? "0" : text;
}

}  // namespace koboshi::tools
