#include <QApplication>
#include <QIcon>
#include <QSessionManager>
#include <QTranslator>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "base/file/standard_streams.h"
#include "base/text/error.h"
#include "base/text/text.h"
#include "simulation/scenario/paths.h"
#include "studio/widgets/termination.h"
#include "studio/widgets/translation.h"
#include "studio/window/main_window.h"
#include "tools/manual/studio_options.h"
#include "tools/run/exit_status.h"

namespace {

bool is_set(const char* variable) {
  const char* value = std::getenv(variable);
  return value != nullptr && *value != '\0';
}

// Qt ends the process with a page of text where there is no display.
bool has_display() {
  const char* platform = std::getenv("QT_QPA_PLATFORM");
  if (platform != nullptr && std::string_view(platform).starts_with("offscreen")) return true;
  return is_set("DISPLAY") || is_set("WAYLAND_DISPLAY");
}

// Qt aborts the process after a fatal message, such as of a display that does not answer.
void take_message(QtMsgType type, const QMessageLogContext& /*context*/, const QString& text) {
  if (type != QtFatalMsg) return koboshi::print_error("{}\n", text.toStdString());
  koboshi::print_error("koboshi studio: {}\n", koboshi::one_line(text.toStdString()));
  std::_Exit(koboshi::tools::kBadInput);
}

// A name is a scenario's, or else that of a motion of the robot.
std::filesystem::path find_document(const std::filesystem::path& given, const std::filesystem::path& robot) {
  namespace simulation = koboshi::simulation;
  const std::filesystem::path path = simulation::find_path(given);
  if (std::filesystem::exists(path)) return path;
  std::vector<std::string> scenarios = simulation::input_names(simulation::InputKind::kScenario);
  const std::vector<std::string> motions = simulation::robot_motion_names(robot);
  const auto is_in = [&given](const std::vector<std::string>& names) {
    return std::ranges::find(names, given.stem().string()) != names.end();
  };
  if (!given.has_parent_path() && is_in(scenarios))
    return simulation::find_input(simulation::InputKind::kScenario, given);
  if (!given.has_parent_path() && is_in(motions)) return simulation::find_motion(given, robot);
  scenarios.insert(scenarios.end(), motions.begin(), motions.end());
  throw koboshi::InputError(koboshi::one_line(given.string()), 0, "no such file, folder, scenario or motion",
                            "a path, or a name: " + koboshi::expected_names(given.string(), scenarios));
}

// Throws InputError for a file that does not exist.
void find_inputs(koboshi::tools::StudioArguments& arguments) {
  namespace simulation = koboshi::simulation;
  arguments.robot = simulation::find_input(simulation::InputKind::kRobot, arguments.robot);
  if (arguments.robot_option->count() > 0 && !std::filesystem::is_regular_file(arguments.robot))
    throw koboshi::InputError(arguments.robot, 0, "no such file", "a robot's file or name");
  for (std::filesystem::path& file : arguments.files) file = find_document(file, arguments.robot);
}

int run_program(int argc, char** argv) {
  CLI::App program(koboshi::tools::kStudioDescription, "koboshi studio");
  program.set_version_flag("--version", "koboshi studio " KOBOSHI_VERSION);
  koboshi::tools::StudioArguments arguments;
  koboshi::tools::add_studio_options(program, arguments);
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return program.exit(error) == 0 ? 0 : koboshi::tools::kBadInput;
  }
  find_inputs(arguments);
  if (!has_display()) {
    koboshi::print_error(
        "koboshi studio: no display here; `koboshi replay RUN --html` writes replay.html, which shows "
        "a recorded run in a browser elsewhere\n");
    return koboshi::tools::kBadInput;
  }
  qInstallMessageHandler(take_message);
  QApplication application(argc, argv);
  QApplication::setOrganizationName(QStringLiteral("Koboshi"));
  QApplication::setApplicationName(QStringLiteral("Koboshi Studio"));
  QGuiApplication::setDesktopFileName(QStringLiteral("koboshi-studio"));
  QApplication::setWindowIcon(QIcon::fromTheme(QStringLiteral("koboshi-studio")));
  QApplication::setApplicationVersion(QStringLiteral(KOBOSHI_VERSION));
  const auto translation = koboshi::studio::load_translation(
      QLocale(), QApplication::applicationDirPath() + QStringLiteral("/translations"));
  if (translation) QApplication::installTranslator(translation.get());
  koboshi::studio::MainWindow window(arguments.robot);
  if (arguments.robot_option->count() > 0) window.use_robot_in_scenarios();
  for (const std::filesystem::path& file : arguments.files) window.open(file);
  if (!arguments.can.empty()) window.attach(arguments.can, arguments.transport);
  // The desktop asks at the end of the session; a signal is no question.
  QObject::connect(&application, &QGuiApplication::commitDataRequest, &window,
                   [&window](QSessionManager& session) {
                     const bool may_ask = session.allowsInteraction();
                     if (!window.end_session(may_ask)) session.cancel();
                     if (may_ask) session.release();
                   });
  const koboshi::studio::Termination termination([&window](int signal) {
    window.end();
    QApplication::exit(koboshi::tools::kSignalled + signal);
  });
  window.show();
  return QApplication::exec();
}

}  // namespace

int main(int argc, char** argv) {
  return koboshi::tools::exit_status_of("koboshi studio", {argv, static_cast<std::size_t>(argc)},
                                        [&] { return run_program(argc, argv); });
}
