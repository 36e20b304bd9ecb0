#pragma once

#include <Eigen/Core>
#include <deque>
#include <string>
#include <vector>

namespace koboshi::tools {

// A small map of the robot's path, seen from above: the world's x axis points up, y to the left. An arrow in
// the middle shows the robot and its heading, `x` a robot that lies, `o` the start, dots the path.
class TrailMap {
 public:
  static constexpr std::size_t kColumns = 19;  // with the frame
  static constexpr std::size_t kRows = 11;
  static constexpr double kColumn_m = 0.1;  // a character is twice as high as wide
  static constexpr double kRow_m = 0.2;

  // Moves the robot to x, y [m] and heading [rad].
  void move_to(const Eigen::Vector3d& place);
  [[nodiscard]] std::vector<std::string> lines(bool lies) const;

 private:
  static constexpr std::size_t kMaxPoints = 2000;  // the oldest are dropped

  std::deque<Eigen::Vector2d> trail_;  // a point each half column
  Eigen::Vector2d start_ = Eigen::Vector2d::Zero();
  Eigen::Vector3d place_ = Eigen::Vector3d::Zero();
};

// Replaces the text right of `column` by a block, from this line on.
void put_beside(std::vector<std::string>& lines, std::size_t first_line, std::size_t column,
                const std::vector<std::string>& block);

}  // namespace koboshi::tools
