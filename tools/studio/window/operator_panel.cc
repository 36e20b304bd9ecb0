#include "tools/studio/window/operator_panel.h"

#include <QComboBox>
#include <QDoubleSpinBox>
#include <QFormLayout>
#include <QGridLayout>
#include <QGroupBox>
#include <QLabel>
#include <QLineEdit>
#include <QPushButton>
#include <QVBoxLayout>
#include <cmath>
#include <numbers>
#include <utility>
#include <variant>
#include <vector>

#include "sim_board/input/error.h"
#include "sim_board/world/options.h"
#include "simulation/scenario/operator_input.h"
#include "simulation/scenario/parameters.h"
#include "tools/studio/window/run_controller.h"
#include "tools/view/render/playback.h"

namespace koboshi::studio {
namespace {

constexpr const char* kGiven = "given";  // property: the scenario's value
constexpr double kRadPerDegree = std::numbers::pi / 180.0;

QDoubleSpinBox* number(double low, double high, double step, double value, const QString& unit,
                       const QString& tip) {
  auto* box = new QDoubleSpinBox;
  box->setRange(low, high);
  box->setSingleStep(step);
  box->setDecimals(step < 0.1 ? 2 : 1);
  box->setValue(value);
  box->setSuffix(QLatin1Char(' ') + unit);
  box->setToolTip(tip);
  return box;
}

std::string text_of(const QDoubleSpinBox& box) {
  return QString::number(box.value(), 'f', box.decimals()).toStdString();
}

}  // namespace

OperatorPanel::OperatorPanel(RunController& run, QWidget* parent)
    : QWidget(parent), run_(run), state_(new QLabel(this)) {
  new QVBoxLayout(this);
  state_->setToolTip(tr("State that the controller reports"));
  state_->setAccessibleName(tr("State of the controller"));
  layout()->addWidget(state_);
  add_settings();
  add_commands();
  add_velocity();
  add_push();
  add_fault();
  static_cast<QVBoxLayout*>(layout())->addStretch();
  connect(&run_, &RunController::opened, this, &OperatorPanel::update_run);
  connect(&run_, &RunController::status_changed, this, &OperatorPanel::update_state);
  update_run();
}

void OperatorPanel::add_settings() {
  auto* group = new QGroupBox(tr("Scenario"), this);
  auto* form = new QFormLayout(group);
  seed_ = new QSpinBox;
  seed_->setRange(1, 1'000'000'000);
  seed_->setToolTip(tr("Seed of the sensors' noise"));
  form->addRow(tr("Seed"), seed_);
  stepper_ = new QComboBox;
  for (const std::string& name : sim::stepper_names()) stepper_->addItem(QString::fromStdString(name));
  stepper_->setToolTip(tr("Method by which the physics engine computes a step"));
  form->addRow(tr("Stepper"), stepper_);
  ground_roll_ = number(-20.0, 20.0, 0.5, 0.0, QStringLiteral("°"), tr("Slope of the ground to the side"));
  ground_pitch_ = number(-20.0, 20.0, 0.5, 0.0, QStringLiteral("°"), tr("Slope of the ground ahead"));
  ground_friction_ = number(0.0, 10.0, 0.05, 1.0, QString(), tr("Coulomb's mu of the ground"));
  form->addRow(tr("Roll"), ground_roll_);
  form->addRow(tr("Pitch"), ground_pitch_);
  form->addRow(tr("Friction"), ground_friction_);
  auto* again = new QPushButton(tr("Start again"));
  again->setObjectName(QStringLiteral("restart"));
  again->setToolTip(tr("Resets the simulation and applies seed, stepper and ground"));
  connect(again, &QPushButton::clicked, this, &OperatorPanel::restart);
  form->addRow(again);
  layout()->addWidget(group);
}

QPushButton* OperatorPanel::button(const QString& text, const QString& tip, sim::Command::Kind kind) {
  auto* made = new QPushButton(text);
  made->setToolTip(tip);
  connect(made, &QPushButton::clicked, this, [this, kind] { command(kind); });
  return made;
}

void OperatorPanel::add_commands() {
  using Kind = sim::Command::Kind;
  auto* group = new QGroupBox(tr("Commands"), this);
  auto* grid = new QGridLayout(group);
  grid->addWidget(button(tr("Enable"), tr("Switches the drives on"), Kind::kEnable), 0, 0);
  grid->addWidget(button(tr("Stop"), tr("Ends the motion or the walk at its next exit"), Kind::kStop), 0, 1);
  grid->addWidget(button(tr("Get up"), tr("Lets a robot that lies get up"), Kind::kGetUp), 1, 0);
  grid->addWidget(button(tr("Emergency stop"), tr("Switches the drives off at once"), Kind::kEmergencyStop),
                  1, 1);
  grid->addWidget(button(tr("Reset"), tr("Returns from an emergency stop or a fault"), Kind::kReset), 2, 0);
  motion_ = new QComboBox;
  motion_->setToolTip(tr("Motions of this scenario"));
  motion_->setAccessibleName(tr("Motion"));
  auto* play = new QPushButton(tr("Play"));
  play->setToolTip(tr("Plays the motion, or starts the gait, once the robot stands"));
  connect(play, &QPushButton::clicked, this, [this] {
    if (motion_->currentIndex() < 0) return;
    sim::Command play_motion;
    play_motion.kind = sim::Command::Kind::kPlay;
    play_motion.motion = static_cast<std::size_t>(motion_->currentIndex());
    run_.give(play_motion);
  });
  grid->addWidget(motion_, 3, 0);
  grid->addWidget(play, 3, 1);
  layout()->addWidget(group);
}

void OperatorPanel::add_velocity() {
  auto* group = new QGroupBox(tr("Walk"), this);
  auto* form = new QFormLayout(group);
  forward_ = number(-0.3, 0.3, 0.02, 0.1, QStringLiteral("m/s"), tr("Forward velocity"));
  left_ = number(-0.2, 0.2, 0.02, 0.0, QStringLiteral("m/s"), tr("Velocity to the left"));
  turn_ =
      number(-1.5, 1.5, 0.1, 0.0, QStringLiteral("rad/s"), tr("Turning rate, counter-clockwise from above"));
  form->addRow(tr("Forward"), forward_);
  form->addRow(tr("Left"), left_);
  form->addRow(tr("Turn"), turn_);
  auto* walk = new QPushButton(tr("Walk"));
  walk->setToolTip(tr("Walks at this velocity; the controller clamps it to its limits"));
  connect(walk, &QPushButton::clicked, this, [this] {
    sim::Command walk_command;
    walk_command.kind = sim::Command::Kind::kWalk;
    walk_command.velocity = {forward_->value(), left_->value(), turn_->value()};
    run_.give(walk_command);
  });
  form->addRow(walk);
  layout()->addWidget(group);
}

void OperatorPanel::add_push() {
  auto* group = new QGroupBox(tr("Push"), this);
  auto* form = new QFormLayout(group);
  push_link_ = new QComboBox;
  push_link_->setToolTip(tr("Link that is pushed, at its centre of mass"));
  form->addRow(tr("Link"), push_link_);
  push_force_ = number(0.5, 200.0, 0.5, 6.0, QStringLiteral("N"), tr("Peak of the force"));
  form->addRow(tr("Force"), push_force_);
  push_duration_ =
      number(0.01, 2.0, 0.01, 0.1, QStringLiteral("s"), tr("Duration of the force, a half sine"));
  form->addRow(tr("Duration"), push_duration_);
  push_direction_ =
      number(-180.0, 180.0, 5.0, 0.0, QStringLiteral("°"),
             tr("Direction in the ground plane of the world, counter-clockwise from the x axis"));
  form->addRow(tr("Direction"), push_direction_);
  auto* push = new QPushButton(tr("Push"));
  push->setObjectName(QStringLiteral("push"));
  push->setToolTip(tr("Pushes the link now. In the view: Ctrl+drag a link."));
  connect(push, &QPushButton::clicked, this, [this] {
    sim::Push given;
    given.link.text = push_link_->currentText().toStdString();
    given.shape = sim::Push::Shape::kHalfSine;
    given.duration_us = static_cast<std::uint64_t>(std::lround(1e3 * push_duration_->value())) * 1000;
    const double direction_rad = kRadPerDegree * push_direction_->value();
    given.force_W_N =
        push_force_->value() * Eigen::Vector3d(std::cos(direction_rad), std::sin(direction_rad), 0.0);
    run_.give(std::move(given));
  });
  form->addRow(push);
  layout()->addWidget(group);
}

void OperatorPanel::add_fault() {
  auto* group = new QGroupBox(tr("Fault"), this);
  auto* form = new QFormLayout(group);
  fault_kind_ = new QComboBox;
  fault_kind_->setObjectName(QStringLiteral("fault_kind"));
  for (const std::string& kind : sim::Fault::kind_names())
    if (kind != "babbling_node") fault_kind_->addItem(QString::fromStdString(kind));
  fault_kind_->setToolTip(tr("Kind of fault, as in a scenario"));
  form->addRow(tr("Kind"), fault_kind_);
  fault_target_ = new QComboBox;
  fault_target_->setObjectName(QStringLiteral("fault_target"));
  fault_target_->setToolTip(tr("Drive, node or side that has the fault; some kinds have none"));
  form->addRow(tr("Target"), fault_target_);
  fault_duration_ = number(0.0, 100.0, 0.01, 0.0, QStringLiteral("s"), tr("Duration of the fault"));
  fault_duration_->setSpecialValueText(tr("rest of the run"));
  form->addRow(tr("Duration"), fault_duration_);
  fault_details_ = new QLineEdit;
  fault_details_->setObjectName(QStringLiteral("fault_details"));
  fault_details_->setPlaceholderText(tr("such as supply_V: 3"));
  fault_details_->setToolTip(tr("Other keys of the fault, as in a scenario"));
  form->addRow(tr("Details"), fault_details_);
  auto* cause = new QPushButton(tr("Cause"));
  cause->setObjectName(QStringLiteral("cause_fault"));
  cause->setToolTip(tr("Begins the fault now"));
  connect(cause, &QPushButton::clicked, this, &OperatorPanel::cause_fault);
  form->addRow(cause);
  layout()->addWidget(group);
}

void OperatorPanel::cause_fault() {
  QStringList keys{QStringLiteral("kind: ") + fault_kind_->currentText()};
  if (fault_target_->currentIndex() > 0) keys << QStringLiteral("target: ") + fault_target_->currentText();
  if (fault_duration_->value() > 0.0)
    keys << QStringLiteral("duration_s: %1").arg(fault_duration_->value(), 0, 'f', 2);
  if (!fault_details_->text().trimmed().isEmpty()) keys << fault_details_->text();
  try {
    run_.give(simulation::read_fault(
        (QLatin1Char('{') + keys.join(QStringLiteral(", ")) + QLatin1Char('}')).toStdString()));
  } catch (const sim::InputError& error) {
    Q_EMIT run_.failed(QString::fromUtf8(error.what()));
  }
}

// The ground stays that of the scenario where nobody has changed it.
void OperatorPanel::restart() {
  std::vector<sim::Override> overrides{
      {"seed", std::to_string(seed_->value()), "--seed"},
      {"physics.stepper", stepper_->currentText().toStdString(), "--stepper"}};
  const std::pair<const char*, const QDoubleSpinBox*> ground[] = {{"ground.roll_deg", ground_roll_},
                                                                  {"ground.pitch_deg", ground_pitch_},
                                                                  {"ground.friction", ground_friction_}};
  for (const auto& [key, box] : ground)
    if (text_of(*box) != box->property(kGiven).toString().toStdString())
      overrides.push_back({key, text_of(*box), box->toolTip().toStdString()});
  run_.reopen(overrides);
}

void OperatorPanel::command(sim::Command::Kind kind) {
  sim::Command given;
  given.kind = kind;
  run_.give(given);
}

double OperatorPanel::heading_rad() const {
  const view::Recording& recording = run_.recording();
  if (recording.samples.empty() || recording.samples.back().links.empty()) return 0.0;
  const Eigen::Vector3f x_W = recording.samples.back().links.front().q_WL * Eigen::Vector3f::UnitX();
  return std::atan2(static_cast<double>(x_W.y()), static_cast<double>(x_W.x()));
}

void OperatorPanel::press(tools::Key key) {
  if (!pilot_) return;
  const tools::Order order = pilot_->press(key, run_.status().said.state);
  if (const auto* given = std::get_if<sim::Command>(&order)) run_.give(*given);
  if (const auto* push = std::get_if<tools::BodyPush>(&order))
    run_.give(push->on(run_.session()->robot().links.front().name, heading_rad()));
}

void OperatorPanel::update_run() {
  Session* session = run_.session();
  setEnabled(session != nullptr);
  motion_->clear();
  push_link_->clear();
  fault_target_->clear();
  pilot_.reset();
  update_state();
  if (session == nullptr) return;
  const sim::Scenario& scenario = session->scenario();
  seed_->setValue(static_cast<int>(scenario.seed));
  stepper_->setCurrentText(QString::fromUtf8(sim::name_of(scenario.physics.stepper).data()));
  for (const std::string& name : sim::motion_names(scenario)) motion_->addItem(QString::fromStdString(name));
  ground_roll_->setValue(scenario.ground.roll_rad / kRadPerDegree);
  ground_pitch_->setValue(scenario.ground.pitch_rad / kRadPerDegree);
  ground_friction_->setValue(scenario.ground.friction.value_or(sim::SurfaceDescription().friction));
  for (QDoubleSpinBox* box : {ground_roll_, ground_pitch_, ground_friction_})
    box->setProperty(kGiven, QString::fromStdString(text_of(*box)));
  fault_target_->addItems(
      {tr("none"), QStringLiteral("controller"), QStringLiteral("left"), QStringLiteral("right")});
  for (const auto& joint : session->robot().joints)
    fault_target_->addItem(QString::fromStdString(joint.name));
  for (const auto& link : session->robot().links) push_link_->addItem(QString::fromStdString(link.name));
  pilot_ = std::make_unique<tools::Pilot>(simulation::controller_values(scenario).velocity_limits);
}

void OperatorPanel::update_state() {
  const view::Recording& recording = run_.recording();
  const auto state = view::find_signal(recording, "state_name");
  const QString name =
      state && !recording.samples.empty()
          ? QString::fromStdString(view::name_of_value(recording, *state, recording.samples.size() - 1))
          : QString();
  state_->setText(name.isEmpty() ? tr("No controller runs.") : tr("Controller: <b>%1</b>").arg(name));
}

}  // namespace koboshi::studio
