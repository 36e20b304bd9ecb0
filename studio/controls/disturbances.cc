#include "studio/controls/disturbances.h"

#include <QComboBox>
#include <QFormLayout>
#include <QGroupBox>
#include <QLabel>
#include <QLineEdit>
#include <QPushButton>
#include <QVBoxLayout>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "base/text/error.h"
#include "simulation/assembly/operator_input.h"
#include "studio/controls/run_controller.h"
#include "studio/widgets/spin_box.h"

namespace koboshi::studio {

Disturbances::Disturbances(RunController& run, QWidget* parent)
    : QWidget(parent),
      run_(run),
      push_link_(new QComboBox),
      push_force_(number_box(0.5, 200.0, 0.5, 6.0, QStringLiteral("N"), tr("Peak of the force, in newtons"))),
      push_duration_(number_box(0.01, 2.0, 0.01, 0.1, QStringLiteral("s"),
                                tr("Duration of the force, a half sine, in seconds"))),
      push_direction_(
          number_box(-180.0, 180.0, 5.0, 0.0, QStringLiteral("°"),
                     tr("Direction in the ground plane of the world, in degrees counter-clockwise "
                        "from the x axis"))),
      fault_kind_(new QComboBox),
      fault_target_(new QComboBox),
      fault_duration_(
          number_box(0.0, 100.0, 0.01, 0.0, QStringLiteral("s"), tr("Duration of the fault, in seconds"))),
      fault_details_(new QLineEdit) {
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(0, 0, 0, 0);
  add_push();
  add_fault();
  connect(&run_, &RunController::opened, this, &Disturbances::show_robot);
}

void Disturbances::add_push() {
  auto* group = new QGroupBox(tr("Push"), this);
  auto* form = new QFormLayout(group);
  form->setRowWrapPolicy(QFormLayout::WrapLongRows);
  push_link_->setObjectName(QStringLiteral("push_link"));
  push_link_->setToolTip(tr("Link that is pushed, at its centre of mass"));
  form->addRow(tr("Link"), push_link_);
  form->addRow(tr("Force"), push_force_);
  form->addRow(tr("Duration"), push_duration_);
  form->addRow(tr("Direction"), push_direction_);
  auto* give = new QPushButton(tr("Push"));
  give->setObjectName(QStringLiteral("push"));
  give->setToolTip(tr("Pushes the link now. In the view: Ctrl+drag a link."));
  connect(give, &QPushButton::clicked, this, &Disturbances::push);
  form->addRow(give);
  layout()->addWidget(group);
}

void Disturbances::push() {
  simulation::Push given;
  given.link.text = push_link_->currentText().toStdString();
  given.shape = simulation::Push::Shape::kHalfSine;
  given.duration_us = static_cast<std::uint64_t>(std::lround(1e3 * push_duration_->value())) * 1000;
  const double direction_rad = std::numbers::pi / 180.0 * push_direction_->value();
  given.force_W_N =
      push_force_->value() * Eigen::Vector3d(std::cos(direction_rad), std::sin(direction_rad), 0.0);
  run_.give(std::move(given));
}

void Disturbances::add_fault() {
  auto* group = new QGroupBox(tr("Fault"), this);
  auto* form = new QFormLayout(group);
  form->setRowWrapPolicy(QFormLayout::WrapLongRows);
  fault_kind_->setObjectName(QStringLiteral("fault_kind"));
  for (const std::string& kind : simulation::Fault::kind_names())
    if (kind != "babbling_node") fault_kind_->addItem(QString::fromStdString(kind));
  fault_kind_->setToolTip(
      tr("Kind of fault, as in a scenario. A babbling node must be on the bus from the "
         "start, so it needs a scenario with this fault."));
  form->addRow(tr("Kind"), fault_kind_);
  fault_target_->setObjectName(QStringLiteral("fault_target"));
  fault_target_->setToolTip(tr("Drive, node or side that has the fault; some kinds have none"));
  form->addRow(tr("Target"), fault_target_);
  fault_duration_->setSpecialValueText(tr("rest of the run"));
  form->addRow(tr("Duration"), fault_duration_);
  fault_details_->setObjectName(QStringLiteral("fault_details"));
  fault_details_->setPlaceholderText(tr("such as supply_V: 3"));
  fault_details_->setToolTip(tr("Other keys of the fault, as in a scenario"));
  form->addRow(tr("Details"), fault_details_);
  auto* cause = new QPushButton(tr("Cause"));
  cause->setObjectName(QStringLiteral("cause_fault"));
  cause->setToolTip(tr("Begins the fault now"));
  connect(cause, &QPushButton::clicked, this, &Disturbances::cause_fault);
  form->addRow(cause);
  auto* note = new QLabel(tr("A babbling node needs a scenario with this fault."));
  note->setWordWrap(true);
  note->setEnabled(false);
  form->addRow(note);
  layout()->addWidget(group);
}

void Disturbances::cause_fault() {
  QStringList keys{QStringLiteral("kind: ") + fault_kind_->currentText()};
  if (fault_target_->currentIndex() > 0) keys << QStringLiteral("target: ") + fault_target_->currentText();
  if (fault_duration_->value() > 0.0)
    keys << QStringLiteral("duration_s: %1").arg(fault_duration_->value(), 0, 'f', 2);
  if (!fault_details_->text().trimmed().isEmpty()) keys << fault_details_->text();
  try {
    run_.give(simulation::read_fault(
        (QLatin1Char('{') + keys.join(QStringLiteral(", ")) + QLatin1Char('}')).toStdString()));
  } catch (const InputError& error) {
    Q_EMIT run_.failed(QString::fromUtf8(error.what()));
  }
}

void Disturbances::show_robot() {
  push_link_->clear();
  fault_target_->clear();
  if (run_.session() == nullptr) return;
  const sim_board::RobotDescription& robot = run_.session()->robot();
  fault_target_->addItems(
      {tr("none"), QStringLiteral("controller"), QStringLiteral("left"), QStringLiteral("right")});
  for (const auto& joint : robot.joints) fault_target_->addItem(QString::fromStdString(joint.name));
  for (const auto& link : robot.links) push_link_->addItem(QString::fromStdString(link.name));
}

}  // namespace koboshi::studio
