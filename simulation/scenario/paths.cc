#include "simulation/scenario/paths.h"

#include <dlfcn.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <regex>
#include <set>
#include <span>
#include <system_error>

#include "base/text/error.h"
#include "base/text/text.h"

namespace koboshi::simulation {

namespace fs = std::filesystem;

namespace {

// Where the files of a kind are: FOLDER/NAME and a suffix.
struct Place {
  const char* noun;
  const char* folder;
  std::array<const char*, 2> suffixes;  // null: no second one
};

const Place& place_of(InputKind kind) {
  static constexpr std::array<Place, 5> kPlaces{{{"scenario", "scenarios", {".yaml", nullptr}},
                                                 {"robot", "robots", {"/robot.sdf", "/robot.urdf"}},
                                                 {"gait", "robots", {"/gait.yaml", nullptr}},
                                                 {"study", "studies", {".yaml", nullptr}},
                                                 {"learning study", "studies/learn", {".yaml", nullptr}}}};
  return kPlaces.at(static_cast<std::size_t>(kind));
}

// The functions of std::filesystem without error codes throw for a name that is too long.
bool is_folder(const fs::path& path) {
  std::error_code ignored;
  return fs::is_directory(path, ignored);
}

bool is_file(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored);
}

bool is_there(const fs::path& path) {
  std::error_code ignored;
  return fs::exists(path, ignored);
}

bool is_data(const fs::path& folder) {
  return is_folder(folder / "robots") && is_folder(folder / "scenarios");
}

// Returns the nearest of the folder and its parents for which `is_wanted` holds, or nothing.
template <typename Predicate>
std::optional<fs::path> nearest_parent(fs::path folder, const Predicate& is_wanted) {
  while (!is_wanted(folder)) {
    if (folder == folder.parent_path()) return std::nullopt;
    folder = folder.parent_path();
  }
  return folder;
}

std::optional<fs::path> repository_of(const fs::path& folder) {
  return nearest_parent(folder.empty() ? fs::current_path() : fs::absolute(folder).lexically_normal(),
                        is_data);
}

// Files of which this code is a part: the Python module, the program.
std::vector<fs::path> own_files() {
  std::vector<fs::path> files;
  std::error_code error;
  Dl_info object{};
  // For the program itself, this is the first word of its command line, which is no path if it was found by
  // PATH.
  if (dladdr(reinterpret_cast<const void*>(&data_folder), &object) != 0 && object.dli_fname != nullptr &&
      fs::path(object.dli_fname).is_absolute()) {
    files.push_back(fs::canonical(object.dli_fname, error));
  }
  files.push_back(fs::read_symlink("/proc/self/exe", error));
  std::erase(files, fs::path());
  return files;
}

fs::path find_data_folder() {
  for (const fs::path& file : own_files()) {
    const auto parent = nearest_parent(file.parent_path(), [](const fs::path& folder) {
      return is_data(folder) || is_data(folder / "share/koboshi");
    });
    if (parent) return is_data(*parent) ? *parent : *parent / "share/koboshi";
  }
  return KOBOSHI_DATA_FOLDER;
}

// Empty without a home folder. Relative values of the variable are invalid (XDG base directories, 0.8).
fs::path user_data_folder() {
  const char* const data = std::getenv("XDG_DATA_HOME");
  if (data != nullptr && fs::path(data).is_absolute()) return fs::path(data) / "koboshi";
  const char* const home = std::getenv("HOME");
  return home != nullptr && *home != '\0' ? fs::path(home) / ".local/share/koboshi" : fs::path();
}

// The folders in which a path or a name is searched, in this order.
std::vector<fs::path> searched_folders(const fs::path& folder) {
  std::vector<fs::path> folders{folder};
  const auto add = [&folders](const fs::path& other) {
    if (std::ranges::find(folders, other) == folders.end()) folders.push_back(other);
  };
  if (const auto repository = repository_of(folder)) {
    if (!folder.empty() || *repository != fs::current_path()) add(*repository);
  }
  if (const fs::path user = user_data_folder(); !user.empty()) add(user);
  add(data_folder());
  return folders;
}

bool is_name(const fs::path& given) { return !given.empty() && given == given.filename(); }

// A robot's name, or a name within a scenario, goes before a file that happens to be called so, such as a
// program `koboshi` beside the folder robots.
bool is_name_first(const fs::path& given) { return is_name(given) && !given.has_extension(); }

// Returns the file of a kind in a folder. The name may have the extension of the kind's files.
fs::path find_named(const Place& place, const fs::path& folder, const fs::path& name) {
  for (const char* suffix : place.suffixes) {
    if (suffix == nullptr) continue;
    for (const fs::path& stem : {name, name.extension() == suffix ? name.stem() : fs::path()}) {
      if (stem.empty()) continue;
      const fs::path file = folder / place.folder / (stem.string() + suffix);
      if (is_file(file)) return file;
    }
  }
  return {};
}

// The robot's file in its folder; empty without one.
fs::path robot_in(const fs::path& folder) {
  for (const char* suffix : place_of(InputKind::kRobot).suffixes) {
    const fs::path file = (folder.string() + suffix);
    if (is_file(file)) return file.lexically_normal();
  }
  return {};
}

// The first of the folders that has it; empty if none has.
fs::path find_named(const Place& place, std::span<const fs::path> folders, const fs::path& name) {
  for (const fs::path& folder : folders)
    if (fs::path file = find_named(place, folder, name); !file.empty()) return file;
  return {};
}

void add_names(const Place& place, const fs::path& folder, std::set<std::string>& names) {
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder / place.folder, error)) {
    const std::string name = entry.path().stem().string();
    if (!find_named(place, folder, name).empty()) names.insert(name);
  }
}

std::string folders_text(std::span<const fs::path> folders, const std::string& below) {
  std::vector<std::string> texts;
  for (const fs::path& folder : folders)
    texts.push_back((folder.empty() ? "." : folder.string()) + "/" + below);
  return join_alternatives(texts);
}

std::string expected_text(const std::string& noun, const std::string& name,
                          std::span<const std::string> names) {
  const std::string path = "the path of a " + noun;
  return names.empty() ? path : path + " or its name: " + expected_names(name, names);
}

[[noreturn]] void refuse_name(const fs::path& name, const std::string& noun,
                              std::span<const fs::path> folders, const std::string& below,
                              std::span<const std::string> names) {
  throw InputError(one_line(name.string()), 0,
                   "no such file, and no " + noun + " of this name in " + folders_text(folders, below),
                   expected_text(noun, name.string(), names));
}

// A file in the folder of a robot's file or a subfolder of it, with or without its extension; empty without
// one.
fs::path file_of_robot(const fs::path& robot, const fs::path& subfolder, const fs::path& name) {
  for (const fs::path& inner : {fs::path(), subfolder}) {
    for (const char* suffix : {"", ".yaml"}) {
      const fs::path file = (robot.parent_path() / inner / (name.string() + suffix)).lexically_normal();
      if (is_file(file)) return file;
    }
  }
  return {};
}

// The name of the first <model> in a robot's file; empty if there is none.
std::string model_name(const fs::path& robot) {
  std::ifstream file(robot);
  std::string text(64 * 1024, '\0');  // it is near the beginning
  text.resize(
      static_cast<std::size_t>(file.read(text.data(), static_cast<std::streamsize>(text.size())).gcount()));
  std::smatch found;
  static const std::regex kModel("<model\\s+name\\s*=\\s*[\"']([^\"'<>]*)[\"']");
  return std::regex_search(text, found, kModel) ? found[1].str() : std::string();
}

fs::path find_named_motion(const fs::path& robot, const fs::path& name) {
  const fs::path folder = robot.parent_path() / "motions";
  const fs::path file = folder / (name.extension() == ".yaml" ? name : fs::path(name.string() + ".yaml"));
  return is_file(file) ? file : fs::path();
}

}  // namespace

fs::path data_folder() {
  static const fs::path kFolder = find_data_folder();
  return kFolder;
}

fs::path repository_root(const fs::path& folder) { return repository_of(folder).value_or(data_folder()); }

fs::path find_referenced(const fs::path& folder, const fs::path& path) {
  for (const fs::path& base : searched_folders(folder)) {
    const fs::path file = (base / path).lexically_normal();
    if (is_file(file)) return file;
  }
  return {};
}

fs::path read_path(const YamlValue& value, const fs::path& folder) {
  const fs::path file = find_referenced(folder, value.text());
  if (file.empty()) {
    throw value.error("no file " + one_line(value.text()),
                      "a path relative to the scenario's folder or to the repository's root");
  }
  return file;
}

fs::path find_path(const fs::path& given) {
  if (given.empty() || is_there(given)) return given;
  for (const fs::path& base : searched_folders({})) {
    if (is_there(base / given)) return (base / given).lexically_normal();
  }
  return given;
}

fs::path find_input(InputKind kind, const fs::path& given) {
  const fs::path path = find_path(given);
  if (kind == InputKind::kRobot && is_folder(path)) {
    if (fs::path file = robot_in(path); !file.empty()) return file;
  }
  const bool is_name_wanted = is_folder(path) || (kind == InputKind::kRobot && is_name_first(given));
  if (!is_name(given) || (is_there(path) && !is_name_wanted)) return path;
  const std::vector<fs::path> folders = searched_folders({});
  if (const fs::path file = find_named(place_of(kind), folders, given); !file.empty()) return file;
  if (is_there(path)) return path;
  refuse_name(given, place_of(kind).noun, folders, place_of(kind).folder, input_names(kind));
}

Override robot_override(const std::string& given) {
  if (given.empty()) return {"robot", "", "--robot"};
  return text_override("robot", fs::absolute(find_input(InputKind::kRobot, given)).string(), "--robot");
}

fs::path find_motion(const fs::path& given, const fs::path& robot) {
  const fs::path path = find_path(given);
  if (!is_name(given) || is_there(path)) return path;
  if (const fs::path file = find_named_motion(robot, given); !file.empty()) return file;
  const std::array folders{robot.parent_path()};
  refuse_name(given, "motion", folders, "motions", robot_motion_names(robot));
}

std::vector<std::string> input_names(InputKind kind) {
  std::set<std::string> names;
  for (const fs::path& folder : searched_folders({})) add_names(place_of(kind), folder, names);
  return {names.begin(), names.end()};
}

std::vector<std::string> robot_motion_names(const fs::path& robot) {
  std::set<std::string> names;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(robot.parent_path() / "motions", error))
    if (entry.path().extension() == ".yaml") names.insert(entry.path().stem().string());
  return {names.begin(), names.end()};
}

fs::path read_input(const YamlValue& value, const fs::path& folder, InputKind kind) {
  if (kind == InputKind::kRobot) {
    for (const fs::path& base : searched_folders(folder))
      if (fs::path file = robot_in(base / value.text()); !file.empty()) return file;
  }
  if (is_name_first(value.text()) ||
      (is_name(value.text()) && find_referenced(folder, value.text()).empty())) {
    const std::vector<fs::path> folders = searched_folders(folder);
    if (const fs::path file = find_named(place_of(kind), folders, value.text()); !file.empty()) return file;
  }
  return read_path(value, folder);
}

namespace {

// Returns the file that `given` names in the folder of a robot or of the robot of its name; empty if there is
// none.
fs::path find_robot_file(const fs::path& given, const fs::path& folder, const fs::path& robot,
                         const fs::path& subfolder) {
  if (fs::path file = file_of_robot(robot, subfolder, given); !file.empty()) return file;
  // A copy of robot.sdf alone is still the robot of its name.
  const fs::path namesake =
      find_named(place_of(InputKind::kRobot), searched_folders(folder), model_name(robot));
  return namesake.empty() ? fs::path() : file_of_robot(namesake, subfolder, given);
}

}  // namespace

bool has_robot_file(const YamlValue& value, const fs::path& folder, const fs::path& robot,
                    const fs::path& subfolder) {
  const fs::path given = value.text();
  return !find_referenced(folder, given).empty() || !find_robot_file(given, folder, robot, subfolder).empty();
}

fs::path read_robot_file(const YamlValue& value, const fs::path& folder, const fs::path& robot,
                         const fs::path& subfolder) {
  const fs::path given = value.text();
  const bool is_path = !find_referenced(folder, given).empty();
  if (is_path && !is_name_first(given)) return read_path(value, folder);
  if (fs::path file = find_robot_file(given, folder, robot, subfolder); !file.empty()) return file;
  if (is_path) return read_path(value, folder);
  std::string expected =
      "a path relative to the scenario's folder, to the repository's root or to the robot's folder";
  if (is_name(given) && !fs::exists(robot.parent_path() / "parameters.yaml"))
    expected += "; " + bring_up_remedy(robot);
  throw value.error("no file " + one_line(value.text()), expected);
}

std::string robot_text(const fs::path& robot) {
  std::error_code error;
  const fs::path folder = fs::absolute(robot, error).lexically_normal().parent_path();
  const fs::path relative = folder.lexically_relative(fs::current_path(error));
  const bool is_inside = !relative.empty() && *relative.begin() != "..";
  // Whole, since the user types it: one_line() would cut a long path.
  std::string text = (is_inside ? relative : folder).string();
  std::ranges::replace_if(
      text, [](unsigned char c) { return c < 0x20 || c == 0x7F; }, ' ');
  return utf8_text(text);
}

std::string bring_up_remedy(const fs::path& robot) {
  return "koboshi bring-up " + robot_text(robot) + " makes its motions, its parameters and a go.yaml";
}

}  // namespace koboshi::simulation
