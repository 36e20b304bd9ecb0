#include "tools/studio/window/operator_commands.h"

#include <QComboBox>
#include <QCoreApplication>
#include <QEvent>
#include <QFormLayout>
#include <QGridLayout>
#include <QGroupBox>
#include <QLabel>
#include <QPointer>
#include <QPushButton>
#include <QThreadPool>
#include <QVBoxLayout>
#include <algorithm>
#include <cmath>
#include <variant>

#include "simulation/scenario/parameters.h"
#include "tools/motion/remote/robot_motions.h"
#include "tools/studio/window/run_controller.h"
#include "tools/studio/window/spin_box.h"
#include "tools/view/render/playback.h"

namespace koboshi::studio {
namespace {

constexpr int kTick_ms = 20;
constexpr std::uint16_t kLimitsObject = 0x2111;  // forward, backward, lateral, turn
// Numbers of requests that no other panel uses.
constexpr std::uint64_t kLimitRequests = std::uint64_t{1} << 40;
constexpr std::size_t kLimits = 4;

double metres_per_s(std::int16_t thousandths) { return 1e-3 * static_cast<double>(thousandths); }

std::int16_t walk::VelocityLimits::*limit_at(std::size_t index) {
  using Limits = walk::VelocityLimits;
  constexpr std::int16_t Limits::*kFields[kLimits] = {&Limits::forward_mm_per_s, &Limits::backward_mm_per_s,
                                                      &Limits::lateral_mm_per_s, &Limits::turn_mrad_per_s};
  return kFields[index];
}

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
      gamepad_(new QLabel) {
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(0, 0, 0, 0);
  add_commands();
  add_walk();
  connect(&run_, &RunController::opened, this, &OperatorCommands::show_source);
  connect(&run_, &RunController::answered, this, &OperatorCommands::take_limit);
  clock_.start();
  timer_.setInterval(kTick_ms);
  connect(&timer_, &QTimer::timeout, this, &OperatorCommands::tick);
  timer_.start();
  show_source();
}

OperatorCommands::~OperatorCommands() = default;

QPushButton* OperatorCommands::button(const QString& text, const QString& tip, sim::Command::Kind kind) {
  auto* made = new QPushButton(text);
  made->setToolTip(tip);
  connect(made, &QPushButton::clicked, this, [this, kind] {
    held_.release();
    sim::Command given;
    given.kind = kind;
    run_.give(given);
  });
  return made;
}

void OperatorCommands::add_commands() {
  using Kind = sim::Command::Kind;
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
  sim::Command play;
  play.kind = sim::Command::Kind::kPlay;
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
  sim::Command walk_command;
  walk_command.kind = sim::Command::Kind::kWalk;
  walk_command.velocity = chosen_velocity();
  run_.give(walk_command);
}

bool OperatorCommands::is_on_bus() const { return run_.source() == RunController::Source::kBus; }

void OperatorCommands::press(tools::Key key) {
  if (!pilot_) return;
  const tools::Order order = pilot_->press(key, state());
  if (const auto* given = std::get_if<sim::Command>(&order)) {
    if (is_on_bus() && given->kind == sim::Command::Kind::kWalk) return held_.hold(given->velocity);
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
  const auto now_us = static_cast<std::uint64_t>(clock_.nsecsElapsed() / 1000);
  if (const auto walk_command = held_.due(now_us)) run_.give(*walk_command);
  const auto pad = gamepads_ ? gamepads_->read() : std::nullopt;
  for (const sim::Command& command : gamepad_pilot_.take(pad, now_us)) run_.give(command);
  show_gamepad(pad);
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
  motion_->clear();
  Session* session = run_.session();
  setEnabled(session != nullptr || is_on_bus());
  walk_->setToolTip(is_on_bus() ? tr("Walks at this velocity as long as the button is held")
                                : tr("Walks at this velocity; the controller clamps it to its limits"));
  walk_->setText(is_on_bus() ? tr("Hold to walk") : tr("Walk"));
  window()->installEventFilter(this);
  if (session != nullptr) {
    const sim::Scenario& scenario = session->scenario();
    std::vector<std::pair<std::uint16_t, std::string>> motions;
    for (const std::string& name : sim::motion_names(scenario))
      motions.emplace_back(static_cast<std::uint16_t>(motions.size()), name);
    show_motions(motions);
    set_limits(simulation::controller_values(scenario).velocity_limits);
  } else if (is_on_bus()) {
    set_limits({});
    ask_for_limits();
  }
}

void OperatorCommands::set_limits(const walk::VelocityLimits& limits) {
  limits_ = limits;
  pilot_ = std::make_unique<tools::Pilot>(limits);
  gamepad_pilot_.set_limits({metres_per_s(limits.forward_mm_per_s), metres_per_s(limits.backward_mm_per_s),
                             metres_per_s(limits.lateral_mm_per_s), metres_per_s(limits.turn_mrad_per_s)});
}

// The controller tells its limits by SDO.
void OperatorCommands::ask_for_limits() {
  for (std::size_t i = 0; i < kLimits; ++i)
    run_.give(sim::ObjectRequest{.number = kLimitRequests + i,
                                 .node_id = 1,
                                 .address = {kLimitsObject, static_cast<std::uint8_t>(i + 1)}});
}

// After the last limit, the channel is free for the names of the motions.
void OperatorCommands::take_limit(const sim::ObjectAnswer& answer) {
  if (answer.number < kLimitRequests || answer.number >= kLimitRequests + kLimits) return;
  const std::size_t index = answer.number - kLimitRequests;
  if (answer.data.size() == 2) {
    limits_.*limit_at(index) = static_cast<std::int16_t>(answer.data[0] | answer.data[1] << 8);
    set_limits(limits_);
  }
  if (index + 1 == kLimits) ask_for_motions();
}

// Reads the names of the robot's motions with a connection of its own, in another thread.
void OperatorCommands::ask_for_motions() {
  const QPointer<OperatorCommands> self(this);
  QThreadPool::globalInstance()->start([self, bus = run_.bus_address(), real = run_.is_real_bus()] {
    std::vector<std::pair<std::uint16_t, std::string>> motions;
    try {
      if (const auto transport = sim::open_transport(bus, real))
        for (const tools::RobotMotion& motion : tools::RobotMotions(*transport).list())
          motions.emplace_back(motion.number, motion.name);
    } catch (const std::exception&) {
      return;  // no controller answers: it has no motions to choose
    }
    QMetaObject::invokeMethod(
        QCoreApplication::instance(),
        [self, motions, bus] {
          if (self && self->is_on_bus() && self->run_.bus_address() == bus) self->show_motions(motions);
        },
        Qt::QueuedConnection);
  });
}

void OperatorCommands::show_motions(const std::vector<std::pair<std::uint16_t, std::string>>& motions) {
  motion_->clear();
  for (const auto& [number, name] : motions)
    motion_->addItem(QString::fromStdString(name), qulonglong{number});
}

behaviour::State OperatorCommands::state() const {
  if (run_.session() != nullptr) return run_.status().said.state;
  const view::Recording& recording = run_.recording();
  const auto signal = view::find_signal(recording, RunController::kBusState);
  if (!signal || recording.samples.empty()) return behaviour::State::kBoot;
  const float value = recording.samples.back().values[*signal];
  return std::isnan(value) ? behaviour::State::kBoot
                           : static_cast<behaviour::State>(static_cast<std::uint8_t>(value));
}

double OperatorCommands::heading_rad() const {
  const view::Recording& recording = run_.recording();
  if (recording.samples.empty() || recording.samples.back().links.empty()) return 0.0;
  const Eigen::Vector3f x_W = recording.samples.back().links.front().q_WL * Eigen::Vector3f::UnitX();
  return std::atan2(static_cast<double>(x_W.y()), static_cast<double>(x_W.x()));
}

}  // namespace koboshi::studio
