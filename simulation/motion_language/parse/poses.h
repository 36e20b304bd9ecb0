#pragma once

#include <map>
#include <string>
#include <vector>

#include "simulation/motion_language/parse/body_targets.h"
#include "simulation/motion_language/parse/joints.h"
#include "simulation/motion_language/parse/reader.h"
#include "simulation/motion_language/parse/source.h"

namespace koboshi::simulation {

// Computes the angles of a file's poses: named, derived, mirrored, Cartesian and inline ones.
class PoseBuilder {
 public:
  // `allowed`: mask of the joints that poses may name; `others: zero` means the rest of them.
  PoseBuilder(const JointNames& joints, std::uint32_t allowed, int version, Reader& reader);

  // Reads a map of poses, whose order they keep.
  void read(const YamlNode& poses);
  // Returns the pose that a step means: a name, or an inline pose, which becomes a pose of its own unless
  // there is an equal one; with `mirrored` its mirror image. Reports errors and returns nothing.
  std::optional<std::size_t> pose_of_step(const YamlNode& value, bool mirrored);

  [[nodiscard]] std::vector<PoseSource> take() { return std::move(poses_); }

 private:
  using Angles = std::vector<std::optional<fixed::Angle>>;
  enum class State { kUnread, kRead };

  PoseSource* resolve(const std::string& name, const YamlNode& user, const char* what);
  void resolve(std::size_t index);
  void build(const YamlNode& value, PoseSource& pose);
  void take_base(const YamlNode& map, PoseSource& pose);
  void set_angles(const YamlNode& item, PoseSource& pose, std::uint32_t& given);
  void set_angle(const YamlNode& item, std::size_t joint, double angle_deg, PoseSource& pose,
                 std::uint32_t& given);
  void set_others(const YamlNode& map, PoseSource& pose);
  void set_targets(const YamlNode& map, PoseSource& pose, std::uint32_t given);
  BodyTargets::Support read_support(const YamlNode& map);
  Target read_target(const YamlNode& map, const std::string& key, bool with_angles);
  bool check_targets(const YamlNode& map, const BodyTargets& targets);
  void report_unreached(const YamlNode& map, const BodySolution& solution);
  bool is_within_limits(const Place& place, std::size_t joint, double angle_deg, const std::string& where);
  void mirror(const YamlNode& user, Angles& angles);
  std::size_t add(PoseSource pose);

  const JointNames& joints_;
  const std::uint32_t allowed_;
  const int version_;
  Reader& reader_;
  std::vector<PoseSource> poses_;
  std::vector<const YamlNode*> nodes_;  // of the named poses
  std::vector<State> states_;
  std::map<std::string, std::size_t> indices_;
  std::map<std::vector<std::int64_t>, std::size_t> by_angles_;  // of the poses that steps made
  std::map<std::size_t, std::size_t> mirrored_;
};

// Sets each angle to that of the mirror image, which may lie beyond a joint's limits.
void mirror_angles(const JointNames& joints, std::vector<std::optional<fixed::Angle>>& angles);

}  // namespace koboshi::simulation
