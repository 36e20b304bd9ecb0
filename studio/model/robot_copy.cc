#include "studio/model/robot_copy.h"

#include <utility>

#include "base/file/output_file.h"

namespace koboshi::studio {
namespace {

namespace fs = std::filesystem;

// Links to everything in a folder but the one entry. The reader will name an entry that cannot be linked.
void link_entries(const fs::path& from, const fs::path& to, const fs::path& but) {
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(from, ignored))
    if (entry.path().filename() != but)
      fs::create_symlink(entry.path(), to / entry.path().filename(), ignored);
}

}  // namespace

RobotCopies::RobotCopies(const fs::path& original, fs::path folder)
    : original_(fs::absolute(original)), folder_(std::move(folder)) {}

// The folder of the robot and its parent are rebuilt, for paths such as ../servos/hobby.xml.
fs::path RobotCopies::write(const std::string& text) {
  const fs::path beside = original_.parent_path();
  const fs::path outer = folder_ / ("robot_" + std::to_string(++count_));
  const fs::path inner = outer / beside.filename();
  fs::create_directories(inner);
  link_entries(beside.parent_path(), outer, beside.filename());
  link_entries(beside, inner, original_.filename());
  fs::path file = inner / original_.filename();
  write_whole_file(file, text);
  return file;
}

}  // namespace koboshi::studio
