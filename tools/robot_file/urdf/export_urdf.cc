#include "tools/robot_file/urdf/export_urdf.h"

#include <set>
#include <system_error>

#include <tinyxml2.h>

#include "base/edit/xml_document.h"
#include "base/file/output_file.h"
#include "base/file/overwrite.h"
#include "base/text/error.h"
#include "base/text/foreign_text.h"
#include "base/text/text.h"
#include "base/xml/xml_reader.h"
#include "sim_board/description/load.h"
#include "sim_board/description/schema/sdf_schema.h"
#include "tools/import/write/robot_folder.h"
#include "tools/robot_file/urdf/urdf_text.h"

namespace koboshi::tools {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> library_types(const fs::path& library) {
  std::vector<std::string> types;
  const XmlFile file(library, sim_board::servo_library_rule());
  for (const XmlNode& node : file.root().children("koboshi:servo_type")) {
    tinyxml2::XMLPrinter printer(nullptr, true);
    node.element().Accept(&printer);
    types.emplace_back(printer.CStr());
  }
  return types;
}

// The text of a robot's file with the servo types of its libraries in it: it must load in any folder.
std::string with_servo_types(const fs::path& file) {
  XmlDocument document(file);
  const XmlFile robot(file, document.text(), sim_board::sdf_rule());
  const std::vector<XmlNode> libraries = robot.root().child("model").children("koboshi:servo_types");
  // From the last one on, so that the places of the others hold.
  for (auto library = libraries.rbegin(); library != libraries.rend(); ++library) {
    const XmlPath place = library->place();
    const XmlPath model(place.begin(), place.end() - 1);
    document.erase_element(place);
    std::size_t next = place.back();
    for (const std::string& type : library_types(file.parent_path() / library->attribute("file")))
      document.insert_element(model, next++, type);
  }
  return with_line_feeds(document.text());
}

// Refuses to destroy the robot's meshes, and files of others in the folder of the URDF. An earlier export may
// be replaced.
void require_own_files(const fs::path& urdf, const FolderFiles& files, const std::set<fs::path>& meshes,
                       const fs::path& folder) {
  std::error_code missing;
  for (const fs::path& mesh : meshes) refuse_to_overwrite({folder / mesh}, urdf);
  if (fs::exists(urdf, missing) && read_text_file(urdf, "a URDF").find("<koboshi>") != std::string::npos)
    return;
  for (const auto& [name, content] : files) {
    const fs::path file = urdf.parent_path() / name;
    if (fs::exists(file, missing) && read_text_file(file, "a file") != content)
      throw InputError(file, 0, "another file of this name",
                       "a folder without it, or that of an earlier export");
  }
}

}  // namespace

fs::path path_in_folder(const fs::path& file, const fs::path& folder) {
  const fs::path path = file.lexically_normal().lexically_relative((folder / ".").lexically_normal());
  return path.empty() || *path.begin() == ".." ? fs::path() : path;
}

std::vector<fs::path> export_urdf(const fs::path& robot_file, const fs::path& urdf,
                                  const std::string& package) {
  const sim_board::RobotDescription robot = sim_board::load_robot(robot_file);
  const fs::path folder = robot_file.parent_path();
  std::set<fs::path> meshes;
  for (const sim_board::LinkDescription& link : robot.links)
    for (const sim_board::MeshDescription& mesh : link.meshes) {
      const fs::path path = path_in_folder(mesh.file, folder);
      if (path.empty())
        throw InputError(robot_file, link.line,
                         "the mesh " + one_line(mesh.file.string()) + " of " + link.name,
                         "a file in the robot's folder or below it");
      meshes.insert(path);
    }
  const std::string prefix = package.empty() ? "" : "package://" + package + "/";
  const std::string text = urdf_text(robot, prefix, with_servo_types(robot_file));
  if (fs::is_directory(urdf)) throw InputError(urdf, 0, "a folder", "a file name");
  // All is read before the first write, so that a failure leaves nothing half-written.
  const fs::path target = urdf.parent_path().empty() ? "." : urdf.parent_path();
  FolderFiles files;
  std::error_code error;
  // The robot's own folder has its meshes and licences already.
  if (!fs::equivalent(folder.empty() ? "." : folder, target, error)) {
    ImportReport ignored;
    add_licences(robot_file, files, ignored);
    for (const fs::path& mesh : meshes) files[mesh.string()] = read_text_file(folder / mesh, "a mesh");
  }
  require_own_files(urdf, files, meshes, folder);
  std::vector<fs::path> written{urdf};
  for (const auto& [name, content] : files) {
    const fs::path file = urdf.parent_path() / name;
    fs::create_directories(target / fs::path(name).parent_path());
    write_whole_file(file, content);
    written.push_back(file);
  }
  fs::create_directories(target);
  write_whole_file(urdf, text);
  return written;
}

}  // namespace koboshi::tools
