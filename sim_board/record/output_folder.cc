#include "sim_board/record/output_folder.h"

#include "sim_board/input/error.h"

namespace koboshi::sim {
namespace {

namespace fs = std::filesystem;

bool left_by_a_run(const fs::path& folder) {
  return fs::exists(folder / "summary.json") ||
         (fs::exists(folder / "trace.csv") && fs::exists(folder / "can.log"));
}

// A nearest existing parent that is no folder cannot hold one.
void check_parents(const fs::path& folder) {
  for (fs::path parent = fs::absolute(folder).parent_path(); !parent.empty(); parent = parent.parent_path()) {
    if (fs::is_directory(parent)) return;
    if (fs::exists(parent)) throw InputError(parent, 0, "a file", "a folder to make the run's folder in");
  }
}

}  // namespace

void check_output_folder(const fs::path& folder) {
  if (folder.empty()) throw InputError(folder, 0, "an empty path", "a folder for the run");
  if (!fs::exists(folder)) return check_parents(folder);
  if (!fs::is_directory(folder)) throw InputError(folder, 0, "a file", "a folder for the run");
  if (fs::is_empty(folder)) return;
  if (!left_by_a_run(folder)) {
    throw InputError(folder, 0, "a folder with other files",
                     "a new or empty folder, or one of an earlier run");
  }
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (entry.is_directory() && entry.path().filename() != "figures") {
      throw InputError(entry.path(), 0, "a folder",
                       "nothing but an earlier run in a folder that is to be replaced");
    }
  }
}

void make_output_folder(const fs::path& folder) {
  check_output_folder(folder);
  fs::create_directories(folder);
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) fs::remove_all(entry.path());
}

}  // namespace koboshi::sim
