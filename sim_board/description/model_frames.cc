#include "sim_board/description/model_frames.h"

#include <algorithm>

#include "sim_board/description/schema/sdf_version.h"

namespace koboshi::sim_board {

ModelFrames::ModelFrames(const XmlNode& model) {
  for (const XmlNode& link : model.children("link")) add(link, kModelFrame, "");
  for (const XmlNode& joint : model.children("joint")) {
    const std::string child = joint.child("child").text();
    add(joint, child, child);
  }
  for (const XmlNode& frame : model.children("frame")) {
    const std::string attached_to = frame.find_attribute("attached_to").value_or(kModelFrame);
    add(frame, attached_to, attached_to);
  }
  // The model's frame is attached to the canonical link, by default the first one.
  const std::string first = names_.empty() ? "" : names_.front();
  const std::string canonical = model.find_attribute("canonical_link").value_or(first);
  frames_.emplace(kModelFrame, Frame{model, "", canonical, {}});
}

void ModelFrames::add(const XmlNode& node, const std::string& default_base, const std::string& attached_to) {
  Frame frame{node, default_base, attached_to, {}};
  if (const auto pose = node.find("pose")) {
    frame.pose = FramePose::from_numbers(pose->numbers());
    if (const auto reference = find_pose_frame(*pose)) frame.base = reference->frame;
  }
  names_.push_back(node.attribute("name"));
  frames_.emplace(names_.back(), std::move(frame));
}

std::vector<FrameRing> ModelFrames::rings() const {
  std::vector<FrameRing> found;
  for (const std::string& name : names_) {
    find_ring(name, &Frame::base, found);
    find_ring(name, &Frame::attached_to, found);
  }
  return found;
}

// A ring is found at the first of its frames in the file.
void ModelFrames::find_ring(const std::string& start, std::string Frame::*next,
                            std::vector<FrameRing>& found) const {
  const bool is_of_poses = next == &Frame::base;
  const auto is_known = [&](const FrameRing& ring) {
    return ring.is_of_poses == is_of_poses && std::ranges::find(ring.names, start) != ring.names.end();
  };
  if (std::ranges::any_of(found, is_known)) return;
  std::vector<std::string> names{start};
  while (names.size() <= frames_.size()) {
    const std::string& name = frames_.at(names.back()).*next;
    if (name.empty()) return;
    names.push_back(name);
    if (name != start) continue;
    const XmlNode& node = frames_.at(start).node;
    found.push_back({is_of_poses ? node.find("pose").value_or(node) : node, is_of_poses, names});
    return;
  }
}

FramePose ModelFrames::model_pose(const std::string& name) const {
  FramePose pose;
  for (const Frame* frame = &frames_.at(name); !frame->base.empty(); frame = &frames_.at(frame->base))
    pose = frame->pose * pose;
  return pose;
}

FramePose ModelFrames::pose(const std::string& frame, const std::string& base) const {
  return model_pose(base).inverse() * model_pose(frame);
}

FramePose ModelFrames::part_pose(const XmlNode& part, const std::string& link) const {
  const auto node = part.find("pose");
  const auto reference = node ? find_pose_frame(*node) : std::nullopt;
  const FramePose own = node ? FramePose::from_numbers(node->numbers()) : FramePose();
  return pose(reference ? reference->frame : link, link) * own;
}

std::string ModelFrames::link_of(const std::string& frame) const {
  std::string name = frame;
  while (!frames_.at(name).attached_to.empty()) name = frames_.at(name).attached_to;
  return name;
}

}  // namespace koboshi::sim_board
