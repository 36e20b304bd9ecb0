#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/motion/instructions.h"

namespace koboshi::tools {

// The formats of other makers' motion files, as docs/reference/motion-import.md describes them.
enum class MotionFormat {
  kWebots,         // Webots, `.motion`
  kCsv,            // a table with a column for time
  kBitBots,        // animation of the Bit-Bots, JSON
  kBold,           // motion script of bold-humanoid, JSON
  kPoseSeq,        // Choreonoid, `.pseq`
  kRoboplusText,   // ROBOTIS RoboPlus Motion, `.mtn`
  kRoboplusPages,  // ROBOTIS, `motion_*.bin`: 256 pages
  kRoboplusXml,    // ROBOTIS R+ Motion, `.mtnx`
  kKondo,          // KONDO HeartToHeart4, `.h4p`
};

// The name of a format for messages: "a motion of Webots".
[[nodiscard]] std::string name_of(MotionFormat format);

// A servo or joint of a foreign robot, by the name or the number that the file gives it.
struct ForeignJoint {
  std::string name;               // for messages and maps: "l_knee", "servo 13"
  std::optional<int> servo_id{};  // of files that number their servos, or joints
};

// A joint's value in the file's unit and convention; nothing: the joint keeps its target.
using ForeignValue = std::optional<double>;

struct ForeignFrame {
  std::string place;                          // in the file, for messages: "line 12", "page 4, step 2"
  std::int64_t move_us = 0;                   // from the end of the frame before
  bool by_speed = false;                      // the file says how fast, of which `move_us` follows
  std::int64_t pause_us = 0;                  // afterwards
  std::vector<ForeignValue> values{};         // by joint of the file
  std::vector<std::size_t> without_torque{};  // joints whose torque is off from here on
  // Declared for the end of the frame, of motions of the motion language only.
  std::optional<motion::LeanDeclaration> lean{};
};

// Frames that are played one after the other, several times.
struct ForeignSection {
  int repeat = 1;
  std::vector<ForeignFrame> frames{};
};

// Something in the file that was read in another way than it stands there, or was ignored.
struct ForeignNote {
  std::string place;
  std::string text;
};

struct ForeignMotion {
  enum class Unit { kRadians, kTicks };

  MotionFormat format = MotionFormat::kWebots;
  int page = 0;        // of a file with pages, from 1
  std::string name{};  // as in the file; may be empty
  Unit unit = Unit::kRadians;
  bool is_smooth = false;  // moves do not stop at each frame
  std::vector<ForeignJoint> joints{};
  std::vector<ForeignSection> sections{};
  std::vector<ForeignNote> notes{};
};

// Recognises a format by its content. Empty if it is none of these.
[[nodiscard]] std::optional<MotionFormat> recognise(std::string_view bytes);

}  // namespace koboshi::tools
