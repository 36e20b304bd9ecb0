#include <QApplication>
#include <QSessionManager>
#include <QTranslator>

#include <CLI/CLI.hpp>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "sim_board/input/text.h"
#include "sim_board/record/standard_streams.h"
#include "tools/cli/transport_options.h"
#include "tools/run/exit_status.h"
#include "tools/studio/window/main_window.h"
#include "tools/studio/window/termination.h"
#include "tools/studio/window/translation.h"

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
  if (type != QtFatalMsg) return koboshi::sim::print_error("{}\n", text.toStdString());
  koboshi::sim::print_error("koboshi studio: {}\n", koboshi::sim::one_line(text.toStdString()));
  std::_Exit(koboshi::tools::kBadInput);
}

int run_program(int argc, char** argv) {
  CLI::App program("Koboshi Studio: run, watch and push the robot, and edit its motions.", "koboshi studio");
  program.set_version_flag("--version", "koboshi studio " KOBOSHI_VERSION);
  std::vector<std::filesystem::path> files;
  std::filesystem::path robot = "robots/koboshi/robot.sdf";
  program.add_option("FILE", files, "Scenarios, motions, and folders or files of recorded runs to open")
      ->type_name("")
      ->check(CLI::ExistingPath.description(""));
  auto* robot_option =
      program
          .add_option("--robot", robot,
                      "The robot that is edited, and with which scenarios start instead of their own")
          ->type_name("ROBOT")
          ->capture_default_str()
          ->check(CLI::ExistingFile.description(""));
  std::string can;
  koboshi::sim::TransportOptions transport;
  auto* can_option =
      program
          .add_option("--can", can, "Follow a robot on a bus: socketcan:INTERFACE, udp:ADDRESS:PORT or slcan")
          ->type_name("BUS");
  for (CLI::Option* option : koboshi::tools::add_transport_options(program, transport))
    option->needs(can_option);
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return program.exit(error) == 0 ? 0 : koboshi::tools::kBadInput;
  }
  if (!has_display()) {
    koboshi::sim::print_error(
        "koboshi studio: no display here; `koboshi replay RUN --html` writes replay.html, which shows "
        "a recorded run in a browser elsewhere\n");
    return koboshi::tools::kBadInput;
  }
  qInstallMessageHandler(take_message);
  QApplication application(argc, argv);
  QApplication::setOrganizationName(QStringLiteral("Koboshi"));
  QApplication::setApplicationName(QStringLiteral("Koboshi Studio"));
  QApplication::setApplicationVersion(QStringLiteral(KOBOSHI_VERSION));
  const auto translation = koboshi::studio::load_translation(
      QLocale(), QApplication::applicationDirPath() + QStringLiteral("/translations"));
  if (translation) QApplication::installTranslator(translation.get());
  koboshi::studio::MainWindow window(robot);
  if (robot_option->count() > 0) window.use_robot_in_scenarios();
  for (const std::filesystem::path& file : files) window.open(file);
  if (!can.empty()) window.attach(can, transport);
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
