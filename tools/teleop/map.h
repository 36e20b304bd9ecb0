#pragma once

#include <Eigen/Core>
#include <deque>
#include <string>
#include <vector>

namespace koboshi::tools {

// A small map of where the robot has been, seen from above: the world's x axis, to which it headed at first,
// points up, y to the left. The robot is in the middle, an arrow of its heading; `x` where it lies. `o` is
// where it began, dots are its way.
class TrailMap {
 public:
  static constexpr std::size_t kColumns = 19;  // with the frame
  static constexpr std::size_t kRows = 11;
  static constexpr double kColumn_m = 0.1;  // a letter is twice as high as it is wide
  static constexpr double kRow_m = 0.2;

  // Where the robot is now: x, y [m] and heading [rad].
  void move_to(const Eigen::Vector3d& place);
  [[nodiscard]] std::vector<std::string> lines(bool lies) const;

 private:
  static constexpr std::size_t kMaxPoints = 2000;  // the oldest are forgotten

  std::deque<Eigen::Vector2d> trail_;  // a point each half column; the first is where it began
  Eigen::Vector2d start_ = Eigen::Vector2d::Zero();
  Eigen::Vector3d place_ = Eigen::Vector3d::Zero();
};

// Puts a block of text to the right of others, from this line on. What stands there is cut off.
void put_beside(std::vector<std::string>& lines, std::size_t first_line, std::size_t column,
                const std::vector<std::string>& block);

}  // namespace koboshi::tools
