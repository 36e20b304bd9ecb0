#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/yaml/yaml_reader.h"
#include "sim_board/description/description.h"
#include "tools/motion_files/joint_map.h"

namespace koboshi::tools {

// The file of --map (docs/reference/motion-import.md): which joint of the robot each joint of other makers'
// files is.
class JointMapFile {
 public:
  // Throws InputError for a file that is no map for this robot.
  JointMapFile(const std::filesystem::path& file, const sim_board::RobotDescription& robot);

  // Returns whether the map names this joint, and sets what it becomes: nothing if the map ignores it.
  bool find(const ForeignJoint& joint, bool ticks, std::optional<MappedJoint>& mapped) const;
  // Returns the joint that the map gives to this one of the robot: its name, and its number if the name is
  // one.
  [[nodiscard]] std::optional<NamedForeignJoint> named(std::size_t joint, bool numbered, bool ticks) const;

 private:
  struct Entry {
    bool ignored = false;
    MappedJoint in_rad{};
    MappedJoint in_ticks{};
  };

  static Entry read(const YamlValue& value, const sim_board::RobotDescription& robot);

  std::vector<std::pair<std::string, Entry>> entries_;
};

}  // namespace koboshi::tools
