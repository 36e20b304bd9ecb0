#include "studio/window/panels.h"

#include <QAction>
#include <QDockWidget>
#include <QMainWindow>
#include <QMenu>
#include <QMenuBar>
#include <QScrollArea>
#include <QScrollBar>
#include <QSettings>
#include <algorithm>

#include "bus/dictionary/network.h"
#include "studio/controls/operator_panel.h"
#include "studio/controls/run_controller.h"
#include "studio/model/model_panel.h"
#include "studio/motion_editor/motion_panel.h"
#include "studio/panels/can_panel.h"
#include "studio/panels/event_panel.h"
#include "studio/panels/log_panel.h"
#include "studio/panels/object_panel.h"
#include "studio/plant/plant_panel.h"
#include "studio/plot/plot_panel.h"
#include "studio/soles/sole_panel.h"
#include "studio/tuning/compare_panel.h"
#include "studio/tuning/parameter_panel.h"
#include "studio/tuning/study_panel.h"
#include "studio/widgets/message_bar.h"
#include "studio/window/tuning_panels.h"
#include "view/replay/replay_page.h"

namespace koboshi::studio {
namespace {

constexpr int kCanPeriod_ms = 200;
constexpr int kLayoutVersion = 3;  // of the saved layout: another one is ignored

QScrollArea* scrolled(QWidget* panel) {
  auto* area = new QScrollArea;
  area->setWidget(panel);
  area->setWidgetResizable(true);
  area->setFrameShape(QFrame::NoFrame);
  area->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
  area->setMinimumWidth(panel->minimumSizeHint().width() + area->verticalScrollBar()->sizeHint().width());
  return area;
}

}  // namespace

Panels::Panels(QMainWindow& window, RunController& run, MessageBar& messages)
    : QObject(&window),
      window_(window),
      run_(run),
      messages_(messages),
      tuning_(new TuningPanels(run, this)) {
  make();
  connect_run();
  can_timer_.setInterval(kCanPeriod_ms);
  connect(&can_timer_, &QTimer::timeout, this, &Panels::update_bus);
  can_timer_.start();
}

// The panels refer to the recording of the controller, which may be destroyed before them.
Panels::~Panels() { can_timer_.stop(); }

void Panels::make() {
  // Panels of one area share it as tabs in this order; the first is in front.
  add(operator_ = new OperatorPanel(run_), {.name = QStringLiteral("operator"),
                                            .title = tr("Operator"),
                                            .area = Qt::LeftDockWidgetArea,
                                            .is_scrolled = true});
  add(plots_ = new PlotPanel,
      {.name = QStringLiteral("plots"), .title = tr("Plots"), .area = Qt::RightDockWidgetArea});
  add(soles_ = new SolePanel,
      {.name = QStringLiteral("soles"), .title = tr("Soles"), .area = Qt::RightDockWidgetArea});
  add(model_ = new ModelPanel,
      {.name = QStringLiteral("model"), .title = tr("Model"), .area = Qt::RightDockWidgetArea});
  add(events_ = new EventPanel, {.name = QStringLiteral("events"), .title = tr("Events")});
  add(can_ = new CanPanel, {.name = QStringLiteral("can"), .title = tr("CAN bus")});
  add(objects_ = new ObjectPanel, {.name = QStringLiteral("objects"), .title = tr("Object dictionary")});
  add(motion_ = new MotionPanel, {.name = QStringLiteral("motion"), .title = tr("Motion")});
  add(&tuning_->parameters(), {.name = QStringLiteral("parameters"),
                               .title = tr("Parameters"),
                               .area = Qt::RightDockWidgetArea,
                               .menu = tr("Para&meters")});
  add(&tuning_->comparison(), {.name = QStringLiteral("comparison"), .title = tr("Comparison")});
  add(&tuning_->studies(), {.name = QStringLiteral("studies"), .title = tr("Studies")});
  add(log_ = new LogPanel, {.name = QStringLiteral("messages"), .title = tr("Messages")});
  // The last one, so that the keys of the others stay.
  add(plant_ = new PlantPanel, {.name = QStringLiteral("plant"),
                                .title = tr("Plant"),
                                .area = Qt::RightDockWidgetArea,
                                .menu = tr("Pla&nt")});
  connect(&messages_, &MessageBar::told, log_, &LogPanel::add);
  connect(motion_, &MotionPanel::told, log_, &LogPanel::add);
  connect(model_, &ModelPanel::told, log_, &LogPanel::add);
  connect(plant_, &PlantPanel::told, log_, &LogPanel::add);
  connect(&tuning_->parameters(), &ParameterPanel::told, log_, &LogPanel::add);
  connect(tuning_, &TuningPanels::told, &messages_, &MessageBar::show_message);
  connect(tuning_, &TuningPanels::restart_wanted, operator_, &OperatorPanel::restart);
}

void Panels::add(QWidget* panel, const Place& place) {
  auto* dock = new QDockWidget(place.title, &window_);
  dock->setObjectName(place.name);
  dock->setWidget(place.is_scrolled ? scrolled(panel) : panel);
  const auto neighbour = std::ranges::find_if(
      docks_, [&](const Dock& other) { return window_.dockWidgetArea(other.dock) == place.area; });
  window_.addDockWidget(place.area, dock);
  if (neighbour != docks_.end()) {
    window_.tabifyDockWidget(neighbour->dock, dock);
    neighbour->dock->raise();
  }
  docks_.push_back({dock, panel, place.title, place.menu});
}

void Panels::raise(const QString& name) {
  for (const Dock& dock : docks_) {
    if (dock.dock->objectName() != name) continue;
    dock.dock->show();
    dock.dock->raise();
    Q_EMIT shown(dock.panel);
  }
}

void Panels::mark(const QString& name, bool is_modified, bool is_active) {
  for (const Dock& dock : docks_) {
    if (dock.dock->objectName() != name) continue;
    QString title = dock.title;
    if (is_modified) title += QLatin1Char('*');
    if (is_active) title.prepend(QStringLiteral("\u25B8 "));
    if (dock.dock->windowTitle() == title) return;
    dock.dock->setWindowTitle(title);
    dock.dock->toggleViewAction()->setText(dock.title);  // of the menu, and of the search for commands
  }
}

// A key brings a panel to the front, also one that another panel of its place hides; the key of a panel that
// is in front closes it.
void Panels::show_or_close(const Dock& dock) {
  const bool is_in_front = !dock.dock->isHidden() && !dock.dock->visibleRegion().isEmpty();
  if (is_in_front) {
    dock.dock->close();
    return;
  }
  raise(dock.dock->objectName());
  dock.panel->setFocus(Qt::ShortcutFocusReason);
}

void Panels::fill_menu(QMenu& menu) {
  // Alt+1 to Alt+9, and then Ctrl+Shift+F1 on: Alt+0 is the default layout.
  constexpr int kDigits = 9;
  int count = 0;
  for (const Dock& dock : docks_) {
    auto* show = new QAction(dock.title, this);
    show->setCheckable(true);
    show->setShortcut(QKeySequence(count < kDigits
                                       ? Qt::ALT | Qt::Key(Qt::Key_1 + count)
                                       : Qt::CTRL | Qt::SHIFT | Qt::Key(Qt::Key_F1 + count - kDigits)));
    ++count;
    const auto check = [show, dock = dock.dock] { show->setChecked(!dock->isHidden()); };
    connect(dock.dock, &QDockWidget::visibilityChanged, show, check);
    connect(show, &QAction::triggered, this, [this, &dock, check] {
      show_or_close(dock);
      check();
    });
    menu.addAction(show);
  }
  QAction* reset = menu.addAction(tr("&Default layout"));
  reset->setShortcut(QKeySequence(Qt::ALT | Qt::Key_0));
  connect(reset, &QAction::triggered, this,
          [this] { window_.restoreState(default_layout_, kLayoutVersion); });
}

void Panels::add_menus(QMenuBar& bar) {
  for (const Dock& dock : docks_)
    if (!dock.menu.isEmpty()) bar.addMenu(dock.menu)->addActions(dock.panel->actions());
}

void Panels::remember_default_layout() { default_layout_ = window_.saveState(kLayoutVersion); }

void Panels::restore_layout(const QSettings& settings) {
  window_.restoreGeometry(settings.value(QStringLiteral("geometry")).toByteArray());
  window_.restoreState(settings.value(QStringLiteral("layout")).toByteArray(), kLayoutVersion);
  plots_->restore_layout(settings.value(QStringLiteral("plots")));
}

void Panels::save_layout(QSettings& settings) const {
  settings.setValue(QStringLiteral("geometry"), window_.saveGeometry());
  settings.setValue(QStringLiteral("layout"), window_.saveState(kLayoutVersion));
  settings.setValue(QStringLiteral("plots"), plots_->layout_state());
}

void Panels::connect_run() {
  connect(&run_, &RunController::opened, this, &Panels::show_opened);
  connect(&run_, &RunController::grown, this, &Panels::show_grown);
  connect(&run_, &RunController::window_moved, can_, &CanPanel::reset_frames);
  connect(&run_, &RunController::overview_read, this, &Panels::show_overview);
  connect(&run_, &RunController::rewound, this, [this](std::uint64_t time_us) {
    plots_->truncate_after(time_us);
    can_->reset_frames();
    objects_->forget_requests();
  });
  connect(&run_, &RunController::answered, objects_, &ObjectPanel::take_answer);
  connect(objects_, &ObjectPanel::requested, &run_,
          [this](const simulation::ObjectRequest& request) { run_.give(request); });
  connect(&run_, &RunController::cursor_moved, this, &Panels::show_cursor);
  connect(&run_, &RunController::status_changed, this, [this] {
    if (!run_.playing()) can_->show_nodes(run_.status());
  });
  connect(plots_, &PlotPanel::cursor_moved, &run_, &RunController::set_cursor);
  connect(can_, &CanPanel::cursor_moved, &run_, &RunController::set_cursor);
  connect(events_, &EventPanel::cursor_moved, &run_, &RunController::set_cursor);
  connect(events_, &EventPanel::added, plots_, &PlotPanel::add_event);
}

void Panels::show_opened() {
  const view::Recording& recording = run_.recording();
  soles_->set_recording(&recording);
  plots_->set_signals(recording.signals);
  plots_->set_follow(run_.robot() != nullptr);
  events_->forget();
  can_->set_recording(&recording,
                      run_.robot() != nullptr ? bus::make_network(*run_.robot())
                                              : view::network_of(recording, bus::Network()),
                      run_.is_windowed());
  can_->show_nodes(run_.status());
  objects_->set_robot(run_.robot());
}

void Panels::show_grown(std::size_t first_sample) {
  const view::Recording& recording = run_.recording();
  for (std::size_t i = first_sample; i < recording.samples.size(); ++i)
    plots_->append(recording.samples[i].time_us, recording.samples[i].values);
  events_->show_events(recording.events);
  if (!run_.playing()) can_->update_frames();
}

void Panels::show_overview(const std::vector<view::Recording>& blocks) {
  for (const view::Recording& block : blocks)
    for (const view::Sample& sample : block.samples) plots_->append(sample.time_us, sample.values);
  events_->show_events(run_.recording().events);
}

void Panels::show_cursor() {
  plots_->set_cursor(run_.cursor_us());
  soles_->set_cursor(run_.cursor_us());
  if (!run_.playing()) can_->set_cursor(run_.cursor_us());
}

void Panels::update_bus() {
  if (!can_->isVisible() || !run_.playing()) return;
  can_->show_nodes(run_.status());
  can_->update_frames();
  can_->set_cursor(run_.cursor_us());
}

}  // namespace koboshi::studio
