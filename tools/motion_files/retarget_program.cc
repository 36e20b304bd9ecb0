#include "tools/motion_files/retarget_program.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <set>

#include <fmt/format.h>

#include "base/edit/yaml_document.h"
#include "base/text/error.h"
#include "base/text/text.h"
#include "firmware/fixed/host/convert.h"
#include "simulation/motion_language/compile/speed.h"
#include "simulation/motion_language/parse/joints.h"
#include "simulation/motion_language/parse/poses.h"
#include "tools/motion_edit/sensor_text.h"
#include "tools/motion_files/limit_clamp.h"
#include "tools/motion_files/motion_text.h"
#include "tools/motion_files/retarget.h"

namespace koboshi::tools {
namespace {

using simulation::JointNames;
using simulation::StepSource;
using Kind = StepSource::Kind;
using Angles = std::vector<std::optional<double>>;  // by joint, rad
using Keys = std::vector<std::string>;              // that lead to a value

constexpr double kLongestMove_s = 60.0;

Keys below(Keys keys, const std::string& key) {
  keys.push_back(key);
  return keys;
}

// Calls `visit` for each step of a list and of those within it, with the place in the document. Later steps
// come first, so that a visitor may erase the step.
using StepVisitor = std::function<void(const Keys& place, const YamlNode& node, const StepSource& step)>;

void each_step(const Keys& place, const YamlNode* list, const std::vector<StepSource>& steps,
               const StepVisitor& visit) {
  for (std::size_t i = steps.size(); list != nullptr && i-- > 0;) {
    const Keys item = below(place, std::to_string(i));
    const YamlNode& node = list->items[i];
    if (steps[i].kind == Kind::kLoop) {
      const YamlNode* loop = node.find("loop");
      each_step(below(below(item, "loop"), "steps"), loop->find("steps"), steps[i].body, visit);
    } else if (steps[i].kind == Kind::kIf) {
      each_step(below(item, "else"), node.find("else"), steps[i].otherwise, visit);
      each_step(below(item, "then"), node.find("then"), steps[i].body, visit);
    }
    visit(item, node, steps[i]);
  }
}

void each_step(const YamlNode& root, const simulation::MotionSource& motion, const StepVisitor& visit) {
  each_step({"steps"}, root.find("steps"), motion.steps, visit);
  const YamlNode* routines = root.find("routines");
  for (std::size_t i = 0; i < motion.routines.size(); ++i)
    each_step({"routines", routines->items[i].key}, &routines->items[i], motion.routines[i].steps, visit);
}

std::string scaled(const YamlNode& number, double factor) {
  return factor == 1.0 ? number.scalar
                       : number_text(std::round(1e6 * factor * parse_number(number.scalar).value()) / 1e6);
}

// Gives a move `factor` times its time, and the parts in which single joints turn in proportion, or makes it
// slower by as much. Returns what it changed: "0.4 -> 0.6 s"; nothing for a move with a least time.
std::string slow_down(YamlDocument& document, const std::filesystem::path& file, const Keys& place,
                      const YamlNode& node, const StepSource& step, double factor) {
  const auto set = [&](const std::string& key, const std::string& value) {
    document.set(YamlPath(below(place, key)), value);
  };
  if (step.at_least) return {};
  if (const YamlNode* speed = node.find("speed_deg_per_s")) {
    const std::string slower =
        number_text(std::floor(1e3 * parse_number(speed->scalar).value() / factor) / 1e3);
    set(speed->key, slower);
    return fmt::format("{} -> {} degrees/s", speed->scalar, slower);
  }
  const double time_s = 1e-6 * step.time_us;
  const double longer_s = std::ceil(1e3 * time_s * factor) / 1e3;
  if (longer_s > kLongestMove_s)
    throw InputError(file, 0, fmt::format("a move that the servos can do in {:.0f} s", longer_s),
                     "moves of at most 60 s");
  set("time_s", number_text(longer_s));
  if (const YamlNode* during = node.find("during")) {
    std::string parts;
    for (const YamlNode& part : during->items) {
      const double end_s = parse_number(part.items[1].scalar).value() * longer_s / time_s;
      parts += fmt::format("{}{}: [{}, {}]", parts.empty() ? "" : ", ", part.key,
                           scaled(part.items[0], longer_s / time_s),
                           number_text(std::min(longer_s, std::round(1e6 * end_s) / 1e6)));
    }
    set("during", '{' + parts + '}');
  }
  return fmt::format("{} -> {} s", seconds(step.time_us), number_text(longer_s));
}

std::string name_of(const simulation::PoseSource& pose) {
  return pose.name.empty() ? fmt::format("line {}", pose.place.line) : "pose " + one_line(pose.name);
}

// The numbers of the poses in the order in which the program reaches them; then those that it does not reach.
class PoseOrder {
 public:
  explicit PoseOrder(const simulation::MotionSource& motion) : motion_(motion) {
    walk(motion.steps);
    for (std::size_t pose = 0; pose < motion.poses.size(); ++pose) add(pose);
  }
  const std::vector<std::size_t>& poses() const { return poses_; }

 private:
  void add(std::size_t pose) {
    if (known_.insert(pose).second) poses_.push_back(pose);
  }

  void walk(const std::vector<StepSource>& steps) {
    for (const StepSource& step : steps) {
      if (step.kind == Kind::kMove) add(step.pose);
      walk(step.body);
      walk(step.otherwise);
      if (step.kind != Kind::kCall || !called_.insert(step.label).second) continue;
      for (const simulation::RoutineSource& routine : motion_.routines) {
        if (routine.name == step.label) walk(routine.steps);
      }
    }
  }

  const simulation::MotionSource& motion_;
  std::vector<std::size_t> poses_;
  std::set<std::size_t> known_;
  std::set<std::string> called_;
};

class ProgramRetargeter {
 public:
  ProgramRetargeter(const simulation::MotionFile& file, const RetargetRobot& from, const RetargetRobot& to,
                    const ConversionOptions& options)
      : file_(file),
        from_(from),
        to_(to),
        options_(options),
        from_names_(from.model),
        to_names_(to.model),
        document_(file.path, file.text) {
    simulation::Diagnostics messages(file.path, file.text);
    motion_ = simulation::parse_motion(file, from.model, messages);
    messages.throw_errors();
  }

  RetargetedMotion run(bool by_targets) {
    solve(by_targets);
    const YamlNode root = document_.tree();
    set({"robot"}, quoted(to_.model.robot));
    each_step(root, motion_, [this](const Keys& place, const YamlNode& node, const StepSource& step) {
      edit_step(place, node, step);
    });
    if (document_.tree().find("steps")->items.empty())
      refuse(root.find("steps")->line,
             "steps that all are about joints which " + to_.description.name + " lacks");
    edit_poses(root);
    edit_allowed(root);
    set_times();
    result_.text = fmt::format("# Retargeted from {}, a motion of {}.\n",
                               one_line(file_.path.filename().string()), from_.model.robot) +
                   document_.text();
    return std::move(result_);
  }

 private:
  [[noreturn]] void refuse(int line, const std::string& found) const {
    throw InputError(file_.path, line, found, "a motion of joints that both robots have");
  }
  void note(int line, const std::string& text) {
    result_.report.push_back(fmt::format("line {}: {}", line, text));
  }
  void set(const Keys& place, const std::string& value) { document_.set(YamlPath(place), value); }
  void erase(const Keys& place) { document_.erase(YamlPath(place)); }

  // --- Poses

  void solve(bool by_targets) {
    ForeignMotion frames;
    frames.sections.emplace_back();
    for (const std::string& name : from_.model.joint_names) frames.joints.push_back({.name = name});
    const std::vector<std::size_t> order = PoseOrder(motion_).poses();
    for (const std::size_t pose : order) {
      const simulation::PoseSource& source = motion_.poses[pose];
      ForeignFrame frame{.place = name_of(source)};
      for (const auto& angle : source.angles)
        frame.values.push_back(angle ? std::optional(fixed::to_double(*angle)) : std::nullopt);
      frames.sections[0].frames.push_back(std::move(frame));
    }
    const JointMap map = retarget_joints(file_.path, frames, from_.description, to_.description, by_targets);
    counterparts_ = map.joints;
    if (by_targets) frames = retarget_targets(file_.path, frames, from_, to_);
    for (const ForeignNote& told : by_targets ? frames.notes : map.notes)
      result_.report.push_back(told.place + ": " + told.text);
    LimitClamp clamp(file_.path, to_.model, options_.largest_clamp_rad);
    angles_.assign(motion_.poses.size(), Angles(to_names_.count()));
    for (std::size_t i = 0; i < order.size(); ++i) {
      const ForeignFrame& frame = frames.sections[0].frames[i];
      Angles& angles = angles_[order[i]];
      for (std::size_t joint = 0; joint < frame.values.size(); ++joint) {
        if (!frame.values[joint]) continue;
        const std::optional<MappedJoint> mapped = by_targets ? MappedJoint{joint, 1.0} : map.joints[joint];
        if (mapped)
          angles[mapped->joint] =
              clamp(mapped->joint, mapped->sign * *frame.values[joint], frame.place, result_.report);
      }
    }
  }

  static bool is_empty(const Angles& angles) {
    return std::ranges::none_of(angles, [](const auto& angle) { return angle.has_value(); });
  }

  // A pose of all joints has the further joints of the other robot at zero, where they can be.
  bool takes_all(const simulation::PoseSource& pose, const Angles& angles) const {
    if (!std::ranges::all_of(pose.angles, [](const auto& angle) { return angle.has_value(); })) return false;
    for (std::size_t joint = 0; joint < angles.size(); ++joint) {
      const robot::Joint& limits = to_.model.model.joints[joint];
      if (!angles[joint] && robot::clamp_to_limits(limits, fixed::Angle()) != fixed::Angle()) return false;
    }
    return true;
  }

  std::string pose_text(const simulation::PoseSource& pose, const Angles& angles) const {
    const bool is_whole = takes_all(pose, angles) && !has_list_;
    std::string text = is_whole ? "others: zero" : "";
    for (std::size_t joint = 0; joint < angles.size(); ++joint) {
      if (!angles[joint]) continue;
      std::string name = to_names_.name(joint);
      const std::string value = degrees(*angles[joint]);
      if (is_whole && value == "0") continue;
      const std::size_t other = to_names_.mirror(joint);
      // Both sides in one, where they are mirror images.
      const auto is_image = [&](std::size_t a, std::size_t b) {
        return angles[b] && degrees(*angles[b]) == degrees(to_names_.mirror_sign(a) * *angles[a]);
      };
      if (other != joint && name.starts_with("right_") && to_names_.find_left(name.substr(6)) == other &&
          angles[other] && is_image(other, joint))
        continue;
      if (other != joint && name.starts_with("left_") && to_names_.find_left(name.substr(5)) == joint &&
          is_image(joint, other))
        name = name.substr(5);
      text += fmt::format("{}{}: {}", text.empty() ? "" : ", ", name, value);
    }
    return '{' + text + '}';
  }

  void edit_poses(const YamlNode& root) {
    const YamlNode* poses = root.find("poses");
    if (poses == nullptr) return;
    for (std::size_t i = poses->items.size(); i-- > 0;) {
      const simulation::PoseSource& pose = motion_.poses[i];
      const Keys place{"poses", pose.name};
      if (is_empty(angles_[i])) {
        erase(place);
      } else {
        set(place, pose_text(pose, angles_[i]));
      }
    }
    if (document_.tree().find("poses")->items.empty()) erase({"poses"});
  }

  void edit_allowed(const YamlNode& root) {
    const YamlNode* joints = root.find("joints");
    if (joints == nullptr) return;
    const std::string names = list_of(*joints);
    if (names.empty()) refuse(joints->line, "joints that " + to_.description.name + " lacks");
    set({"joints"}, '[' + names + ']');
  }

  // --- Joints by name

  std::uint32_t counterparts(std::uint32_t joints) const {
    std::uint32_t mapped = 0;
    for (std::size_t i = 0; i < counterparts_.size(); ++i) {
      if ((joints >> i & 1u) != 0 && counterparts_[i]) mapped |= 1u << counterparts_[i]->joint;
    }
    return mapped;
  }

  // The names under which the other robot has the joints of a name or group.
  std::vector<std::string> names_of(const std::string& name) const {
    const std::uint32_t joints = counterparts(from_names_.mask(name));
    const std::uint32_t all = counterparts(~0u);
    if (joints != 0 && (to_names_.mask(name) & all) == joints) return {name};
    std::vector<std::string> names;
    for (std::size_t i = 0; i < to_names_.count(); ++i) {
      if ((joints >> i & 1u) != 0) names.push_back(to_names_.name(i));
    }
    return names;
  }

  std::string list_of(const YamlNode& list) const {
    std::string text;
    for (const YamlNode& item : list.items) {
      for (const std::string& name : names_of(item.scalar)) text += (text.empty() ? "" : ", ") + name;
    }
    return text;
  }

  // A map by joint, with the values as they are, times `factor`, which lists of numbers have.
  std::string map_of(const YamlNode& map, double factor = 1.0) const {
    std::string text;
    for (const YamlNode& item : map.items) {
      std::string value = item.scalar;
      if (item.kind == YamlNode::Kind::kList)
        value = fmt::format("[{}, {}]", scaled(item.items[0], factor), scaled(item.items[1], factor));
      for (const std::string& name : names_of(item.key))
        text += fmt::format("{}{}: {}", text.empty() ? "" : ", ", name, value);
    }
    return text;
  }

  std::string mix_of(const YamlNode& map) const {
    std::string text;
    for (const YamlNode& item : map.items) {
      const auto joint = from_names_.find(item.key);
      const std::vector<std::string> names = names_of(item.key);
      const bool turns = joint && counterparts_[*joint] && counterparts_[*joint]->sign < 0.0;
      // The gains of a name without side are those of the left joint; both sides would have to be written.
      const auto left = from_names_.find_left(item.key);
      if (!joint && !names.empty() &&
          (names.size() > 1 || (left && counterparts_[*left] && counterparts_[*left]->sign < 0.0)))
        throw InputError(file_.path, item.line,
                         "corrections of " + one_line(item.key) + ", whose joints " + to_.description.name +
                             " has under other names or with another direction",
                         "one for each side");
      for (const std::string& name : names) {
        std::string gains;
        for (const YamlNode& gain : item.items)
          gains +=
              fmt::format("{}{}: {}", gains.empty() ? "" : ", ", gain.key,
                          turns && gain.key != "limit_deg" ? number_text(-parse_number(gain.scalar).value())
                                                           : gain.scalar);
        text += fmt::format("{}{}: {{{}}}", text.empty() ? "" : ", ", name, gains);
      }
    }
    return text;
  }

  // --- Steps

  void edit_step(const Keys& place, const YamlNode& node, const StepSource& step) {
    if (node.kind != YamlNode::Kind::kMap) return;
    if (step.kind == Kind::kMove && is_empty(angles_[step.pose])) return edit_to_wait(place, node, step);
    for (const YamlNode& item : node.items) edit_item(place, node, item, step);
  }

  void edit_to_wait(const Keys& place, const YamlNode& node, const StepSource& step) {
    const std::int64_t time_us = std::int64_t{step.time_us} + step.pause_us;
    note(node.value_line, time_us > 0
                              ? "a move of joints that " + to_.description.name + " lacks is a wait"
                              : "a move of joints that " + to_.description.name + " lacks is left out");
    if (time_us > 0) {
      set(place, fmt::format("{{wait_s: {}}}", seconds(time_us)));
    } else {
      erase(place);
    }
  }

  void edit_item(const Keys& step_place, const YamlNode& node, const YamlNode& item, const StepSource& step) {
    const std::string& key = item.key;
    const Keys place = below(step_place, key);
    if (key == "pose" && item.kind == YamlNode::Kind::kMap) return set(place, inline_pose(node, step));
    const bool is_none = item.kind == YamlNode::Kind::kScalar;  // mix: none
    if (key == "stiffness" || key == "gain" || key == "during") {
      set_or_erase(step_place, item, step, map_of(item), '{', '}');
    } else if (key == "torque_off") {
      set_or_erase(step_place, item, step, list_of(item), '[', ']');
    } else if (key == "mix" && !is_none) {
      set_or_erase(step_place, item, step, mix_of(item), '{', '}');
    } else if (key == "if") {
      edit_expression(place, item);
    } else if (key == "loop" || key == "wait") {
      for (const YamlNode& part : item.items) {
        if (part.key == "while" || (part.key == "until" && part.scalar != "stopped"))
          edit_expression(below(place, part.key), part);
      }
    } else if (key == "branch" || key == "await") {
      for (const YamlNode& part : item.items) {
        for (std::size_t i = 0; part.kind == YamlNode::Kind::kList && i < part.items.size(); ++i)
          edit_expression(below(below(place, part.key), std::to_string(i)), part.items[i]);
      }
    } else if (key == "set") {
      for (const YamlNode& value : item.items) edit_expression(below(place, value.key), value);
    }
  }

  // The pose as the file writes it, of which the step may play the mirror image.
  std::string inline_pose(const YamlNode& node, const StepSource& step) const {
    Angles angles = angles_[step.pose];
    const YamlNode* mirror = node.find("mirror");
    if (mirror != nullptr && mirror->scalar == "true") {
      Angles image(angles.size());
      for (std::size_t i = 0; i < angles.size(); ++i) {
        if (angles[i]) image[to_names_.mirror(i)] = to_names_.mirror_sign(i) * *angles[i];
      }
      angles = std::move(image);
    }
    return pose_text(motion_.poses[step.pose], angles);
  }

  void set_or_erase(const Keys& step_place, const YamlNode& item, const StepSource& step,
                    const std::string& text, char open, char close) {
    if (!text.empty()) return set(below(step_place, item.key), open + text + close);
    note(item.line, item.key + " of joints that " + to_.description.name + " lacks is left out");
    erase(step.kind == Kind::kMove ? below(step_place, item.key) : step_place);
  }

  void edit_expression(const Keys& place, const YamlNode& node) {
    const std::string text =
        replace_sensors(node.scalar, [&](const simulation::Sensor& sensor, std::string_view joint_name) {
          SensorText image{.sensor = std::string(sensor.name), .joint = std::string(joint_name)};
          const auto joint = from_names_.find(joint_name);
          if (joint_name.empty() || !joint) return image;
          if (!counterparts_[*joint])
            refuse(node.value_line, "a condition about " + from_names_.name(*joint) + ", which " +
                                        to_.description.name + " lacks");
          image.joint = to_names_.name(counterparts_[*joint]->joint);
          image.is_opposite = counterparts_[*joint]->sign < 0.0;
          return image;
        });
    if (text != node.scalar) set(place, quoted(text));
  }

  // --- Times

  void set_times() {
    simulation::Diagnostics messages(file_.path, document_.text());
    const YamlNode root = document_.tree();
    const simulation::MotionSource motion = simulation::parse_motion(file_.path, root, to_.model, messages);
    messages.throw_errors();
    const auto speeds = simulation::fastest_joints(motion, to_.model);
    const double limit = options_.retime ? kUsableSpeed : 1.0 + 1e-9;
    std::vector<std::string> lines;
    each_step(root, motion, [&](const Keys& place, const YamlNode& node, const StepSource& step) {
      const auto found = speeds.find(&step);
      if (found == speeds.end() || found->second.share <= limit) return;
      const simulation::FastestJoint& fastest = found->second;
      ++result_.too_fast;
      result_.stretched += options_.retime ? 1 : 0;
      const std::string why = fmt::format("{} would have to move by {:.0f} degrees/s",
                                          to_names_.name(fastest.joint), fastest.rad_per_s / kRadPerDegree);
      const std::string where = "move to " + name_of(motion.poses[step.pose]);
      lines.push_back(options_.retime ? fmt::format("{}: {}, because {}", where,
                                                    slow_down(document_, file_.path, place, node, step,
                                                              fastest.share / kUsableSpeed),
                                                    why)
                                      : fmt::format("{}: is too fast: {}", where, why));
    });
    result_.report.insert(result_.report.end(), lines.rbegin(), lines.rend());
  }

  const simulation::MotionFile& file_;
  const RetargetRobot& from_;
  const RetargetRobot& to_;
  const ConversionOptions& options_;
  JointNames from_names_;
  JointNames to_names_;
  YamlDocument document_;
  simulation::MotionSource motion_;
  bool has_list_ = document_.tree().find("joints") != nullptr;  // of the joints that the motion may move
  std::vector<std::optional<MappedJoint>> counterparts_;        // by joint of `from`
  std::vector<Angles> angles_;                                  // by pose
  RetargetedMotion result_;
};

}  // namespace

RetargetedMotion retarget_program(const simulation::MotionFile& file, const RetargetRobot& from,
                                  const RetargetRobot& to, bool by_targets,
                                  const ConversionOptions& options) {
  return ProgramRetargeter(file, from, to, options).run(by_targets);
}

void slow_down_move(RetargetedMotion& motion, const std::filesystem::path& file,
                    const simulation::NamedModel& robot, int line, int column, double factor) {
  YamlDocument document(file, motion.text);
  simulation::Diagnostics messages(file, motion.text);
  const YamlNode root = document.tree();
  const simulation::MotionSource source = simulation::parse_motion(file, root, robot, messages);
  messages.throw_errors();
  each_step(root, source, [&](const Keys& place, const YamlNode& node, const StepSource& step) {
    if (step.kind != Kind::kMove || step.place.line != line || step.place.column != column) return;
    const std::string change = slow_down(document, file, place, node, step, factor);
    if (!change.empty())
      motion.report.push_back(
          fmt::format("move to {}: {}, as the check needs it", name_of(source.poses[step.pose]), change));
  });
  motion.text = document.text();
}

}  // namespace koboshi::tools
