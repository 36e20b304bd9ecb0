#include "firmware/app/calibration.h"

#include <iterator>

namespace koboshi::app {
namespace {

constexpr int kFinerBits = 16;  // of an Angle, 2^-32 turn, beyond the 2^-16 turn of the objects

}  // namespace

void change_trim(robot::Drive& drive, std::int16_t from, std::int16_t to) {
  const std::int32_t change_raw = (std::int32_t{to} - from) * (1 << kFinerBits);
  drive.zero = fixed::Angle::from_raw(static_cast<std::int32_t>(
      static_cast<std::uint32_t>(drive.zero.raw()) + static_cast<std::uint32_t>(drive.sign * change_raw)));
}

robot::Rotation mounted(const robot::Rotation& R_BI, const std::int16_t (&mounting)[3]) {
  constexpr robot::Direction kAxes[] = {robot::kAxisX, robot::kAxisY, robot::kAxisZ};
  robot::Rotation R = R_BI;
  for (std::size_t i = 0; i < std::size(mounting); ++i) {
    const auto angle = fixed::Angle::from_raw(std::int32_t{mounting[i]} * (1 << kFinerBits));
    R = robot::rotation_about(kAxes[i], angle) * R;
  }
  return R;
}

}  // namespace koboshi::app
