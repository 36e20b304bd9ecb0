#pragma once

#include <cstdint>
#include <filesystem>
#include <map>

#include "tools/robot_file/check/mesh_faults.h"
#include "view/capture/stl.h"

namespace koboshi::tools {

// The mesh files of a robot. Each is read and checked once, and again after a change of its size or time.
class MeshStore {
 public:
  struct Entry {
    view::StlFile stl{};
    MeshFaults faults{};  // of the mesh, if there is one
  };

  const Entry& of(const std::filesystem::path& file);
  // How many files have been read in all.
  std::size_t reads() const { return reads_; }

 private:
  struct State {
    std::uintmax_t size = 0;
    std::filesystem::file_time_type time{};
    bool operator==(const State&) const = default;
  };

  std::map<std::filesystem::path, std::pair<State, Entry>> entries_;
  std::size_t reads_ = 0;
};

}  // namespace koboshi::tools
