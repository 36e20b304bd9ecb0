#include "tools/motion_edit/mirror.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <vector>

#include "base/edit/yaml_places.h"
#include "base/text/text.h"
#include "base/yaml/yaml_tree.h"
#include "simulation/motion_language/parse/expression.h"
#include "simulation/motion_language/parse/sensors.h"
#include "tools/motion_edit/sensor_text.h"

namespace koboshi::tools {
namespace {

using simulation::JointNames;
using simulation::Sensor;

std::string other_side(const std::string& name) {
  if (name.starts_with("left_")) return "right_" + name.substr(5);
  if (name.starts_with("right_")) return "left_" + name.substr(6);
  return name;
}

std::string negated(std::string number) {
  if (number.starts_with('-')) return number.substr(1);
  const auto value = koboshi::parse_number(number);
  if (!value || *value == 0.0) return number;
  if (number.starts_with('+')) number.erase(0, 1);
  return "-" + number;
}

class Mirror {
 public:
  Mirror(const std::string& text, const JointNames& joints, const std::optional<std::string>& name)
      : text_(text), joints_(joints), name_(name) {}

  std::string mirror(const YamlPlace& root) {
    for (const YamlPlace& item : root.items) {
      if (item.key == "name") mirror_name(item);
      if (item.key == "joints") mirror_names(item);
      if (item.key == "steps") mirror_steps(item);
      if (item.key == "poses") {
        for (const YamlPlace& pose : item.items) mirror_pose(pose);
      }
      if (item.key == "routines") {
        for (const YamlPlace& routine : item.items) mirror_steps(routine);
      }
    }
    return apply();
  }

 private:
  struct Edit {
    std::size_t begin;
    std::size_t end;
    std::string text;
  };

  std::string value_of(const YamlPlace& place) const {
    return text_.substr(place.begin, place.end - place.begin);
  }

  void replace(const YamlPlace& place, std::string text) {
    edits_.push_back({place.begin, place.end, std::move(text)});
  }
  void rename(const YamlPlace& place, const std::string& key) {
    if (key != place.key) edits_.push_back({place.key_begin, place.key_end, key});
  }
  void negate(const YamlPlace& place) { replace(place, negated(value_of(place))); }

  std::string apply() {
    std::sort(edits_.begin(), edits_.end(), [](const Edit& a, const Edit& b) { return a.begin < b.begin; });
    std::string result;
    std::size_t done = 0;
    for (const Edit& edit : edits_) {
      result += text_.substr(done, edit.begin - done) + edit.text;
      done = edit.end;
    }
    return result + text_.substr(done);
  }

  void mirror_name(const YamlPlace& place) {
    if (!name_) return replace(place, exchange_left_and_right(value_of(place)));
    std::string quoted = "\"";
    for (const char letter : *name_) {
      if (letter == '"' || letter == '\\') quoted += '\\';
      quoted += letter == '\n' ? std::string("\\n") : std::string(1, letter);
    }
    const bool plain = simulation::is_identifier(*name_);
    replace(place, plain ? *name_ : quoted + "\"");
  }

  // The mirror image of a joint's or a group's name. One without side stands for both sides.
  std::string mirrored_name(const std::string& name) const {
    const std::string other = other_side(name);
    const auto joint = joints_.find(name);
    if (!joint || joints_.find(other) == joints_.mirror(*joint)) return other;  // keeps roles as roles
    return joints_.name(joints_.mirror(*joint));
  }
  // Whether the angle of this joint changes its sign. That of a name without side does not: it is the left
  // joint's, and the right one was its mirror image.
  bool changes_sign(const std::string& name) const {
    const auto joint = joints_.find(name);
    return joint && joints_.mirror_sign(*joint) < 0;
  }

  void mirror_names(const YamlPlace& list) {
    for (const YamlPlace& item : list.items) replace(item, mirrored_name(value_of(item)));
  }

  void mirror_target(const YamlPlace& target) {
    for (const YamlPlace& item : target.items) {
      if (item.key == "y_mm" || item.key == "roll_deg" || item.key == "yaw_deg") negate(item);
    }
  }

  void mirror_pose(const YamlPlace& pose) {
    for (const YamlPlace& item : pose.items) {
      if (item.key == "others" || item.key == "from" || item.key == "mirror") continue;
      if (item.key == "support") {
        const std::string side = value_of(item);
        replace(item, side == "left" ? "right" : side == "right" ? "left" : side);
      } else if (item.is_map()) {
        rename(item, other_side(item.key));
        mirror_target(item);
      } else {
        rename(item, mirrored_name(item.key));
        if (changes_sign(item.key)) negate(item);
      }
    }
  }

  void mirror_steps(const YamlPlace& list) {
    for (const YamlPlace& step : list.items) {
      for (const YamlPlace& item : step.items) mirror_step_item(item);
    }
  }

  void mirror_step_item(const YamlPlace& item) {
    const std::string& key = item.key;
    if (key == "pose" && item.is_map()) mirror_pose(item);
    if (key == "lean") mirror_target(item);
    if (key == "expect") mirror_expect(item);
    if (key == "stiffness" || key == "gain" || key == "during") mirror_keys(item);
    if (key == "torque_off") mirror_names(item);
    if (key == "mix") mirror_mix(item);
    if (key == "if") mirror_value(item);
    if (key == "then" || key == "else") mirror_steps(item);
    if (key == "loop" || key == "wait") mirror_condition(item);
    if (key == "branch" || key == "await") mirror_tests(item);
    if (key == "set") {
      for (const YamlPlace& value : item.items) mirror_value(value);
    }
  }

  void mirror_keys(const YamlPlace& map) {
    for (const YamlPlace& item : map.items) rename(item, mirrored_name(item.key));
  }

  void mirror_expect(const YamlPlace& map) {
    mirror_target(map);
    for (const YamlPlace& item : map.items) {
      if (item.key == "up" && item.items.size() == 3) negate(item.items[1]);
    }
  }

  void mirror_mix(const YamlPlace& map) {
    for (const YamlPlace& joint : map.items) {
      rename(joint, mirrored_name(joint.key));
      // A name without its side already gives the right joint the mirror image of the gains.
      if (!joints_.find(joint.key)) continue;
      for (const YamlPlace& gain : joint.items) {
        const bool is_source = gain.key != "limit_deg";
        const bool about_y = gain.key == "pitch_rate" || gain.key == "pitch";
        if (is_source && changes_sign(joint.key) == about_y) negate(gain);
      }
    }
  }

  void mirror_condition(const YamlPlace& map) {
    for (const YamlPlace& item : map.items) {
      if (item.key == "steps") mirror_steps(item);
      if (item.key == "while" || (item.key == "until" && value_of(item) != "stopped")) mirror_value(item);
    }
  }

  void mirror_tests(const YamlPlace& map) {
    for (const YamlPlace& item : map.items) {
      if (!item.is_list()) continue;
      for (const YamlPlace& test : item.items) mirror_value(test);
    }
  }

  void mirror_value(const YamlPlace& place) { replace(place, mirror_expression(value_of(place), joints_)); }

  const std::string& text_;
  const JointNames& joints_;
  const std::optional<std::string>& name_;
  std::vector<Edit> edits_;
};

}  // namespace

std::string exchange_left_and_right(const std::string& name) {
  std::string result;
  for (std::size_t i = 0; i < name.size();) {
    const bool begins = i == 0 || std::isalpha(static_cast<unsigned char>(name[i - 1])) == 0;
    const auto is_word = [&](std::string_view word) {
      const std::size_t end = i + word.size();
      return begins && name.compare(i, word.size(), word) == 0 &&
             (end >= name.size() || std::isalpha(static_cast<unsigned char>(name[end])) == 0);
    };
    if (is_word("left")) {
      result += "right";
      i += 4;
    } else if (is_word("right")) {
      result += "left";
      i += 5;
    } else {
      result += name[i++];
    }
  }
  return result;
}

std::string mirror_expression(std::string_view text, const JointNames& joints) {
  return replace_sensors(text, [&](const Sensor& sensor, std::string_view joint_name) {
    SensorText image{.sensor = std::string(sensor.name), .joint = std::string(joint_name)};
    image.is_opposite = sensor.mirror == Sensor::Mirror::kOpposite;
    if (sensor.mirror == Sensor::Mirror::kOtherSide) image.sensor = other_side(image.sensor);
    if (const auto joint = joints.find(joint_name)) {
      image.joint = joints.name(joints.mirror(*joint));
      image.is_opposite = joints.mirror_sign(*joint) < 0;
    }
    return image;
  });
}

std::string mirror_motion(const std::filesystem::path& source, const std::string& text,
                          const JointNames& joints, const std::optional<std::string>& name) {
  static_cast<void>(parse_yaml(text, source));
  return Mirror(text, joints, name).mirror(locate_yaml(text, source));
}

}  // namespace koboshi::tools
