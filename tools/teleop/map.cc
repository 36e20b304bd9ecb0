#include "tools/teleop/map.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace koboshi::tools {
namespace {

char arrow(double heading_rad) {
  constexpr char kArrows[] = {'^', '<', 'v', '>'};  // counter-clockwise
  const long quarter = std::lround(heading_rad / (0.5 * std::numbers::pi));
  return kArrows[((quarter % 4) + 4) % 4];
}

}  // namespace

void TrailMap::move_to(const Eigen::Vector3d& place) {
  place_ = place;
  if (trail_.empty()) start_ = place.head<2>();
  if (!trail_.empty() && (place.head<2>() - trail_.back()).norm() < 0.5 * kColumn_m) return;
  trail_.push_back(place.head<2>());
  if (trail_.size() > kMaxPoints) trail_.pop_front();
}

std::vector<std::string> TrailMap::lines(bool lies) const {
  const std::string border = "+" + std::string(kColumns - 2, '-') + "+";
  std::vector<std::string> lines(kRows, "|" + std::string(kColumns - 2, ' ') + "|");
  lines.front() = border;
  lines.back() = border;
  const std::string scale = " " + std::to_string(kColumns - 2) + " x 0.1 m ";
  lines.back().replace(2, scale.size(), scale);
  const auto put = [&](const Eigen::Vector2d& point, char letter) {
    const Eigen::Vector2d from_robot = point - place_.head<2>();
    const long row = static_cast<long>(kRows / 2) - std::lround(from_robot.x() / kRow_m);
    const long column = static_cast<long>(kColumns / 2) - std::lround(from_robot.y() / kColumn_m);
    if (row < 1 || row + 1 >= static_cast<long>(kRows) || column < 1 ||
        column + 1 >= static_cast<long>(kColumns))
      return;
    lines[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)] = letter;
  };
  for (const Eigen::Vector2d& point : trail_) put(point, '.');
  put(start_, 'o');
  put(place_.head<2>(), lies ? 'x' : arrow(place_.z()));
  return lines;
}

void put_beside(std::vector<std::string>& lines, std::size_t first_line, std::size_t column,
                const std::vector<std::string>& block) {
  for (std::size_t i = 0; i < block.size() && first_line + i < lines.size(); ++i) {
    std::string& line = lines[first_line + i];
    line.resize(column, ' ');
    line += block[i];
  }
}

}  // namespace koboshi::tools
