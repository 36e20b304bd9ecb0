#include "tools/studio/window/main_window.h"

#include <QAction>
#include <QActionGroup>
#include <QCloseEvent>
#include <QCoreApplication>
#include <QDockWidget>
#include <QDragEnterEvent>
#include <QFileDialog>
#include <QHeaderView>
#include <QInputDialog>
#include <QLabel>
#include <QLineEdit>
#include <QMenuBar>
#include <QMimeData>
#include <QPointer>
#include <QScrollArea>
#include <QScrollBar>
#include <QSettings>
#include <QStandardItemModel>
#include <QStatusBar>
#include <QTableView>
#include <QThreadPool>
#include <QVBoxLayout>
#include <algorithm>
#include <numbers>
#include <ranges>
#include <utility>

#include "sim_board/input/error.h"
#include "sim_board/input/text.h"
#include "sim_board/input/yaml_tree.h"
#include "sim_board/record/output_file.h"
#include "tools/dictionary/network.h"
#include "tools/motion/check/check.h"
#include "tools/motion/stage/stage.h"
#include "tools/motion/view/preview.h"
#include "tools/studio/motion/motion_panel.h"
#include "tools/studio/plot/plot_panel.h"
#include "tools/studio/window/can_panel.h"
#include "tools/studio/window/command_search.h"
#include "tools/studio/window/message_bar.h"
#include "tools/studio/window/motion_upload.h"
#include "tools/studio/window/object_panel.h"
#include "tools/studio/window/operator_panel.h"
#include "tools/studio/window/pose_controller.h"
#include "tools/studio/window/theme.h"
#include "tools/studio/window/transport_bar.h"
#include "tools/view/render/playback.h"
#include "tools/view/replay/replay_page.h"

namespace koboshi::studio {
namespace {

constexpr int kCanPeriod_ms = 200;
constexpr std::uint64_t kPush_us = 100'000;
constexpr int kLayoutVersion = 2;  // of the saved layout: another one is ignored

enum class FileKind { kScenario, kMotion, kRecording };

// Tells what a file holds. Throws sim::InputError for a file that is none of them.
FileKind kind_of_file(const std::filesystem::path& file) {
  if (std::filesystem::is_directory(file) || file.extension() == ".mcap") return FileKind::kRecording;
  const sim::YamlNode document = sim::parse_yaml(sim::read_text_file(file, "a scenario or a motion"), file);
  if (document.find("steps") != nullptr) return FileKind::kMotion;
  if (document.find("duration_s") != nullptr) return FileKind::kScenario;
  throw sim::InputError(file, 0, "neither duration_s nor steps",
                        "a scenario, a motion, or the folder of a run");
}

}  // namespace

MainWindow::MainWindow(const std::filesystem::path& robot)
    : robot_file_(robot),
      run_(new RunController(this)),
      view_(new RobotView),
      messages_(new MessageBar),
      search_(new CommandSearch) {
  auto* centre = new QWidget(this);
  auto* layout = new QVBoxLayout(centre);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->setSpacing(0);
  layout->addWidget(view_, 1);
  layout->addWidget(messages_);
  setCentralWidget(centre);
  setAcceptDrops(true);
  setDockOptions(AnimatedDocks | AllowNestedDocks | AllowTabbedDocks);
  setCorner(Qt::BottomLeftCorner, Qt::LeftDockWidgetArea);
  setCorner(Qt::BottomRightCorner, Qt::BottomDockWidgetArea);
  make_panels();
  make_menus();
  link_name_ = new QLabel(this);
  statusBar()->addPermanentWidget(link_name_);
  connect_run();
  resize(1280, 800);
  const auto dock = [this](const char* name) { return findChild<QDockWidget*>(QLatin1String(name)); };
  resizeDocks({dock("operator"), dock("plots")}, {230, 430}, Qt::Horizontal);
  resizeDocks({dock("events")}, {240}, Qt::Vertical);
  default_layout_ = saveState(kLayoutVersion);
  restore_layout();
  try {
    poses_->set_robot(robot_file_);
    view_->set_scene(poses_->ghost()->scene(), &poses_->ghost()->robot());
    if (const auto error = motion_->set_robot(robot_file_)) messages_->show_message(*error);
  } catch (const std::exception& error) {
    messages_->show_message(QString::fromUtf8(error.what()));
  }
  update_title();
  can_timer_.setInterval(kCanPeriod_ms);
  connect(&can_timer_, &QTimer::timeout, this, [this] {
    if (can_->isVisible() && run_->playing()) {
      can_->show_nodes(run_->status());
      can_->update_frames();
      can_->set_cursor(run_->cursor_us());
    }
  });
  can_timer_.start();
}

// The panels refer to the recording of the controller, and children are destroyed in the order of their
// making.
MainWindow::~MainWindow() { can_->set_recording(nullptr, {}); }

QDockWidget* MainWindow::add_panel(const QString& name, const QString& title, QWidget* widget,
                                   Qt::DockWidgetArea area) {
  auto* dock = new QDockWidget(title, this);
  dock->setObjectName(name);
  dock->setWidget(widget);
  addDockWidget(area, dock);
  return dock;
}

void MainWindow::make_panels() {
  addToolBar(Qt::TopToolBarArea, new TransportBar(*run_, this));
  operator_ = new OperatorPanel(*run_);
  auto* scrolled = new QScrollArea;
  scrolled->setWidget(operator_);
  scrolled->setWidgetResizable(true);
  scrolled->setFrameShape(QFrame::NoFrame);
  scrolled->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
  scrolled->setMinimumWidth(operator_->minimumSizeHint().width() +
                            scrolled->verticalScrollBar()->sizeHint().width());
  add_panel(QStringLiteral("operator"), tr("Operator"), scrolled, Qt::LeftDockWidgetArea);
  motion_ = new MotionPanel;
  auto* motion_dock = add_panel(QStringLiteral("motion"), tr("Motion"), motion_, Qt::BottomDockWidgetArea);
  poses_ = new PoseController(*view_, *motion_, *run_, this);
  plots_ = new PlotPanel;
  add_panel(QStringLiteral("plots"), tr("Plots"), plots_, Qt::RightDockWidgetArea);
  events_ = new QStandardItemModel(0, 2, this);
  events_->setHorizontalHeaderLabels({tr("Time [s]"), tr("Event")});
  event_table_ = new QTableView;
  event_table_->setModel(events_);
  event_table_->setEditTriggers(QAbstractItemView::NoEditTriggers);
  event_table_->setSelectionBehavior(QAbstractItemView::SelectRows);
  event_table_->verticalHeader()->hide();
  event_table_->verticalHeader()->setDefaultSectionSize(event_table_->fontMetrics().height() + 6);
  event_table_->horizontalHeader()->setStretchLastSection(true);
  event_table_->setAccessibleName(tr("Events"));
  auto* event_dock =
      add_panel(QStringLiteral("events"), tr("Events"), event_table_, Qt::BottomDockWidgetArea);
  can_ = new CanPanel;
  auto* can_dock = add_panel(QStringLiteral("can"), tr("CAN bus"), can_, Qt::BottomDockWidgetArea);
  objects_ = new ObjectPanel;
  auto* object_dock =
      add_panel(QStringLiteral("objects"), tr("Object dictionary"), objects_, Qt::BottomDockWidgetArea);
  tabifyDockWidget(event_dock, can_dock);
  tabifyDockWidget(event_dock, object_dock);
  tabifyDockWidget(event_dock, motion_dock);
  event_dock->raise();
}

void MainWindow::connect_run() {
  connect(run_, &RunController::opened, this, &MainWindow::show_opened);
  connect(run_, &RunController::grown, this, &MainWindow::show_grown);
  connect(run_, &RunController::rewound, this, [this](std::uint64_t time_us) {
    plots_->truncate_after(time_us);
    objects_->forget_requests();
  });
  connect(run_, &RunController::answered, objects_, &ObjectPanel::take_answer);
  connect(objects_, &ObjectPanel::requested, run_,
          [this](const sim::ObjectRequest& request) { run_->give(request); });
  connect(run_, &RunController::cursor_moved, this, &MainWindow::show_cursor);
  connect(run_, &RunController::status_changed, this, &MainWindow::repeat_playback);
  connect(run_, &RunController::status_changed, this, [this] {
    if (!run_->playing()) can_->show_nodes(run_->status());
  });
  connect(run_, &RunController::failed, messages_, &MessageBar::show_message);
  connect(view_, &RobotView::failed, messages_, &MessageBar::show_message);
  connect(view_, &RobotView::push_requested, this, &MainWindow::push);
  connect(view_, &RobotView::hovered, this, [this](int link) {
    const auto& links = run_->recording().scene.links;
    const auto index = static_cast<std::size_t>(link);
    link_name_->setText(link >= 0 && index < links.size() ? QString::fromStdString(links[index].name)
                                                          : QString());
  });
  connect(plots_, &PlotPanel::cursor_moved, run_, &RunController::set_cursor);
  connect(can_, &CanPanel::cursor_moved, run_, &RunController::set_cursor);
  connect(event_table_, &QTableView::clicked, this, [this](const QModelIndex& index) {
    run_->set_cursor(run_->recording().events[static_cast<std::size_t>(index.row())].time_us);
  });
  connect(motion_, &MotionPanel::title_changed, this, [this] {
    warned_of_changes_ = false;
    update_title();
  });
  connect(motion_, &MotionPanel::pose_changed, poses_, &PoseController::show_pose);
  connect(poses_, &PoseController::told, this,
          [this](const QString& text) { statusBar()->showMessage(text, 3000); });
  connect(motion_, &MotionPanel::play_requested, this, &MainWindow::play_motion);
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
  if (chosen) attach(bus.toStdString(), real_bus_);
}

void MainWindow::attach(const std::string& transport, bool real_bus) {
  bus_ = QString::fromStdString(transport);
  real_bus_ = real_bus;
  run_->open_bus(transport, real_bus, robot_file_);
}

// Uploads the motion as it is in the editor, in another thread.
void MainWindow::upload_motion() {
  const auto copy = write_played_motion(motion_->text());
  if (!copy) return;
  const QPointer<MainWindow> self(this);
  const MotionUpload upload{*copy, robot_file_, bus_.toStdString(), real_bus_};
  QThreadPool::globalInstance()->start([self, upload] {
    QString result;
    try {
      result = QString::fromStdString(studio::upload(upload));
    } catch (const std::exception& error) {
      result = QString::fromUtf8(error.what()).trimmed();
    }
    // The application outlives its thread pool; the window may be gone.
    QMetaObject::invokeMethod(
        QCoreApplication::instance(),
        [self, result] {
          if (self) self->messages_->show_message(result);
        },
        Qt::QueuedConnection);
  });
}

// Writes a text of the editor beside the other motions that are played before they are saved.
std::optional<std::filesystem::path> MainWindow::write_played_motion(const std::string& text) {
  const std::filesystem::path name = motion_->file().empty() ? "untitled.yaml" : motion_->file().filename();
  const std::filesystem::path copy = std::filesystem::path(played_.path().toStdString()) / name;
  try {
    sim::write_whole_file(copy, text);
  } catch (const std::exception& error) {
    messages_->show_message(QString::fromUtf8(error.what()));
    return std::nullopt;
  }
  return copy;
}

void MainWindow::open(const std::filesystem::path& file) {
  try {
    switch (kind_of_file(file)) {
      case FileKind::kScenario:
        return run_->open_scenario(file);
      case FileKind::kRecording:
        return run_->open_recording(file);
      case FileKind::kMotion:
        if (run_->source() == RunController::Source::kNone)
          view_->set_scene(poses_->ghost()->scene(), &poses_->ghost()->robot());
        if (const auto error = motion_->open(file, robot_file_)) return messages_->show_message(*error);
        motion_->show_row(0);
        findChild<QDockWidget*>(QStringLiteral("motion"))->raise();
        return;
    }
  } catch (const std::exception& error) {
    messages_->show_message(QString::fromUtf8(error.what()));
  }
}

void MainWindow::show_opened() {
  messages_->hide();
  const view::Recording& recording = run_->recording();
  view_->set_scene(recording.scene, run_->robot());
  view_->set_pushable(run_->session() != nullptr);
  plots_->set_signals(recording.signals);
  plots_->set_follow(run_->robot() != nullptr);
  events_->setRowCount(0);
  shown_events_ = 0;
  can_->set_recording(&recording, run_->robot() != nullptr ? tools::make_network(*run_->robot())
                                                           : view::network_of(recording, tools::Network()));
  can_->show_nodes(run_->status());
  objects_->set_robot(run_->robot());
  show_marks();
  update_title();
  if (std::exchange(play_when_opened_, false)) {
    play_opened();
  } else {
    play_from_us_ = 0;
  }
}

// The controller moves the cursor to the first sample after this.
void MainWindow::play_opened() {
  QMetaObject::invokeMethod(
      this,
      [this] {
        if (run_->session() == nullptr) run_->set_cursor(play_from_us_);
        run_->set_playing(true);
      },
      Qt::QueuedConnection);
}

// A playback has stopped by itself when it is at its end; a simulation goes on without end.
void MainWindow::repeat_playback() {
  const bool is_playback = run_->session() == nullptr && run_->end_us() > play_from_us_;
  if (std::exchange(was_playing_, run_->playing()) && is_playback && loop_->isChecked() && !run_->playing() &&
      run_->cursor_us() >= run_->end_us())
    play_opened();
}

void MainWindow::show_grown(std::size_t first_sample) {
  const view::Recording& recording = run_->recording();
  for (std::size_t i = first_sample; i < recording.samples.size(); ++i)
    plots_->append(recording.samples[i].time_us, recording.samples[i].values);
  show_events();
  if (!run_->playing()) can_->update_frames();
}

void MainWindow::show_events() {
  const auto& events = run_->recording().events;
  const auto row_text = [&](std::size_t i) { return QString::fromStdString(events[i].text); };
  const bool kept = shown_events_ <= events.size() &&
                    std::ranges::all_of(std::views::iota(std::size_t{0}, shown_events_), [&](std::size_t i) {
                      return events_->item(static_cast<int>(i), 1)->text() == row_text(i);
                    });
  if (kept && shown_events_ == events.size()) return;
  if (!kept) {
    events_->setRowCount(0);
    shown_events_ = 0;
  }
  for (; shown_events_ < events.size(); ++shown_events_) {
    auto* time =
        new QStandardItem(QString::number(1e-6 * static_cast<double>(events[shown_events_].time_us), 'f', 3));
    time->setTextAlignment(Qt::AlignRight | Qt::AlignVCenter);
    auto* text = new QStandardItem(row_text(shown_events_));
    text->setToolTip(text->text());
    events_->appendRow({time, text});
    plots_->add_event(events[shown_events_].time_us, text->text());
  }
  event_table_->scrollToBottom();
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
  const std::uint64_t time_us = run_->cursor_us();
  if (!recording.samples.empty()) {
    view_->show_robot(view::poses_at(recording, time_us), marks_ ? marks_->at(time_us) : view::Marks());
  }
  plots_->set_cursor(time_us);
  if (!run_->playing()) can_->set_cursor(time_us);
}

void MainWindow::push(int link, const Eigen::Vector3d& p_L_m, const Eigen::Vector3d& force_W_N) {
  sim::Push given;
  given.link.text = run_->recording().scene.links[static_cast<std::size_t>(link)].name;
  given.shape = sim::Push::Shape::kHalfSine;
  given.duration_us = kPush_us;
  given.force_W_N = force_W_N;
  given.p_L_m = p_L_m;
  run_->give(std::move(given));
  statusBar()->showMessage(
      tr("%1 N on %2 for %3 s")
          .arg(force_W_N.norm(), 0, 'f', 1)
          .arg(QString::fromStdString(run_->recording().scene.links[static_cast<std::size_t>(link)].name))
          .arg(1e-6 * static_cast<double>(kPush_us)),
      3000);
}

// Plays the text of the motion as it is in the editor, saved or not.
void MainWindow::play_motion(bool physics, int from_row) {
  const auto row = static_cast<std::size_t>(from_row);
  const auto copy = write_played_motion(physics ? motion_->text_from(row) : motion_->text());
  if (!copy) return;
  run_->open(copy->filename(), [copy = *copy, physics, robot = robot_file_]() -> RunController::Opened {
    tools::MotionChecker checker(robot);
    const tools::MotionReport report = checker.check(copy);
    if (!physics) return {nullptr, tools::preview_recording(report, checker)};
    return {std::make_unique<Session>(tools::stage_scenario(copy, report)), {}};
  });
  play_when_opened_ = true;
  play_from_us_ = physics ? 0 : motion_->start_us(row);
}

void MainWindow::update_title() {
  QStringList parts;
  if (!run_->file().empty()) parts << QString::fromStdString(run_->file().filename().string());
  if (!motion_->file().empty())
    parts << QString::fromStdString(motion_->file().filename().string()) +
                 (motion_->modified() ? QStringLiteral("*") : QString());
  parts << QStringLiteral("Koboshi Studio");
  setWindowTitle(parts.join(QStringLiteral(" - ")));
}

void MainWindow::restore_layout() {
  const QSettings settings;
  restoreGeometry(settings.value(QStringLiteral("geometry")).toByteArray());
  restoreState(settings.value(QStringLiteral("layout")).toByteArray(), kLayoutVersion);
  plots_->restore_layout(settings.value(QStringLiteral("plots")));
}

void MainWindow::reset_layout() { restoreState(default_layout_, kLayoutVersion); }

void MainWindow::closeEvent(QCloseEvent* event) {
  if (motion_->modified() && !std::exchange(warned_of_changes_, true)) {
    messages_->show_message(
        tr("The motion has changes that are not saved. Save them (Ctrl+S), or close again to discard them."));
    return event->ignore();
  }
  QSettings settings;
  settings.setValue(QStringLiteral("geometry"), saveGeometry());
  settings.setValue(QStringLiteral("layout"), saveState(kLayoutVersion));
  settings.setValue(QStringLiteral("plots"), plots_->layout_state());
  QMainWindow::closeEvent(event);
}

void MainWindow::dragEnterEvent(QDragEnterEvent* event) {
  if (event->mimeData()->hasUrls()) event->acceptProposedAction();
}

void MainWindow::dropEvent(QDropEvent* event) {
  for (const QUrl& url : event->mimeData()->urls())
    if (url.isLocalFile()) open(url.toLocalFile().toStdString());
}

}  // namespace koboshi::studio
