#include "tools/motion_files/convert.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "base/text/error.h"
#include "base/text/text.h"
#include "base/text/user_units.h"
#include "firmware/fixed/host/convert.h"
#include "tools/motion_files/limit_clamp.h"
#include "tools/motion_files/motion_text.h"

namespace koboshi::tools {
namespace {

constexpr std::int64_t kFirstMove_us = 1'000'000;
constexpr std::int64_t kShortestMove_us = 1'000;
constexpr std::int64_t kLongestStep_us = 60'000'000;
constexpr double kCubicPeakRatio = 1.5;  // peak to mean speed of a cubic from rest to rest
constexpr std::size_t kMaxPoses = 512;
// Half a step of a 12-bit encoder: what a frame may differ from a straight move and be left out.
constexpr double kSameAngle_rad = std::numbers::pi / 4096.0;

using Angles = std::vector<std::optional<double>>;  // by joint of the robot, rad

struct Move {
  std::string place;
  std::int64_t move_us = 0;
  bool by_speed = false;
  bool at_least = false;  // written as the least time
  std::int64_t pause_us = 0;
  Angles angles;                 // what the frame says
  std::set<std::size_t> limp{};  // joints without torque from here on
  std::optional<motion::LeanDeclaration> lean{};
};

bool same_lean(const Move& a, const Move& b) {
  const auto lean_of = [](const Move& move) { return move.lean.value_or(motion::LeanDeclaration()); };
  return lean_of(a).pitch == lean_of(b).pitch && lean_of(a).roll == lean_of(b).roll;
}

struct Section {
  int repeat = 1;
  std::vector<Move> moves;
};

double lean_rad(std::int16_t angle) { return std::ldexp(2.0 * std::numbers::pi * angle, -16); }

class Conversion {
 public:
  Conversion(const std::filesystem::path& file, const JointMap& map, const simulation::NamedModel& robot,
             const ConversionOptions& options)
      : file_(file),
        map_(map),
        robot_(robot),
        options_(options),
        clamp_(file, robot, options.largest_clamp_rad) {}

  ConvertedMotion run(const ForeignMotion& motion) {
    for (const ForeignNote& note : motion.notes) result_.report.push_back(note.place + ": " + note.text);
    for (const ForeignNote& note : map_.notes) result_.report.push_back(note.place + ": " + note.text);
    Angles last(robot_.joint_names.size());
    for (const ForeignSection& foreign : motion.sections) {
      Section section{.repeat = foreign.repeat, .moves = {}};
      for (const ForeignFrame& frame : foreign.frames) add(frame, section);
      if (!motion.is_smooth) leave_out_straight(section);
      set_times(section, last, motion.is_smooth);
      sections_.push_back(std::move(section));
    }
    write(motion);
    result_.clamped = clamp_.count();
    return std::move(result_);
  }

 private:
  void report(const std::string& place, const std::string& text) {
    result_.report.push_back(place + ": " + text);
  }

  void add(const ForeignFrame& frame, Section& section) {
    ++result_.frames;
    result_.original_s += 1e-6 * static_cast<double>((frame.move_us + frame.pause_us) * section.repeat);
    Move move{.place = frame.place,
              .move_us = frame.move_us,
              .by_speed = frame.by_speed,
              .pause_us = frame.pause_us,
              .angles = Angles(robot_.joint_names.size()),
              .lean = frame.lean};
    for (std::size_t i = 0; i < map_.joints.size(); ++i) {
      if (!map_.joints[i] || !frame.values[i]) continue;
      const MappedJoint& mapped = *map_.joints[i];
      move.angles[mapped.joint] =
          clamp_(mapped.joint, mapped.sign * (*frame.values[i] - mapped.zero) * mapped.unit_rad, frame.place,
                 result_.report);
    }
    for (const std::size_t i : frame.without_torque) {
      if (map_.joints[i]) move.limp.insert(map_.joints[i]->joint);
    }
    section.moves.push_back(std::move(move));
  }

  // Leaves out frames that lie on the straight line between the last one that stays and their successor, as
  // tables of a whole trajectory have them.
  void leave_out_straight(Section& section) {
    std::vector<Move> kept;
    std::vector<Move> between;
    for (std::size_t i = 0; i < section.moves.size(); ++i) {
      Move move = section.moves[i];
      for (const Move& skipped : between) move.move_us += skipped.move_us;
      const bool last = i + 1 == section.moves.size();
      if (!kept.empty() && !last && move.pause_us == 0 && section.moves[i].limp == kept.back().limp &&
          same_lean(section.moves[i], kept.back())) {
        between.push_back(section.moves[i]);
        if (all_on_line(kept.back(), between, section.moves[i + 1])) continue;
        between.pop_back();
      }
      result_.left_out += between.size();
      between.clear();
      kept.push_back(std::move(move));
    }
    section.moves = std::move(kept);
  }

  static bool all_on_line(const Move& from, const std::vector<Move>& between, const Move& to) {
    double whole = static_cast<double>(to.move_us);
    for (const Move& move : between) whole += static_cast<double>(move.move_us);
    if (from.pause_us != 0 || whole <= 0.0) return false;
    double elapsed = 0.0;
    for (const Move& move : between) {
      elapsed += static_cast<double>(move.move_us);
      for (std::size_t joint = 0; joint < move.angles.size(); ++joint) {
        const bool known = from.angles[joint] && move.angles[joint] && to.angles[joint];
        if (!known && !(!from.angles[joint] && !move.angles[joint] && !to.angles[joint])) return false;
        if (!known) continue;
        const double line_rad =
            *from.angles[joint] + elapsed / whole * (*to.angles[joint] - *from.angles[joint]);
        if (std::abs(line_rad - *move.angles[joint]) > kSameAngle_rad) return false;
      }
    }
    return true;
  }

  void set_times(Section& section, Angles& last, bool smooth) {
    for (Move& move : section.moves) {
      const bool first = !begun_;
      begun_ = true;
      if (first && move.move_us < kFirstMove_us) {
        report(move.place,
               fmt::format("the first move takes 1 s instead of {} s, because it may begin anywhere",
                           seconds(move.move_us)));
        move.move_us = kFirstMove_us;
      }
      std::int64_t needed_us = 0;
      std::size_t slowest = 0;
      for (std::size_t joint = 0; joint < move.angles.size(); ++joint) {
        if (!move.angles[joint]) continue;
        if (last[joint]) {
          const double speed = kUsableSpeed * fixed::to_double(robot_.model.joints[joint].max_speed) /
                               (smooth ? kCubicPeakRatio : 1.0);
          const auto time_us = static_cast<std::int64_t>(
              std::ceil(1e6 * std::abs(*move.angles[joint] - *last[joint]) / speed));
          if (time_us > needed_us) slowest = joint;
          needed_us = std::max(needed_us, time_us);
        }
        last[joint] = move.angles[joint];
      }
      // A move that the language's own check lets pass is fast enough.
      const auto limit_us = static_cast<std::int64_t>(kUsableSpeed * static_cast<double>(needed_us));
      // A frame by speed is as fast as its author wanted it, or as the servos can.
      move.at_least =
          move.by_speed && !options_.retime && !smooth && needed_us > 0 && move.move_us < limit_us;
      if (move.at_least) {
        report(move.place,
               fmt::format("at least {} s, and as much more as {} needs",
                           seconds(std::max(move.move_us, kShortestMove_us)), robot_.joint_names[slowest]));
        result_.duration_s += 1e-6 * static_cast<double>(section.repeat * (limit_us - move.move_us));
      } else if (needed_us > 0 && move.move_us < (options_.retime ? needed_us : limit_us)) {
        ++result_.too_fast;
        const std::string why = fmt::format(
            "{} would have to move by {:.0f} degrees/s", robot_.joint_names[slowest],
            fixed::to_double(robot_.model.joints[slowest].max_speed) / kRadPerDegree * kUsableSpeed *
                static_cast<double>(needed_us) / std::max<double>(static_cast<double>(move.move_us), 1.0));
        if (options_.retime) {
          ++result_.stretched;
          report(move.place,
                 fmt::format("{} -> {} s, because {}", seconds(move.move_us), seconds(needed_us), why));
          move.move_us = needed_us;
        } else {
          report(move.place, fmt::format("is too fast: {}", why));
        }
      }
      move.move_us = std::max(move.move_us, kShortestMove_us);
      if (move.move_us > kLongestStep_us || move.pause_us > kLongestStep_us)
        throw InputError(file_, 0, move.place + " of more than 60 s", "moves and pauses of at most 60 s");
      result_.duration_s += 1e-6 * static_cast<double>(section.repeat * (move.move_us + move.pause_us));
    }
  }

  // --- The text

  // A name of the motion language has ASCII only.
  static std::string motion_name(const ForeignMotion& motion, const std::filesystem::path& file) {
    for (const std::string& name : {ascii_name(motion.name), ascii_name(file.stem().string())}) {
      if (!name.empty()) return name;
    }
    return "imported";
  }

  static std::string ascii_name(const std::string& text) {
    constexpr std::size_t kMost = 24;
    std::string name;
    for (const char c : text) {
      const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
      if (name.size() < kMost)
        name += letter ? c : name.empty() || name.back() == ' ' ? ' ' : c == '_' || c == '-' ? c : ' ';
    }
    return std::string(trimmed_name(name));
  }

  void write(const ForeignMotion& motion) {
    std::string& text = result_.text;
    std::size_t poses = 0;
    for (const Section& section : sections_) poses += section.moves.size();
    const bool has_angle = std::ranges::any_of(sections_, [](const Section& section) {
      return std::ranges::any_of(section.moves, [](const Move& move) {
        return std::ranges::any_of(move.angles, [](const auto& angle) { return angle.has_value(); });
      });
    });
    if (!has_angle)
      throw InputError(file_, 0, "no angle of a joint of " + one_line(robot_.robot), "at least one");
    if (poses > kMaxPoses)
      throw InputError(file_, 0, fmt::format("{} poses, of which no straight move replaces another", poses),
                       fmt::format("at most {}", kMaxPoses));
    text += fmt::format("# Imported from {}{}, {}.\n", one_line(file_.filename().string()),
                        motion.page > 0 ? fmt::format(", page {}", motion.page) : std::string(),
                        name_of(motion.format));
    text += fmt::format("version: 2\nrobot: {}\nname: {}\n", quoted(robot_.robot),
                        quoted(motion_name(motion, file_)));
    if (motion.is_smooth) text += "interpolation: cubic\n";
    text += "poses:\n";
    std::size_t number = 0;
    std::string steps;
    std::set<std::size_t> limp;
    for (const Section& section : sections_) {
      const bool loops = section.repeat > 1;
      if (loops) steps += fmt::format("  - loop:\n      times: {}\n      steps:\n", section.repeat);
      const std::string indent = loops ? "        " : "  ";
      for (const Move& move : section.moves) write_move(move, ++number, indent, steps, limp);
    }
    text += "steps:\n" + steps;
  }

  void write_move(const Move& move, std::size_t number, const std::string& indent, std::string& steps,
                  std::set<std::size_t>& limp) {
    write_torque(move, indent, steps, limp);
    std::string angles;
    for (std::size_t joint = 0; joint < move.angles.size(); ++joint) {
      if (move.angles[joint])
        angles += fmt::format("{}{}: {}", angles.empty() ? "" : ", ", robot_.joint_names[joint],
                              degrees(*move.angles[joint]));
    }
    if (angles.empty()) {  // the frame only takes its time
      steps += fmt::format("{}- {{wait_s: {}}}\n", indent, seconds(move.move_us + move.pause_us));
      return;
    }
    result_.text += fmt::format("  p{}: {{{}}}\n", number, angles);
    steps += fmt::format("{}- {{pose: p{}, {}: {}", indent, number, move.at_least ? "at_least_s" : "time_s",
                         seconds(move.move_us));
    if (move.pause_us > 0) steps += fmt::format(", pause_s: {}", seconds(move.pause_us));
    if (move.lean)
      steps += fmt::format(", lean: {{pitch_deg: {}, roll_deg: {}}}", degrees(lean_rad(move.lean->pitch)),
                           degrees(lean_rad(move.lean->roll)));
    steps += "}\n";
  }

  void write_torque(const Move& move, const std::string& indent, std::string& steps,
                    std::set<std::size_t>& limp) {
    if (move.limp == limp) return;
    const auto list = [&](const std::set<std::size_t>& joints, const std::set<std::size_t>& others,
                          const char* each) {
      std::string names;
      for (const std::size_t joint : joints) {
        if (!others.contains(joint))
          names += fmt::format("{}{}{}", names.empty() ? "" : ", ", robot_.joint_names[joint], each);
      }
      return names;
    };
    if (const std::string off = list(move.limp, limp, ""); !off.empty())
      steps += fmt::format("{}- {{torque_off: [{}]}}\n", indent, off);
    if (const std::string on = list(limp, move.limp, ": 100"); !on.empty())
      steps += fmt::format("{}- {{stiffness: {{{}}}}}\n", indent, on);
    limp = move.limp;
  }

  const std::filesystem::path& file_;
  const JointMap& map_;
  const simulation::NamedModel& robot_;
  const ConversionOptions& options_;
  LimitClamp clamp_;
  std::vector<Section> sections_;
  bool begun_ = false;
  ConvertedMotion result_;
};

}  // namespace

ConvertedMotion convert_motion(const std::filesystem::path& file, const ForeignMotion& motion,
                               const JointMap& map, const simulation::NamedModel& robot,
                               const ConversionOptions& options) {
  return Conversion(file, map, robot, options).run(motion);
}

}  // namespace koboshi::tools
