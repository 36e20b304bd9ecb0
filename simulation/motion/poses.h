#pragma once

#include <map>
#include <string>
#include <vector>

#include "simulation/motion/body_targets.h"
#include "simulation/motion/joints.h"
#include "simulation/motion/reader.h"
#include "simulation/motion/source.h"

namespace koboshi::simulation {

// Computes the angles of a file's poses: named, derived, mirrored, Cartesian and inline ones.
class PoseBuilder {
 public:
  // `allowed`: mask of the joints that poses may name; `others: zero` means the rest of them.
  PoseBuilder(const JointNames& joints, std::uint32_t allowed, int version, Reader& reader);

  // Reads a map of poses, whose order they keep.
  void read(const sim::YamlNode& poses);
  // Returns the pose that a step means: a name, or an inline pose, which becomes a pose of its own unless
  // there is an equal one; with `mirrored` its mirror image. Reports errors and returns nothing.
  std::optional<std::size_t> pose_of_step(const sim::YamlNode& value, bool mirrored);

  [[nodiscard]] std::vector<PoseSource> take() { return std::move(poses_); }

 private:
  using Angles = std::vector<std::optional<fixed::Angle>>;
  enum class State { kUnread, kRead };

  PoseSource* resolve(const std::string& name, const sim::YamlNode& user, const char* what);
  void resolve(std::size_t index);
  void build(const sim::YamlNode& value, PoseSource& pose);
  void take_base(const sim::YamlNode& map, PoseSource& pose);
  void set_angles(const sim::YamlNode& item, PoseSource& pose, std::uint32_t& given);
  void set_angle(const sim::YamlNode& item, std::size_t joint, double angle_deg, PoseSource& pose,
                 std::uint32_t& given);
  void set_others(const sim::YamlNode& map, PoseSource& pose);
  void set_targets(const sim::YamlNode& map, PoseSource& pose, std::uint32_t given);
  BodyTargets::Support read_support(const sim::YamlNode& map);
  Target read_target(const sim::YamlNode& map, const std::string& key, bool with_angles);
  bool check_targets(const sim::YamlNode& map, const BodyTargets& targets);
  void report_unreached(const sim::YamlNode& map, const BodySolution& solution);
  void mirror(const sim::YamlNode& user, Angles& angles);
  std::size_t add(PoseSource pose);

  const JointNames& joints_;
  const std::uint32_t allowed_;
  const int version_;
  Reader& reader_;
  std::vector<PoseSource> poses_;
  std::vector<const sim::YamlNode*> nodes_;  // of the named poses
  std::vector<State> states_;
  std::map<std::string, std::size_t> indices_;
  std::map<std::vector<std::int64_t>, std::size_t> by_angles_;  // of the poses that steps made
  std::map<std::size_t, std::size_t> mirrored_;
};

// Sets each angle to that of the mirror image, which may lie beyond a joint's limits.
void mirror_angles(const JointNames& joints, std::vector<std::optional<fixed::Angle>>& angles);

}  // namespace koboshi::simulation
