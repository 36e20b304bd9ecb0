#pragma once

#include <filesystem>
#include <string>

#include "tools/motion_files/format/foreign_motion.h"

namespace koboshi::tools {

// Writers of the formats. Each takes a motion of one section, with values in the format's unit and only
// joints that the motion moves, and adds to its notes what the format cannot say. `body` names the robot.
[[nodiscard]] std::string write_webots(ForeignMotion& motion);
[[nodiscard]] std::string write_csv_motion(ForeignMotion& motion);
[[nodiscard]] std::string write_bit_bots(ForeignMotion& motion);
[[nodiscard]] std::string write_pose_seq(ForeignMotion& motion, const std::string& body);
[[nodiscard]] std::string write_roboplus_text(ForeignMotion& motion);
// A file of 256 pages. Throws InputError, naming `file`, for a motion that does not fit.
[[nodiscard]] std::string write_roboplus_pages(const std::filesystem::path& file, ForeignMotion& motion);

}  // namespace koboshi::tools
