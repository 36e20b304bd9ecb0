#include "tests/unit/sim_board/description/recorded_robots.h"

#include <tinyxml2.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <random>
#include <utility>

#include "base/text/text.h"
#include "tests/unit/sim_board/description/small_robot.h"

namespace koboshi::sim_board {
namespace {

using tinyxml2::XMLElement;

// Draws values as texts. Only the generator itself is the same in every standard library, not its
// distributions. A statement draws once, because compilers order the operands of + as they like.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : generator_(seed) {}

  std::size_t below(std::size_t count) { return static_cast<std::size_t>(generator_() % count); }
  bool one_in(std::size_t count) { return below(count) == 0; }
  const std::string& pick(const std::vector<std::string>& of) { return of[below(of.size())]; }
  template <class Value>
  void shuffle(std::vector<Value>& values) {
    for (std::size_t i = values.size(); i > 1; --i) std::swap(values[i - 1], values[below(i)]);
  }

  // Exactly this many decimal digits.
  std::string digits(int count) {
    std::string text;
    for (int i = 0; i < count; ++i) text += static_cast<char>('0' + below(10));
    return text;
  }
  std::string sign() { return one_in(2) ? "-" : ""; }
  // Up to 0.2 m to either side.
  std::string length() {
    if (one_in(4)) return "0";
    std::string text = sign() + "0.";
    if (one_in(4)) return text + digits(3) + "e-1";
    text += std::to_string(below(2));
    return text + (one_in(2) ? digits(15) : digits(5));
  }
  // Less than half a turn, often one that people write.
  std::string angle() {
    static const std::vector<std::string> kUsual{"0",         "-0",       "1.570796",  "1.5707963267948966",
                                                 "-1.570796", "3.141593", "-3.141593", "0.785398"};
    if (one_in(2)) return pick(kUsual);
    std::string text = sign();
    text += std::to_string(below(3)) + ".";
    return text + (one_in(2) ? digits(15) : digits(4));
  }
  std::string pose() {
    std::string text = length();
    for (int i = 1; i < 3; ++i) text += " " + length();
    const bool is_turned = !one_in(3);
    for (int i = 0; i < 3; ++i) text += " " + (is_turned ? angle() : "0");
    return text;
  }
  const std::string& axis() {
    static const std::vector<std::string> kAxes{"1 0 0",
                                                "0 -1 0",
                                                "0 0 1",
                                                "0.6 0.8 0",
                                                "0 -0.28 0.96",
                                                "0.267261 0.534522 0.801784",
                                                "-0.57735 0.57735 0.57735",
                                                "0.7071067811865476 0 0.7071067811865476"};
    return pick(kAxes);
  }
  std::string mass() { return "0.1" + (one_in(2) ? digits(2) : digits(14)); }
  // Diagonal elements from 2e-5 to 3e-5, others of up to 1e-6: always the inertia of a rigid body.
  std::string moment(const std::string& name) {
    if (name[1] == name[2]) return "2." + digits(4) + "e-5";
    const std::string text = sign() + "0.";
    return text + digits(4) + "e-6";
  }

 private:
  std::mt19937_64 generator_;
};

std::string element(const std::string& name, const std::string& attributes, const std::string& content) {
  return "<" + name + attributes + ">" + content + "</" + name + ">\n";
}

std::string attribute(const std::string& name, const std::string& value) {
  return " " + name + "=\"" + value + "\"";
}

const std::string kSurface =
    "<surface><friction><ode><mu>0.7</mu></ode></friction>"
    "<contact><ode><soft_cfm>2e-5</soft_cfm><soft_erp>0.4</soft_erp></ode></contact></surface>";

const std::string kChannel =
    "<noise_density>0</noise_density><bias>0</bias><bandwidth_Hz>98</bandwidth_Hz><range>17</range>"
    "<resolution>0.001</resolution><delay_s>0.001</delay_s>";

// A tree of links with frames in one version of SDF. A pose of a link, joint or frame refers only to earlier
// ones, so that there is no ring; those of parts refer to any.
class SmallTree {
 public:
  SmallTree(int minor, std::uint64_t seed) : minor_(minor), dice_(seed) {}

  std::string text() {
    const std::size_t links = 2 + dice_.below(4);
    for (std::size_t i = 0; i < links; ++i) {
      add_link(i);
      for (std::size_t frames = dice_.below(3); frames > 0; --frames) add_frame();
      if (i > 0) add_joint(i);
    }
    for (std::size_t i = 0; i < links; ++i) add_link_text(i, i == links - 1);
    dice_.shuffle(parts_);
    std::string model = element("koboshi:servo_type", attribute("name", "small"), kServoNumbers);
    for (const std::string& part : parts_) model += part;
    if (dice_.one_in(2)) model += element("pose", "", dice_.pose());
    std::string attributes = attribute("name", "tree");
    if (dice_.one_in(3)) attributes += attribute("placement_frame", dice_.pick(frames_));
    attributes += attribute("canonical_link", canonical_);
    return element("sdf",
                   attribute("version", "1." + std::to_string(minor_)) +
                       attribute("xmlns:koboshi", "https://koboshi.invalid/sdf"),
                   element("model", attributes, model));
  }

 private:
  static std::string link_name(std::size_t i) { return "link_" + std::to_string(i); }

  // The attributes of a pose that refers to a frame.
  std::string reference() {
    const bool is_older = minor_ <= 6 && !dice_.one_in(4);
    return attribute(is_older ? "frame" : "relative_to", dice_.one_in(5) ? "__model__" : dice_.pick(frames_));
  }
  std::string pose() {
    if (dice_.one_in(6)) return "";
    const bool refers = !frames_.empty() && !dice_.one_in(3);
    return element("pose", refers ? reference() : "", dice_.pose());
  }

  // A link or a frame that is attached to it.
  const std::string& body(const std::string& link) { return dice_.pick(attached_.at(link)); }

  void add_link(std::size_t i) {
    poses_.push_back(pose());
    frames_.push_back(link_name(i));
    attached_[link_name(i)] = {link_name(i)};
    link_of_[link_name(i)] = link_name(i);
  }

  void add_frame() {
    const std::string name = "frame_" + std::to_string(frames_.size());
    const std::string base = dice_.one_in(3) ? "" : dice_.pick(frames_);
    const std::string link = base.empty() ? canonical_ : link_of_.at(base);
    parts_.push_back(element(
        "frame", attribute("name", name) + (base.empty() ? "" : attribute("attached_to", base)), pose()));
    frames_.push_back(name);
    attached_[link].push_back(name);
    link_of_[name] = link;
  }

  void add_joint(std::size_t child) {
    const std::string name = "joint_" + std::to_string(child);
    std::string axis_attribute;
    std::string axis_key;
    if (minor_ <= 6 && dice_.one_in(2)) {
      axis_key = element("use_parent_model_frame", "", dice_.pick({"true", "1", "false", "0", "True"}));
    } else if (dice_.one_in(2)) {
      axis_attribute = attribute("expressed_in", dice_.one_in(4) ? "__model__" : dice_.pick(frames_));
    }
    std::string text = pose();
    text += element("parent", "", body(link_name(dice_.below(child))));
    text += element("child", "", body(link_name(child)));
    text +=
        element("axis", "",
                element("xyz", axis_attribute, dice_.axis()) +
                    "<limit><lower>-1.1</lower><upper>2.05</upper><velocity>7</velocity></limit>" + axis_key);
    text += "<koboshi:servo type=\"small\"/><koboshi:encoder bits=\"12\"/>";
    text +=
        "<koboshi:drive node_id=\"" + std::to_string(kNodeShift + 40 - child) + "\" serial_number=\"7\"/>";
    parts_.push_back(element("joint", attribute("name", name) + attribute("type", "revolute"), text));
    frames_.push_back(name);
    link_of_[name] = link_name(child);
  }

  std::string inertial() {
    std::string inertia;
    for (const char* moment : {"ixx", "iyy", "izz"}) inertia += element(moment, "", dice_.moment(moment));
    for (const char* moment : {"ixy", "ixz", "iyz"})
      if (!dice_.one_in(3)) inertia += element(moment, "", dice_.moment(moment));
    std::string text = element("mass", "", dice_.mass()) + element("inertia", "", inertia);
    if (!dice_.one_in(4)) text += element("pose", "", dice_.pose());
    return element("inertial", "", text);
  }

  std::string shape(const std::string& kind, const std::string& name) {
    return element(kind, attribute("name", name),
                   pose() + "<geometry><box><size>0.05 0.06 0.07</size></box></geometry>\n" +
                       (kind == "collision" ? kSurface : ""));
  }

  void add_link_text(std::size_t i, bool has_sensor) {
    std::vector<std::string> parts{inertial(), shape("collision", "box")};
    if (!poses_[i].empty()) parts.push_back(poses_[i]);
    if (dice_.one_in(2)) parts.push_back(shape("visual", "shell"));
    if (has_sensor)
      parts.push_back(element("sensor", attribute("name", "imu") + attribute("type", "imu"),
                              pose() + element("update_rate", "", "1000") +
                                  element("koboshi:gyro", "", kChannel) +
                                  element("koboshi:accelerometer", "", kChannel)));
    dice_.shuffle(parts);
    std::string text;
    for (const std::string& part : parts) text += part;
    parts_.push_back(element("link", attribute("name", link_name(i)), text));
  }

  const int minor_;
  Dice dice_;
  const std::string canonical_ = link_name(0);
  std::vector<std::string> poses_;                            // of the links
  std::vector<std::string> frames_;                           // names of links, joints and frames
  std::map<std::string, std::vector<std::string>> attached_;  // by link: itself and its frames
  std::map<std::string, std::string> link_of_;
  std::vector<std::string> parts_;  // of the model
};

// Changes values, references and the order of a robot's elements. Its links come after their parents, and
// new references lead to earlier links or their joints.
class RobotMutation {
 public:
  RobotMutation(const std::string& text, std::uint64_t seed) : dice_(seed) {
    document_.Parse(text.c_str());
    model_ = document_.RootElement()->FirstChildElement("model");
  }

  std::string text() {
    for (XMLElement* link = first("link"); link; link = link->NextSiblingElement("link")) change_link(*link);
    for (XMLElement* joint = first("joint"); joint; joint = joint->NextSiblingElement("joint"))
      change_joint(*joint);
    shuffle(*model_);
    tinyxml2::XMLPrinter printer;
    document_.Print(&printer);
    return printer.CStr();
  }

 private:
  XMLElement* first(const char* name) { return model_->FirstChildElement(name); }

  // Sets a pose, relative to one of these frames, if there are any.
  void change_pose(XMLElement& owner, const std::vector<std::string>& bases) {
    if (!dice_.one_in(3)) return;
    XMLElement* pose = owner.FirstChildElement("pose");
    if (pose == nullptr) pose = owner.InsertNewChildElement("pose");
    pose->SetText(dice_.pose().c_str());
    if (!bases.empty() && dice_.one_in(2)) pose->SetAttribute("relative_to", dice_.pick(bases).c_str());
  }

  void change_link(XMLElement& link) {
    change_pose(link, bases_);
    bases_.emplace_back(link.Attribute("name"));
    XMLElement* inertial = link.FirstChildElement("inertial");
    change_pose(*inertial, {});
    if (dice_.one_in(3)) inertial->FirstChildElement("mass")->SetText(("0.0" + dice_.digits(3)).c_str());
    if (dice_.one_in(3)) {
      XMLElement* inertia = inertial->FirstChildElement("inertia");
      for (XMLElement* moment = inertia->FirstChildElement(); moment; moment = moment->NextSiblingElement())
        moment->SetText(dice_.moment(moment->Name()).c_str());
    }
    for (const char* kind : {"collision", "visual", "sensor"})
      for (XMLElement* part = link.FirstChildElement(kind); part; part = part->NextSiblingElement(kind))
        change_pose(*part, bases_);
    if (dice_.one_in(2)) shuffle(link);
  }

  void change_joint(XMLElement& joint) {
    const std::string child = joint.FirstChildElement("child")->GetText();
    change_pose(joint, {child, "__model__"});
    if (XMLElement* sensor = joint.FirstChildElement("sensor")) change_pose(*sensor, {});
    if (dice_.one_in(2)) {
      XMLElement* xyz = joint.FirstChildElement("axis")->FirstChildElement("xyz");
      xyz->SetText(dice_.axis().c_str());
      if (dice_.one_in(2)) xyz->SetAttribute("expressed_in", dice_.pick(bases_).c_str());
    }
    if (dice_.one_in(2)) bases_.emplace_back(joint.Attribute("name"));
    if (dice_.one_in(2)) shuffle(joint);
  }

  void shuffle(XMLElement& parent) {
    std::vector<tinyxml2::XMLNode*> children;
    for (auto* child = parent.FirstChild(); child != nullptr; child = child->NextSibling())
      children.push_back(child);
    dice_.shuffle(children);
    for (auto* child : children) parent.InsertEndChild(child);
  }

  Dice dice_;
  tinyxml2::XMLDocument document_;
  XMLElement* model_ = nullptr;
  std::vector<std::string> bases_{"__model__"};
};

}  // namespace

std::vector<RecordedRobot> recorded_robots() {
  constexpr std::uint64_t kVariants = 50;
  constexpr std::uint64_t kTrees = 30;
  const std::string koboshi =
      read_text_file(KOBOSHI_SOURCE_DIR "/tests/unit/sim_board/description/recorded/koboshi.sdf", "a robot");
  std::vector<RecordedRobot> robots{{"koboshi", koboshi}};
  for (std::uint64_t seed = 1; seed <= kVariants; ++seed)
    robots.push_back({"koboshi-" + std::to_string(seed), RobotMutation(koboshi, seed).text()});
  for (int minor = 5; minor <= 9; ++minor)
    for (std::uint64_t seed = 1; seed <= kTrees; ++seed)
      robots.push_back({"tree-1." + std::to_string(minor) + "-" + std::to_string(seed),
                        SmallTree(minor, 1000 * static_cast<std::uint64_t>(minor) + seed).text()});
  return robots;
}

}  // namespace koboshi::sim_board
