#include "studio/controls/operator_commands.h"

#include <QComboBox>
#include <QEvent>
#include <QFormLayout>
#include <QGridLayout>
#include <QGroupBox>
#include <QLabel>
#include <QPushButton>
#include <QVBoxLayout>
#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>

#include "simulation/assembly/parameters.h"
#include "studio/controls/run_controller.h"
#include "studio/widgets/spin_box.h"
#include "view/render/playback.h"

namespace koboshi::studio {
namespace {

constexpr int kTick_ms = 20;

double metres_per_s(std::int16_t thousandths) { return 1e-3 * static_cast<double>(thousandths); }

}  // namespace

OperatorCommands::OperatorCommands(RunController& run, QWidget* parent)
    : QWidget(parent),
      run_(run),
      gamepads_(open_gamepads()),
      motion_(new QComboBox),
      forward_(number_box(-0.3, 0.3, 0.02, 0.1, QStringLiteral("m/s"), tr("Forward velocity, in m/s"))),
      left_(number_box(-0.2, 0.2, 0.02, 0.0, QStringLiteral("m/s"), tr("Velocity to the left, in m/s"))),
      turn_(number_box(-1.5, 1.5, 0.1, 0.0, QStringLiteral("rad/s"),
                       tr("Turning rate in rad/s, counter-clockwise from above"))),
      walk_(new QPushButton(tr("Walk"))),
      deadline_(new QLabel),
      gamepad_(new QLabel) {
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(0, 0, 0, 0);
  add_commands();
  add_walk();
  connect(&run_, &RunController::opened, this, &OperatorCommands::show_source);
  connect(&run_, &RunController::answered, this, &OperatorCommands::take_answer);
  connect(&run_, &RunController::rewound, this, &OperatorCommands::forget_motions_after);
  clock_.start();
  timer_.setInterval(kTick_ms);
  connect(&timer_, &QTimer::timeout, this, &OperatorCommands::tick);
  timer_.start();
  show_source();
}

OperatorCommands::~OperatorCommands() = default;

QPushButton* OperatorCommands::button(const QString& text, const QString& tip,
                                      simulation::Command::Kind kind) {
  auto* made = new QPushButton(text);
  made->setToolTip(tip);
  connect(made, &QPushButton::clicked, this, [this, kind] {
    held_.release();
    simulation::Command given;
    given.kind = kind;
    run_.give(given);
  });
  return made;
}

void OperatorCommands::add_commands() {
  using Kind = simulation::Command::Kind;
  auto* group = new QGroupBox(tr("Commands"), this);
  auto* grid = new QGridLayout(group);
  const auto add = [grid](QPushButton* made, const char* name, int row, int column) {
    made->setObjectName(QLatin1String(name));
    grid->addWidget(made, row, column);
  };
  add(button(tr("Enable"), tr("Switches the drives on"), Kind::kEnable), "enable", 0, 0);
  add(button(tr("Stop"), tr("Ends the motion or the walk at its next exit"), Kind::kStop), "stop", 0, 1);
  add(button(tr("Get up"), tr("Lets a robot that lies get up"), Kind::kGetUp), "get_up", 1, 0);
  add(button(tr("Reset"), tr("Returns from an emergency stop or a fault"), Kind::kReset), "reset", 1, 1);
  auto* emergency = button(tr("Emergency stop"), tr("Switches the drives off at once"), Kind::kEmergencyStop);
  emergency->setObjectName(QStringLiteral("emergency_stop"));
  grid->addWidget(emergency, 2, 0, 1, 2);
  motion_->setObjectName(QStringLiteral("motions"));
  motion_->setToolTip(tr("Motions that the robot can play"));
  motion_->setAccessibleName(tr("Motion"));
  motion_->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
  auto* play = new QPushButton(tr("Play"));
  play->setObjectName(QStringLiteral("play_motion"));
  play->setToolTip(tr("Plays the motion, or starts the gait, once the robot stands"));
  connect(play, &QPushButton::clicked, this, &OperatorCommands::play);
  grid->addWidget(motion_, 3, 0);
  grid->addWidget(play, 3, 1);
  layout()->addWidget(group);
}

void OperatorCommands::play() {
  if (motion_->currentIndex() < 0) return;
  simulation::Command play;
  play.kind = simulation::Command::Kind::kPlay;
  play.motion = motion_->currentData().toULongLong();
  run_.give(play);
}

void OperatorCommands::add_walk() {
  auto* group = new QGroupBox(tr("Walk"), this);
  auto* form = new QFormLayout(group);
  form->setRowWrapPolicy(QFormLayout::WrapLongRows);
  form->addRow(tr("Forward"), forward_);
  form->addRow(tr("Left"), left_);
  form->addRow(tr("Turn"), turn_);
  walk_->setObjectName(QStringLiteral("walk"));
  connect(walk_, &QPushButton::pressed, this, &OperatorCommands::begin_walk);
  connect(walk_, &QPushButton::released, this, [this] { held_.release(); });
  form->addRow(walk_);
  deadline_->setObjectName(QStringLiteral("walk_deadline"));
  deadline_->setAccessibleName(tr("Deadline of the velocity"));
  deadline_->setWordWrap(true);
  deadline_->hide();
  form->addRow(deadline_);
  gamepad_->setObjectName(QStringLiteral("gamepad"));
  gamepad_->setWordWrap(true);
  gamepad_->setTextFormat(Qt::PlainText);
  gamepad_->setToolTip(
      tr("Left stick: walk; right stick: turn; A: enable; B: stop; Y: get up; View: reset; "
         "LB, RB: emergency stop"));
  form->addRow(gamepad_);
  layout()->addWidget(group);
  show_gamepad(std::nullopt);
}

Eigen::Vector3d OperatorCommands::chosen_velocity() const {
  return {forward_->value(), left_->value(), turn_->value()};
}

// In a simulation, a click begins a walk that goes on.
void OperatorCommands::begin_walk() {
  if (is_on_bus()) return held_.hold(chosen_velocity());
  simulation::Command walk_command;
  walk_command.kind = simulation::Command::Kind::kWalk;
  walk_command.velocity = chosen_velocity();
  run_.give(walk_command);
}

bool OperatorCommands::is_on_bus() const { return run_.source() == RunController::Source::kBus; }

void OperatorCommands::press(tools::Key key) {
  if (!pilot_) return;
  const tools::Order order = pilot_->press(key, state());
  if (const auto* given = std::get_if<simulation::Command>(&order)) {
    if (is_on_bus() && given->kind == simulation::Command::Kind::kWalk) return held_.hold(given->velocity);
    held_ = HeldWalk();  // the command ends the walk by itself
    run_.give(*given);
  }
  const auto* push = std::get_if<tools::BodyPush>(&order);
  if (push != nullptr && run_.session() != nullptr)
    run_.give(push->on(run_.session()->robot().links.front().name, heading_rad()));
}

// The walk of the keys ends when the window is no longer the active one.
bool OperatorCommands::eventFilter(QObject* watched, QEvent* event) {
  if (watched == window() && (event->type() == QEvent::WindowDeactivate || event->type() == QEvent::Close))
    held_.release();
  return QWidget::eventFilter(watched, event);
}

void OperatorCommands::tick() {
  if (const auto walk_command = held_.due(now_us())) run_.give(*walk_command);
  const auto pad = gamepads_ ? gamepads_->read() : std::nullopt;
  for (const simulation::Command& command : gamepad_pilot_.take(pad, now_us())) run_.give(command);
  show_gamepad(pad);
  show_deadline();
  ask_controller();
}

// Says why a robot on a bus does not begin to walk, or that it would walk on without this program.
void OperatorCommands::show_deadline() {
  const BusMonitor* const bus = run_.bus();
  const auto state = bus != nullptr ? bus->walk_deadline() : WalkDeadline::State::kUnknown;
  QString text;
  QString tip;
  if (state == WalkDeadline::State::kRefused) {
    text = tr("Walks on if this program is killed");
    tip = tr("The robot does not accept a deadline of the velocity (event timer, object 0x1401:05)");
  } else if (state == WalkDeadline::State::kSilent) {
    text = tr("No answer by SDO: no walk begins");
    tip = tr("The robot walks once it has accepted a deadline of the velocity");
  }
  if (deadline_->text() == text) return;
  deadline_->setText(text);
  deadline_->setToolTip(tip);
  deadline_->setVisible(!text.isEmpty());
}

std::uint64_t OperatorCommands::now_us() const {
  return static_cast<std::uint64_t>(clock_.nsecsElapsed() / 1000);
}

void OperatorCommands::set_gamepads(std::unique_ptr<Gamepads> gamepads) { gamepads_ = std::move(gamepads); }

void OperatorCommands::show_gamepad(const std::optional<GamepadState>& state) {
  QString text = tr("No gamepad");
  if (state) {
    const Eigen::Vector3d velocity = gamepad_pilot_.velocity_of(*state).value_or(Eigen::Vector3d::Zero());
    text = tr("Gamepad %1: %2 m/s forward, %3 m/s left, %4 rad/s")
               .arg(QString::fromStdString(gamepads_->name()))
               .arg(velocity.x(), 0, 'f', 2)
               .arg(velocity.y(), 0, 'f', 2)
               .arg(velocity.z(), 0, 'f', 2);
  }
  if (gamepad_->text() != text) gamepad_->setText(text);
}

void OperatorCommands::show_source() {
  held_ = HeldWalk();
  gamepad_pilot_.release();
  pilot_.reset();
  inquiry_.reset();
  added_.clear();
  show_motions({});
  Session* session = run_.session();
  setEnabled(session != nullptr || is_on_bus());
  walk_->setToolTip(
      is_on_bus()
          ? tr("Walks at this velocity as long as the button is held. The robot stops by itself %1 ms "
               "after the last velocity, also if this program is killed.")
                .arg(WalkDeadline::kDeadline_ms)
          : tr("Walks at this velocity; the controller clamps it to its limits"));
  walk_->setText(is_on_bus() ? tr("Hold to walk") : tr("Walk"));
  window()->installEventFilter(this);
  if (session != nullptr) {
    const simulation::Scenario& scenario = session->scenario();
    std::vector<std::pair<std::uint16_t, std::string>> motions;
    for (const std::string& name : simulation::motion_names(scenario))
      motions.emplace_back(static_cast<std::uint16_t>(motions.size()), name);
    show_motions(std::move(motions));
    set_limits(simulation::controller_values(scenario).velocity_limits);
  } else if (is_on_bus()) {
    set_limits({});
    inquiry_.emplace();
  }
}

void OperatorCommands::set_limits(const walk::VelocityLimits& limits) {
  limits_ = limits;
  pilot_ = std::make_unique<tools::Pilot>(limits);
  gamepad_pilot_.set_limits({metres_per_s(limits.forward_mm_per_s), metres_per_s(limits.backward_mm_per_s),
                             metres_per_s(limits.lateral_mm_per_s), metres_per_s(limits.turn_mrad_per_s)});
}

// A robot may start later than the window; before it sends, nobody answers.
void OperatorCommands::ask_controller() {
  if (!inquiry_ || std::isnan(bus_state())) return;
  for (simulation::ObjectRequest& request : inquiry_->due(now_us())) run_.give(std::move(request));
}

void OperatorCommands::take_answer(const simulation::ObjectAnswer& answer) {
  if (!inquiry_ || !inquiry_->take(answer, now_us())) return;
  if (inquiry_->asks_limits() && inquiry_->limits() != limits_) set_limits(inquiry_->limits());
  if (!inquiry_->complete()) return;
  show_motions(inquiry_->motions(), QString::fromStdString(std::exchange(wanted_, {})));
  inquiry_.reset();
}

void OperatorCommands::read_motions(const std::string& name) {
  if (!is_on_bus()) return;
  wanted_ = name;
  const bool knows_limits = !inquiry_;
  inquiry_.emplace(knows_limits ? ControllerInquiry::Scope::kMotions : ControllerInquiry::Scope::kAll);
}

void OperatorCommands::add_motion(std::uint16_t number, const std::string& name, std::uint64_t time_us) {
  auto motions = motions_;
  const auto same = std::ranges::find(motions, number, [](const auto& motion) { return motion.first; });
  if (same == motions.end()) {
    motions.emplace_back(number, name);
    std::ranges::sort(motions);
    added_.emplace_back(time_us, number);
  }
  show_motions(std::move(motions), QString::fromStdString(name));
}

// A rewind takes an upload back.
void OperatorCommands::forget_motions_after(std::uint64_t time_us) {
  auto motions = motions_;
  std::erase_if(added_, [&](const auto& added) {
    if (added.first <= time_us) return false;
    std::erase_if(motions, [&](const auto& motion) { return motion.first == added.second; });
    return true;
  });
  if (motions.size() != motions_.size()) show_motions(std::move(motions), motion_->currentText());
}

void OperatorCommands::show_motions(std::vector<std::pair<std::uint16_t, std::string>> motions,
                                    const QString& chosen) {
  motions_ = std::move(motions);
  motion_->clear();
  for (const auto& [number, name] : motions_)
    motion_->addItem(QString::fromStdString(name), qulonglong{number});
  if (const int index = motion_->findText(chosen); index >= 0) motion_->setCurrentIndex(index);
}

behaviour::State OperatorCommands::state() const {
  if (run_.session() != nullptr) return run_.status().said.state;
  const float value = bus_state();
  return std::isnan(value) ? behaviour::State::kBoot
                           : static_cast<behaviour::State>(static_cast<std::uint8_t>(value));
}

// The state that the controller on the bus reported last; NaN: nothing yet.
float OperatorCommands::bus_state() const {
  const view::Recording& recording = run_.recording();
  const auto signal = view::find_signal(recording, RunController::kBusState);
  return signal && !recording.samples.empty() ? recording.samples.back().values[*signal] : std::nanf("");
}

double OperatorCommands::heading_rad() const {
  const view::Recording& recording = run_.recording();
  if (recording.samples.empty() || recording.samples.back().links.empty()) return 0.0;
  const Eigen::Vector3f x_W = recording.samples.back().links.front().q_WL * Eigen::Vector3f::UnitX();
  return std::atan2(static_cast<double>(x_W.y()), static_cast<double>(x_W.x()));
}

}  // namespace koboshi::studio
