#pragma once

#include <map>
#include <string>
#include <vector>

#include "base/xml/xml_node.h"
#include "sim_board/description/frame_pose.h"

namespace koboshi::sim_board {

// Frames whose poses or attachments lead back to themselves.
struct FrameRing {
  XmlNode node;  // the pose of one of them, or the frame itself
  bool is_of_poses;
  std::vector<std::string> names;  // the first one again at the end
};

// The frames of a model with the semantics of SDF 1.9: links, joints, <frame> elements, and kModelFrame. The
// references of the model must be sound (find_robot_faults()). Without rings(), all other functions are
// defined for all names of frames.
class ModelFrames {
 public:
  explicit ModelFrames(const XmlNode& model);

  // Returns each ring once, in the order of the file.
  std::vector<FrameRing> rings() const;

  // The pose of `frame` in `base`.
  FramePose pose(const std::string& frame, const std::string& base) const;
  // The pose of a collision, visual or sensor of the link `link` in the link's frame.
  FramePose part_pose(const XmlNode& part, const std::string& link) const;
  // The name of the link to which a frame is attached: for a link, its own.
  std::string link_of(const std::string& frame) const;

 private:
  struct Frame {
    XmlNode node;
    std::string base;         // the frame of the pose
    std::string attached_to;  // empty: a link
    FramePose pose;           // in `base`
  };

  void add(const XmlNode& node, const std::string& default_base, const std::string& attached_to);
  // The pose in the model's frame.
  FramePose model_pose(const std::string& frame) const;
  void find_ring(const std::string& start, std::string Frame::*next, std::vector<FrameRing>& found) const;

  std::map<std::string, Frame> frames_;
  std::vector<std::string> names_;  // in the order of the file
};

}  // namespace koboshi::sim_board
