#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include <fmt/core.h>

#include "base/file/overwrite.h"
#include "base/file/standard_streams.h"
#include "base/file/temporary_folder.h"
#include "base/text/error.h"
#include "base/text/shell_word.h"
#include "base/text/text.h"
#include "cli/commands.h"
#include "sim_board/description/load.h"
#include "simulation/scenario/paths.h"
#include "tools/import/pipeline/import_robot.h"
#include "tools/import/write/sdf_parts.h"
#include "tools/robot_file/map/joint_pictures.h"
#include "view/render/gl.h"

namespace koboshi::cli {
namespace {

struct ModelImportArguments {
  std::filesystem::path file;
  std::filesystem::path output;
  std::filesystem::path answers;
  std::vector<std::filesystem::path> paths;
  std::vector<std::string> servos;
};

// Splits TYPE:JOINT,JOINT into decisions.
void add_servo(const std::string& argument, tools::ImportDecisions& decisions) {
  const std::size_t colon = argument.find(':');
  if (colon == std::string::npos) {
    decisions.answers["servo"] = argument;
    decisions.places["answers/servo"] = {"--servo"};
    return;
  }
  std::string joints = argument.substr(colon + 1);
  if (joints.find_first_not_of(',') == std::string::npos)
    throw InputError("--servo", 0, one_line(argument), "TYPE, or TYPE:JOINT,JOINT");
  for (std::size_t begin = 0; begin <= joints.size();) {
    const std::size_t end = std::min(joints.find(',', begin), joints.size());
    if (end > begin) {
      const std::string joint = joints.substr(begin, end - begin);
      decisions.servos[joint] = argument.substr(0, colon);
      decisions.places["servos/" + joint] = {"--servo"};
    }
    begin = end + 1;
  }
}

std::string ask_person(const tools::ImportQuestion& question) {
  std::string choices;
  if (!question.choices.empty()) choices = " (" + join_alternatives(question.choices) + ")";
  fmt::print("{}{}\n{} [{}]: ", question.text, choices, question.name, question.preset);
  std::cout.flush();
  std::string line;
  if (!std::getline(std::cin, line)) return {};
  return std::string(trimmed_name(line));
}

tools::ImportOptions options_of(const ModelImportArguments& arguments, const Invocation& invocation) {
  tools::ImportOptions options{.file = arguments.file,
                               .paths = arguments.paths,
                               .servo_folder = simulation::data_folder() / "robots/servos",
                               .decisions_source = arguments.output / "import.yaml",
                               .output = arguments.output,
                               .command = invocation.command_line};
  if (std::filesystem::exists(options.decisions_source))
    options.decisions = tools::read_decisions(options.decisions_source);
  if (!arguments.answers.empty()) {
    options.decisions_source = arguments.answers;
    tools::override_decisions(options.decisions, tools::read_decisions(arguments.answers));
  }
  for (const std::string& servo : arguments.servos) add_servo(servo, options.decisions);
  if (isatty(STDIN_FILENO) != 0 && isatty(STDOUT_FILENO) != 0) options.ask = ask_person;
  return options;
}

// Loads the imported robot from a folder for trial. Throws InputError, naming the source, and the link or
// joint of robot.sdf, which nobody sees.
sim_board::RobotDescription load_trial(const std::filesystem::path& source,
                                       const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "robot.sdf";
  try {
    return sim_board::load_robot(file);
  } catch (const InputError& error) {
    const std::string part = tools::part_at_line(file, error.line());
    throw InputError(source, 0,
                     "a robot that cannot be simulated: " + (part.empty() ? "" : part + ": ") + error.found(),
                     error.expected());
  }
}

constexpr std::array kPictures{"robot.png", "boxes.png"};

// Returns whether it drew the pictures into the folder: a machine without OpenGL does not.
bool draw_pictures(const sim_board::RobotDescription& robot, const std::filesystem::path& folder) {
  try {
    tools::draw_robot(robot, tools::RobotShapes::kVisuals, folder / kPictures[0]);
    tools::draw_robot(robot, tools::RobotShapes::kCollisions, folder / kPictures[1]);
    return true;
  } catch (const view::GlError& error) {
    print_error("warning: import.md without pictures: {}\n", error.what());
    return false;
  }
}

// Shows the pictures above the first table of import.md.
void show_pictures(const std::filesystem::path& folder, std::string& page) {
  page.insert(std::min(page.find("\n## "), page.size()),
              "\n![the robot](robot.png)\n![its collision boxes](boxes.png)\n\n"
              "`koboshi model map " +
                  shell_word(folder.string()) +
                  " --pictures FOLDER` draws each joint turned by 20 degrees.\n");
}

// A source in the robot's own folder, as `koboshi model export` may have put it there, loses neither itself
// nor its meshes.
void refuse_own_source(const ModelImportArguments& arguments, const tools::FolderFiles& files) {
  for (const auto& [name, content] : files) refuse_to_overwrite({arguments.file}, arguments.output / name);
  std::error_code missing;
  const std::filesystem::path folder = std::filesystem::absolute(arguments.file).parent_path();
  if (!std::filesystem::equivalent(folder, arguments.output, missing)) return;
  for (const auto& entry : std::filesystem::directory_iterator(arguments.output / "meshes", missing)) {
    const auto mesh = files.find("meshes/" + entry.path().filename().string());
    const bool stays = mesh != files.end() ? mesh->second == read_text_file(entry.path(), "a mesh")
                                           : entry.path().extension() != ".stl";
    if (!stays)
      throw InputError(
          arguments.file, 0,
          "a source in the folder of the robot, whose mesh " + entry.path().string() + " the import replaces",
          "source and meshes in another folder");
  }
}

// Nothing is written of a robot that cannot be simulated.
void import_model(const ModelImportArguments& arguments, const Invocation& invocation) {
  tools::check_import_folder(arguments.output);
  tools::ImportResult result = tools::import_robot(options_of(arguments, invocation));
  refuse_own_source(arguments, result.files);
  const TemporaryFolder trial;
  tools::write_import_folder(trial.path(), result.files);
  const bool has_pictures = draw_pictures(load_trial(arguments.file, trial.path()), trial.path());
  if (has_pictures) show_pictures(arguments.output, result.files.at("import.md"));
  tools::write_import_folder(arguments.output, result.files);
  for (const char* const picture : kPictures)
    if (has_pictures)
      std::filesystem::copy_file(trial.path() / picture, arguments.output / picture,
                                 std::filesystem::copy_options::overwrite_existing);
  const tools::ImportReport& report = result.report;
  for (const tools::ImportRepair& repair : report.repairs)
    fmt::print("{}: {} -> {}, because {}\n", repair.key, repair.found, repair.is_kept ? "kept" : repair.taken,
               repair.because);
  std::fflush(stdout);  // before what follows on standard error
  for (const std::string& warning : report.warnings) print_error("warning: {}\n", warning);
  fmt::print("{}: {}, {}, {}, {}, {}\n", (arguments.output / "robot.sdf").string(),
             count_text(result.robot.links.size(), "link"), count_text(result.robot.joints.size(), "joint"),
             count_text(result.questions, "answer"), count_text(report.repairs.size(), "repair"),
             count_text(report.warnings.size(), "warning"));
}

}  // namespace

void add_model_import_command(CLI::App& model, Invocation& invocation) {
  auto arguments = std::make_shared<ModelImportArguments>();
  CLI::App* command = model.add_subcommand("import", "Import a robot from a URDF, SDF or MJCF file");
  command->footer(
      R"(Writes robot.sdf, meshes, the source's licence, import.yaml with every decision, and import.md, which says
what was found, changed and asked (docs/guide/import-a-robot.md). What no file can know is asked on a terminal;
--answers FILE or the preset answers otherwise. Edit import.yaml and repeat the command to decide otherwise.

Example:
  koboshi model import kit/robot.urdf -o robots/kit --servo ax_12
)");
  command->add_option("FILE", arguments->file, "URDF, SDF or MJCF file of the robot")->required();
  command->add_option("-o", arguments->output, "Folder of the robot: robots/NAME")
      ->required()
      ->type_name("FOLDER");
  command->add_option("--path", arguments->paths, "Folder of packages or models in which meshes are searched")
      ->type_name("FOLDER");
  command
      ->add_option("--servo", arguments->servos,
                   "Servo type of all joints, or of some: TYPE:JOINT,JOINT\n(default: by the robot's mass)")
      ->type_name("TYPE");
  command
      ->add_option("--answers", arguments->answers, "Answers to the questions, in the format of import.yaml")
      ->type_name("FILE");
  command->callback([arguments, &invocation] { import_model(*arguments, invocation); });
}

}  // namespace koboshi::cli
