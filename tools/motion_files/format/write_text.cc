// Writers of the formats that are texts with key frames and times: Webots, tables, Bit-Bots, Choreonoid.

#include <cmath>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/text/text.h"
#include "base/text/user_units.h"
#include "tools/motion_files/format/writers.h"

namespace koboshi::tools {
namespace {

// The image's angles are finer; motion files have 0.001 degrees.
double rounded(double value, double step) {
  const double result = std::round(value / step) * step;
  return result == 0.0 ? 0.0 : result;
}

std::string row_time(std::int64_t time_us) { return number_text(static_cast<double>(time_us) / 1e6); }

// Rows at times since the start: a pause is a second row with the same values.
struct TimedRow {
  std::int64_t at_us = 0;
  const ForeignFrame* frame = nullptr;
  bool is_pause = false;
};

std::vector<TimedRow> timed_rows(ForeignMotion& motion) {
  std::vector<TimedRow> rows;
  std::int64_t now_us = 0;
  bool has_torque = false;
  for (const ForeignFrame& frame : motion.sections.front().frames) {
    now_us += frame.move_us;
    rows.push_back({now_us, &frame});
    now_us += frame.pause_us;
    if (frame.pause_us > 0) rows.push_back({now_us, &frame, true});
    has_torque = has_torque || !frame.without_torque.empty();
  }
  if (has_torque) motion.notes.push_back({"motion", "the format has no joints without torque; they keep it"});
  return rows;
}

}  // namespace

std::string write_webots(ForeignMotion& motion) {
  std::string text = "#WEBOTS_MOTION,V1.0";
  for (const ForeignJoint& joint : motion.joints) text += "," + joint.name;
  text += "\n";
  std::size_t number = 0;
  bool is_rounded = false;
  for (const TimedRow& row : timed_rows(motion)) {
    const std::int64_t ms = (row.at_us + 500) / 1'000;
    is_rounded = is_rounded || ms * 1'000 != row.at_us;
    text += fmt::format("{:02}:{:02}:{:03},Pose{}", ms / 60'000, ms / 1'000 % 60, ms % 1'000, ++number);
    for (const ForeignValue& value : row.frame->values)
      text += value ? fmt::format(",{:.7f}", rounded(*value, 1e-7)) : ",*";
    text += "\n";
  }
  if (is_rounded) motion.notes.push_back({"motion", "times are rounded to 1 ms"});
  return text;
}

std::string write_csv_motion(ForeignMotion& motion) {
  std::string text = "time_s";
  for (const ForeignJoint& joint : motion.joints) text += "," + joint.name + "_deg";
  text += "\n";
  for (const TimedRow& row : timed_rows(motion)) {
    text += row_time(row.at_us);
    for (const ForeignValue& value : row.frame->values)
      text += value ? fmt::format(",{:.4f}", rounded(*value / kRadPerDegree, 1e-4)) : ",";
    text += "\n";
  }
  return text;
}

std::string write_bit_bots(ForeignMotion& motion) {
  nlohmann::ordered_json document{
      {"name", motion.name}, {"version", ""}, {"author", ""}, {"description", ""}};
  nlohmann::ordered_json frames = nlohmann::ordered_json::array();
  for (const ForeignFrame& frame : motion.sections.front().frames) {
    nlohmann::ordered_json goals = nlohmann::ordered_json::object();
    nlohmann::ordered_json torque = nlohmann::ordered_json::object();
    for (std::size_t joint = 0; joint < motion.joints.size(); ++joint) {
      if (frame.values[joint])
        goals[motion.joints[joint].name] =
            *parse_number(fmt::format("{:.4f}", rounded(*frame.values[joint] / kRadPerDegree, 1e-4)));
    }
    for (const std::size_t joint : frame.without_torque) torque[motion.joints[joint].name] = 0;
    frames.push_back({{"name", "frame " + std::to_string(frames.size() + 1)},
                      {"duration", static_cast<double>(frame.move_us) / 1e6},
                      {"pause", static_cast<double>(frame.pause_us) / 1e6},
                      {"goals", goals},
                      {"torque", torque}});
  }
  document["keyframes"] = frames;
  return document.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

std::string write_pose_seq(ForeignMotion& motion, const std::string& body) {
  const auto quoted = [](const std::string& name) {
    return nlohmann::json(name).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  };
  std::string text =
      "# Body pose sequence format version 1.0\n\ntype: PoseSeq\nname: " + quoted(motion.name) +
      "\ntargetBody: " + quoted(body) + "\nrefs:\n";
  for (const TimedRow& row : timed_rows(motion)) {
    std::string joints;
    std::string angles;
    for (std::size_t joint = 0; joint < motion.joints.size(); ++joint) {
      if (!row.frame->values[joint]) continue;
      joints += (joints.empty() ? "" : ", ") + std::to_string(motion.joints[joint].servo_id.value_or(0));
      angles += fmt::format("{}{:.8f}", angles.empty() ? "" : ", ", rounded(*row.frame->values[joint], 1e-8));
    }
    text += fmt::format(
        "  -\n    time: {}\n    refer:\n      type: Pose\n      name: \"\"\n      joints: [ {} ]\n      q: [ "
        "{} ]\n",
        row_time(row.at_us), joints, angles);
  }
  return text;
}

}  // namespace koboshi::tools
