#include "studio/window/main_window.h"

#include <QAction>
#include <QCloseEvent>
#include <QDockWidget>
#include <QDragEnterEvent>
#include <QFileDialog>
#include <QInputDialog>
#include <QLabel>
#include <QLineEdit>
#include <QMimeData>
#include <QSettings>
#include <QStatusBar>
#include <QVBoxLayout>
#include <utility>

#include "base/text/error.h"
#include "base/text/foreign_text.h"
#include "base/text/text.h"
#include "base/yaml/yaml_tree.h"
#include "simulation/scenario/reader.h"
#include "studio/controls/operator_panel.h"
#include "studio/controls/transport_bar.h"
#include "studio/model/model_panel.h"
#include "studio/motion_editor/motion_panel.h"
#include "studio/plant/plant_panel.h"
#include "studio/widgets/command_search.h"
#include "studio/widgets/keyboard.h"
#include "studio/widgets/message_bar.h"
#include "studio/window/documents.h"
#include "studio/window/model_controller.h"
#include "studio/window/motion_playback.h"
#include "studio/window/panels.h"
#include "studio/window/plant_controller.h"
#include "studio/window/pose_controller.h"
#include "studio/window/tuning_panels.h"
#include "view/render/playback.h"

namespace koboshi::studio {
namespace {

constexpr std::uint64_t kPush_us = 100'000;

enum class FileKind { kScenario, kMotion, kRecording };

// Tells what a file holds. Throws InputError for a file that is none of them.
FileKind kind_of_file(const std::filesystem::path& file) {
  if (std::filesystem::is_directory(file) || extension_of(file) == ".mcap") return FileKind::kRecording;
  const YamlNode document = parse_yaml(read_text_file(file, "a scenario or a motion"), file);
  if (document.find("steps") != nullptr) return FileKind::kMotion;
  if (document.find("duration_s") != nullptr) return FileKind::kScenario;
  throw InputError(file, 0, "neither duration_s nor steps", "a scenario, a motion, or the folder of a run");
}

}  // namespace

MainWindow::MainWindow(const std::filesystem::path& robot)
    : robot_file_(robot),
      run_(new RunController(this)),
      view_(new RobotView),
      messages_(new MessageBar),
      search_(new CommandSearch),
      panels_(new Panels(*this, *run_, *messages_)),
      poses_(new PoseController(*view_, panels_->motion(), *run_, this)),
      models_(new ModelController(*view_, panels_->model(), *run_, this)),
      plants_(new PlantController(*view_, panels_->plant(), *run_, this)),
      playback_(new MotionPlayback(*run_, panels_->motion(), panels_->operator_panel().commands(), *messages_,
                                   robot, this)),
      documents_(new Documents(*this, *panels_)),
      document_name_(new QLabel(this)),
      link_name_(new QLabel(this)) {
  arrange();
  make_menus();
  connect_view();
  connect_documents();
  show_edited_robot();
  documents_->activate(Documents::kMotion);
  show_active_document();
  new Keyboard(*this, *view_);
}

// The panels refer to the controller and to its recording. Children are destroyed in the order of their
// making, and the window's own members before them.
MainWindow::~MainWindow() {
  delete documents_;  // it looks at the panels when the keyboard moves
  for (QDockWidget* dock : findChildren<QDockWidget*>()) delete dock;
}

MotionPanel& MainWindow::motion() { return panels_->motion(); }

ModelPanel& MainWindow::model() { return panels_->model(); }

PlantPanel& MainWindow::plant() { return panels_->plant(); }

// Places the view, the bars and the docks, as they were the last time.
void MainWindow::arrange() {
  auto* centre = new QWidget(this);
  auto* layout = new QVBoxLayout(centre);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->setSpacing(0);
  layout->addWidget(view_, 1);
  layout->addWidget(messages_);
  setCentralWidget(centre);
  addToolBar(Qt::TopToolBarArea, new TransportBar(*run_, this));
  statusBar()->addPermanentWidget(link_name_);
  statusBar()->addPermanentWidget(document_name_);
  document_name_->setObjectName(QStringLiteral("active_document"));
  document_name_->setToolTip(tr("The active document: Save, Undo and Redo act on it"));
  setAcceptDrops(true);
  setDockOptions(AnimatedDocks | AllowNestedDocks | AllowTabbedDocks);
  setCorner(Qt::BottomLeftCorner, Qt::LeftDockWidgetArea);
  setCorner(Qt::BottomRightCorner, Qt::BottomDockWidgetArea);
  resize(1280, 800);
  const auto dock = [this](const char* name) { return findChild<QDockWidget*>(QLatin1String(name)); };
  resizeDocks({dock("operator"), dock("plots")}, {230, 430}, Qt::Horizontal);
  resizeDocks({dock("events")}, {240}, Qt::Vertical);
  panels_->remember_default_layout();
  panels_->restore_layout(QSettings());
}

void MainWindow::connect_view() {
  connect(run_, &RunController::opened, this, &MainWindow::show_opened);
  connect(run_, &RunController::window_moved, this, &MainWindow::show_marks);
  connect(run_, &RunController::grown, this, [this](std::size_t first_sample) {
    if (marks_) marks_->follow(first_sample);
  });
  connect(run_, &RunController::cursor_moved, this, &MainWindow::show_cursor);
  connect(run_, &RunController::rewound, this, [this] { show_marks(); });
  connect(run_, &RunController::failed, messages_, &MessageBar::show_error);
  connect(view_, &RobotView::failed, messages_, &MessageBar::show_error);
  connect(view_, &RobotView::push_requested, this, &MainWindow::push);
  connect(view_, &RobotView::hovered, this, &MainWindow::show_link_name);
  connect(models_, &ModelController::failed, messages_, &MessageBar::show_error);
  connect(models_, &ModelController::restart_requested, &panels_->operator_panel(), &OperatorPanel::restart);
  connect(plants_, &PlantController::restart_requested, &panels_->operator_panel(), &OperatorPanel::restart);
  connect(&motion(), &MotionPanel::pose_changed, poses_, &PoseController::show_pose);
  connect(poses_, &PoseController::told, this,
          [this](const QString& text) { statusBar()->showMessage(text, 3000); });
}

void MainWindow::connect_documents() {
  connect(documents_, &Documents::changed, this, &MainWindow::show_active_document);
  connect(documents_, &Documents::edited, this, [this] { may_close_ = false; });
  connect(documents_, &Documents::told, this, [this](const QString& text) {
    constexpr int kShown_ms = 4000;
    statusBar()->showMessage(text, kShown_ms);
  });
  motion().set_guard([this](std::function<void()> go_on) {
    documents_->settle({Documents::kMotion}, tr("Save the motion before another one is opened?"),
                       std::move(go_on));
  });
}

// Without a run, the view shows the robot of the motion editor.
void MainWindow::show_edited_robot() {
  try {
    if (const auto error = models_->open(robot_file_)) return messages_->show_error(*error);
    const auto robot = std::make_shared<const sim_board::RobotDescription>(model().document()->robot());
    poses_->set_robot(robot);
    view_->set_scene(poses_->ghost()->scene(), &poses_->ghost()->robot());
    if (const auto error = motion().set_robot(robot)) messages_->show_error(*error);
    panels_->tuning().set_robot(*robot);
    models_->follow_run();
  } catch (const std::exception& error) {
    messages_->show_error(QString::fromUtf8(error.what()));
  }
}

void MainWindow::show_link_name(int link) {
  const auto& links = run_->recording().scene.links;
  const auto index = static_cast<std::size_t>(link);
  const bool is_known = link >= 0 && index < links.size();
  link_name_->setText(is_known ? QString::fromStdString(links[index].name) : QString());
}

void MainWindow::choose_file() {
  const QString file = QFileDialog::getOpenFileName(
      this, tr("Open"), QString(), tr("Scenarios, motions and recorded runs (*.yaml *.mcap);;All files (*)"));
  if (!file.isEmpty()) open(std::filesystem::path(file.toStdString()));
}

void MainWindow::choose_bus() {
  bool chosen = false;
  const QString bus = QInputDialog::getText(this, tr("Attach to a CAN bus"),
                                            tr("socketcan:INTERFACE, udp:ADDRESS:PORT or slcan"),
                                            QLineEdit::Normal, bus_, &chosen);
  if (chosen) attach(bus.toStdString(), bus_options_);
}

void MainWindow::attach(const std::string& transport, const sim_board::TransportOptions& options) {
  std::vector<Documents::Kind> replaced;
  if (!panels_->tuning().shows_parameters_of(robot_file_)) replaced.push_back(Documents::kParameters);
  documents_->settle(replaced, tr("Save changes before the robot on the bus is shown?"),
                     [this, transport, options] {
                       bus_ = QString::fromStdString(transport);
                       bus_options_ = options;
                       run_->open_bus(transport, options, robot_file_);
                     });
}

void MainWindow::open(const std::filesystem::path& file) {
  try {
    switch (kind_of_file(file)) {
      case FileKind::kScenario:
        return open_scenario(file);
      case FileKind::kRecording:
        return run_->open_recording(file);
      case FileKind::kMotion:
        return documents_->settle({Documents::kMotion}, tr("Save the motion before another one is opened?"),
                                  [this, file] { open_motion(file); });
    }
  } catch (const std::exception& error) {
    messages_->show_error(QString::fromUtf8(error.what()));
  }
}

void MainWindow::open_motion(const std::filesystem::path& file) {
  if (run_->source() == RunController::Source::kNone)
    view_->set_scene(poses_->ghost()->scene(), &poses_->ghost()->robot());
  if (const auto error = motion().open(file, robot_file_)) return messages_->show_error(*error);
  motion().show_row(0);
  panels_->raise(QStringLiteral("motion"));
}

// A scenario brings the parameters of its robot and its gait, in place of those that are open.
void MainWindow::open_scenario(const std::filesystem::path& file) {
  std::vector<Documents::Kind> replaced;
  if (documents_->is_modified(Documents::kParameters) || documents_->is_modified(Documents::kGait)) {
    const simulation::Scenario scenario = simulation::read_scenario(file, run_->overrides_of_scenarios());
    if (!panels_->tuning().shows_parameters_of(scenario.robot)) replaced.push_back(Documents::kParameters);
    if (scenario.gait && !panels_->tuning().shows_gait(scenario.gait->file))
      replaced.push_back(Documents::kGait);
  }
  const TextDocument* edited = documents_->document(Documents::kScenario);
  if (edited != nullptr && edited->file() != std::filesystem::absolute(file))
    replaced.push_back(Documents::kScenario);
  documents_->settle(replaced, tr("Save changes before the scenario is opened?"),
                     [this, file] { run_->open_scenario(file); });
}

void MainWindow::show_opened() {
  messages_->hide();
  if (const Session* session = run_->session()) {
    const std::string left_out = simulation::left_out_text(session->scenario());
    if (!left_out.empty()) messages_->show_message(QString::fromStdString(left_out), MessageKind::kWarning);
  }
  view_->set_scene(run_->recording().scene, run_->robot());
  view_->set_pushable(run_->session() != nullptr);
  show_marks();
  show_active_document();
}

void MainWindow::show_marks() {
  view::Overlays overlays;
  for (std::size_t i = 0; i < overlay_actions_.size(); ++i)
    if (overlay_actions_[i] != nullptr && overlay_actions_[i]->isChecked())
      overlays.add(static_cast<view::Overlay>(i));
  marks_.emplace(run_->recording(), overlays);
  show_cursor();
}

void MainWindow::show_cursor() {
  const view::Recording& recording = run_->recording();
  if (recording.samples.empty()) return;
  const std::uint64_t time_us = run_->cursor_us();
  view_->show_robot(view::poses_at(recording, time_us), marks_ ? marks_->at(time_us) : view::Marks());
}

void MainWindow::push(int link, const Eigen::Vector3d& p_L_m, const Eigen::Vector3d& force_W_N) {
  const view::Link& pushed = run_->recording().scene.links[static_cast<std::size_t>(link)];
  if (link > 0 && pushed.parent < 0) {  // a loose body
    statusBar()->showMessage(tr("Only links of the robot can be pushed"), 3000);
    return;
  }
  simulation::Push given;
  given.link.text = pushed.name;
  given.shape = simulation::Push::Shape::kHalfSine;
  given.duration_us = kPush_us;
  given.force_W_N = force_W_N;
  given.p_L_m = p_L_m;
  run_->give(std::move(given));
  statusBar()->showMessage(tr("%1 N on %2 for %3 s")
                               .arg(force_W_N.norm(), 0, 'f', 1)
                               .arg(QString::fromStdString(pushed.name))
                               .arg(1e-6 * static_cast<double>(kPush_us)),
                           3000);
}

// In the title, the status line and the names of the panels.
void MainWindow::show_active_document() {
  const Documents::Kind active = documents_->active();
  const auto marked = [this](Documents::Kind kind) {
    return documents_->file_name(kind) + (documents_->is_modified(kind) ? QStringLiteral("*") : QString());
  };
  QStringList parts;
  if (documents_->document(active) != nullptr) parts << marked(active);
  for (const Documents::Kind kind : documents_->unsaved())
    if (kind != active) parts << marked(kind);
  const QString shown = QString::fromStdString(run_->file().filename().string());
  const bool is_named = !parts.isEmpty() && active == Documents::kScenario && parts.front().startsWith(shown);
  if (!shown.isEmpty() && !is_named) parts << shown;
  parts << QStringLiteral("Koboshi Studio");
  setWindowTitle(parts.join(QStringLiteral(" - ")));
  const QString name = documents_->kind_name(active);
  document_name_->setText(documents_->document(active) != nullptr
                              ? QStringLiteral("%1: %2").arg(name, marked(active))
                              : tr("%1: none").arg(name));
  const auto mark = [&](Documents::Kind kind, Documents::Kind other) {
    panels_->mark(documents_->dock(kind), documents_->is_modified(kind) || documents_->is_modified(other),
                  active == kind || active == other);
  };
  mark(Documents::kMotion, Documents::kMotion);
  mark(Documents::kRobot, Documents::kRobot);
  mark(Documents::kParameters, Documents::kGait);
  mark(Documents::kScenario, Documents::kScenario);
}

void MainWindow::closeEvent(QCloseEvent* event) {
  documents_->take_typed();
  if (!may_close_ && !documents_->unsaved().empty()) {
    event->ignore();
    return documents_->settle(documents_->unsaved(), tr("Save changes before closing?"), [this] {
      may_close_ = true;
      close();
    });
  }
  QSettings settings;
  panels_->save_layout(settings);
  QMainWindow::closeEvent(event);
}

void MainWindow::end() {
  documents_->keep_recoveries();
  may_close_ = true;
  close();
}

bool MainWindow::end_session(bool may_ask) {
  if (may_ask && !documents_->settle_now(tr("Save changes before the session ends?"))) return false;
  if (!may_ask) documents_->keep_recoveries();
  may_close_ = true;
  return true;
}

void MainWindow::dragEnterEvent(QDragEnterEvent* event) {
  if (event->mimeData()->hasUrls()) event->acceptProposedAction();
}

void MainWindow::dropEvent(QDropEvent* event) {
  for (const QUrl& url : event->mimeData()->urls())
    if (url.isLocalFile()) open(url.toLocalFile().toStdString());
}

}  // namespace koboshi::studio
