#pragma once

#include <filesystem>
#include <string>

namespace koboshi::studio {

// Copies of a robot's file with other texts, which a simulation can read before they are saved. Relative
// paths in the text, of meshes and servo libraries, lead to the files beside the original.
class RobotCopies {
 public:
  // `folder` must exist; the copies stay in it.
  RobotCopies(const std::filesystem::path& original, std::filesystem::path folder);

  // Writes a new copy and returns its file; earlier ones stay. Throws WriteError.
  std::filesystem::path write(const std::string& text);

 private:
  const std::filesystem::path original_;
  const std::filesystem::path folder_;
  int count_ = 0;
};

}  // namespace koboshi::studio
