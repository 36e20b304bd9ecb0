#include "tools/import/read/sdf_frames.h"

#include "base/text/text.h"
#include "base/text/user_units.h"
#include "tools/import/read/xml_values.h"

namespace koboshi::tools {
namespace {

constexpr const char* kModel = "__model__";

}  // namespace

std::string relative_to(const XmlNode& pose) {
  for (const char* attribute : {"relative_to", "frame"})
    if (const auto name = pose.find_attribute(attribute)) return *name;
  return {};
}

Eigen::Isometry3d pose_of_element(const XmlNode& element) {
  const auto pose = element.find("pose");
  if (!pose || trimmed_name(pose->text()).empty()) return Eigen::Isometry3d::Identity();
  const std::vector<double> p = numbers_in(*pose, pose->text(), 6, "<pose>");
  const double unit = pose->find_attribute("degrees") == "true" ? kRadPerDegree : 1.0;
  return pose_from({p[0], p[1], p[2]}, unit * Eigen::Vector3d(p[3], p[4], p[5]));
}

SdfFrames::SdfFrames(const XmlNode& model) {
  const auto add = [this](const XmlNode& node, const std::string& parent) {
    if (!frames_.try_emplace(node.attribute("name"), Frame{node, parent}).second)
      throw node.error("a second " + one_line(node.attribute("name")), "a name of its own");
  };
  for (const XmlNode& link : model.children("link")) add(link, {});
  for (const XmlNode& joint : model.children("joint"))
    add(joint, std::string(trimmed_name(joint.child("child").text())));
  for (const XmlNode& frame : model.children("frame"))
    add(frame, frame.find_attribute("attached_to").value_or(""));
}

Eigen::Isometry3d SdfFrames::pose_in_model(const std::string& name, const XmlNode& node) {
  if (name.empty() || name == kModel) return Eigen::Isometry3d::Identity();
  if (const auto known = poses_.find(name); known != poses_.end()) return known->second;
  const auto found = frames_.find(name);
  if (found == frames_.end())
    throw node.error("frame " + one_line(name), "the name of a link, joint or frame");
  if (!open_.insert(name).second)
    throw node.error("a ring of frames with " + one_line(name), "poses that end at the model");
  const Eigen::Isometry3d pose = pose_in_model(found->second.node, found->second.parent);
  open_.erase(name);
  return poses_[name] = pose;
}

Eigen::Isometry3d SdfFrames::pose_in_model(const XmlNode& element, const std::string& parent) {
  const auto pose = element.find("pose");
  const std::string named = pose ? relative_to(*pose) : std::string();
  return pose_in_model(named.empty() ? parent : named, element) * pose_of_element(element);
}

std::string SdfFrames::link_of(const std::string& name, const XmlNode& node) const {
  std::string at = name;
  for (std::size_t step = 0; step <= frames_.size(); ++step) {
    const auto found = frames_.find(at);
    if (found == frames_.end()) break;
    if (found->second.node.name() == "link") return at;
    at = found->second.parent;
  }
  throw node.error("frame " + one_line(name), "a link, or a frame that is attached to one");
}

}  // namespace koboshi::tools
