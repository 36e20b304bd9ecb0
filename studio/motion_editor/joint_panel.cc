#include "studio/motion_editor/joint_panel.h"

#include <QCheckBox>
#include <QDoubleSpinBox>
#include <QEvent>
#include <QGridLayout>
#include <QHBoxLayout>
#include <QLabel>
#include <QLineEdit>
#include <QSignalBlocker>
#include <QSlider>
#include <algorithm>
#include <cmath>

#include "base/text/user_units.h"
#include "firmware/fixed/host/convert.h"
#include "simulation/motion_language/parse/joints.h"
#include "studio/document/edit_support.h"
#include "studio/widgets/jump_slider.h"
#include "studio/widgets/value_filter.h"

namespace koboshi::studio {
namespace {

// A slider counts in units of 0.01 degrees, as the file is written.
constexpr double kUnitsPerDegree = 100.0;
constexpr int kLimitUnits = 12;  // this close to its limit, a joint is marked
constexpr int kSliderStep = 50;
constexpr int kSliderPage = 500;

QString readable(const std::string& joint) {
  QString name = QString::fromStdString(joint);
  return name.replace(u'_', u' ');
}

}  // namespace

JointPanel::JointPanel(MotionEditor& editor, QWidget* parent)
    : QScrollArea(parent), editor_(editor), filter_(new ValueFilter(this)) {
  setWidgetResizable(true);
  setFrameShape(QFrame::NoFrame);
  setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
  connect(&editor, &MotionEditor::opened, this, &JointPanel::build);
  connect(&editor, &MotionEditor::changed, this, &JointPanel::refresh);
}

void JointPanel::build() {
  row_.reset();
  if (robot_ == &editor_.document().robot()) return;
  robot_ = &editor_.document().robot();
  joints_.assign(robot_->model.joint_names.size(), {});
  auto* const content = new QWidget;
  auto* const grid = new QGridLayout(content);
  grid->setContentsMargins(8, 4, 8, 4);
  grid->setHorizontalSpacing(8);
  grid->setVerticalSpacing(1);
  grid->setColumnStretch(1, 1);
  add_pose(*grid);
  const simulation::JointNames names(robot_->model);
  std::uint32_t rest = ~0U;
  struct Limb {
    const char* group;
    QString title;
  };
  const Limb limbs[]{{"head", tr("Head")},
                     {"left_arm", tr("Left arm")},
                     {"right_arm", tr("Right arm")},
                     {"left_leg", tr("Left leg")},
                     {"right_leg", tr("Right leg")}};
  const auto joints_in = [&](std::uint32_t mask) {
    std::vector<std::size_t> joints;
    for (std::size_t j = 0; j < names.count(); ++j) {
      if ((mask >> j & 1U) != 0) joints.push_back(j);
    }
    return joints;
  };
  for (const Limb& limb : limbs) {
    const std::uint32_t mask = names.mask(limb.group) & rest;
    rest &= ~mask;
    add_group(*grid, limb.title, joints_in(mask));
  }
  add_group(*grid, tr("Other joints"), joints_in(rest));
  grid->setRowStretch(grid->rowCount(), 1);
  setMinimumWidth(content->minimumSizeHint().width() + 2 * frameWidth());
  setWidget(content);
  refresh();
}

void JointPanel::add_pose(QGridLayout& grid) {
  pose_ = new QLabel;
  name_ = new QLineEdit;
  name_->setObjectName(QStringLiteral("pose"));
  name_->setToolTip(tr("Name of the pose in the file; a new name replaces it in all places (Ctrl+E)"));
  uses_ = new QLabel;
  connect(name_, &QLineEdit::editingFinished, this, &JointPanel::rename_pose);
  this_step_ = new QCheckBox(tr("Change this step &alone"));
  this_step_->setObjectName(QStringLiteral("this_step"));
  this_step_->setToolTip(
      tr("Gives the step a copy of its pose, with a name of its own, before it changes.\n"
         "Otherwise all steps change that use the pose."));
  QSizePolicy policy = this_step_->sizePolicy();
  policy.setRetainSizeWhenHidden(true);  // the sliders stay where they are
  this_step_->setSizePolicy(policy);
  auto* const heading = new QHBoxLayout;
  heading->setSpacing(8);
  heading->addWidget(pose_);
  heading->addWidget(name_, 1);
  heading->addWidget(uses_);
  grid.addLayout(heading, 0, 0, 1, 3);
  grid.setRowMinimumHeight(0, name_->sizeHint().height());
  grid.addWidget(this_step_, 1, 0, 1, 3);
}

void JointPanel::add_group(QGridLayout& grid, const QString& title, const std::vector<std::size_t>& joints) {
  if (joints.empty()) return;
  auto* const heading = new QLabel(title);
  QFont font = heading->font();
  font.setBold(true);
  heading->setFont(font);
  heading->setContentsMargins(0, 3, 0, 0);
  grid.addWidget(heading, grid.rowCount(), 0, 1, 3);
  for (const std::size_t joint : joints) add_joint(grid, joint);
}

void JointPanel::add_joint(QGridLayout& grid, std::size_t joint) {
  const robot::Joint& model = robot_->model.model.joints[joint];
  const double lower_deg = fixed::to_double(model.lower) * kDegreesPerRad;
  const double upper_deg = fixed::to_double(model.upper) * kDegreesPerRad;
  JointRow& row = joints_[joint];
  row.name = new QLabel(readable(robot_->model.joint_names[joint]));
  QFont bold = row.name->font();
  bold.setBold(true);
  row.name->setMinimumWidth(QFontMetrics(bold).horizontalAdvance(row.name->text()) + 2);
  row.slider = new JumpSlider(Qt::Horizontal);
  row.slider->setMinimumWidth(70);
  row.slider->setRange(static_cast<int>(std::ceil(lower_deg * kUnitsPerDegree)),
                       static_cast<int>(std::floor(upper_deg * kUnitsPerDegree)));
  row.slider->setSingleStep(kSliderStep);
  row.slider->setPageStep(kSliderPage);
  row.slider->setObjectName(QString::fromStdString(robot_->model.joint_names[joint]));
  row.box = new QDoubleSpinBox;
  row.box->setLocale(QLocale::c());
  row.box->setDecimals(2);
  row.box->setSingleStep(0.5);
  row.box->setRange(row.slider->minimum() / kUnitsPerDegree, row.slider->maximum() / kUnitsPerDegree);
  row.box->setSuffix(tr("°"));
  row.box->setAlignment(Qt::AlignRight);
  row.box->setKeyboardTracking(false);
  row.box->setFixedWidth(row.box->fontMetrics().horizontalAdvance(QStringLiteral("-180.00°")) + 34);
  const QString tip = tr("%1: target angle in degrees, %2° to %3°, at most %4 °/s")
                          .arg(row.name->text())
                          .arg(lower_deg, 0, 'f', 1)
                          .arg(upper_deg, 0, 'f', 1)
                          .arg(fixed::to_double(model.max_speed) * kDegreesPerRad, 0, 'f', 0);
  const int line = grid.rowCount();
  int column = 0;
  for (QWidget* const widget : std::initializer_list<QWidget*>{row.name, row.slider, row.box}) {
    widget->setToolTip(tip);
    widget->installEventFilter(this);
    filter_->watch(*widget);
    grid.addWidget(widget, line, column++);
  }
  connect(row.slider, &QSlider::valueChanged, this,
          [this, joint](int value) { change(joint, value / kUnitsPerDegree); });
  connect(row.slider, &QSlider::sliderReleased, this, [this, joint] { drag_ended(joint); });
  connect(row.box, &QDoubleSpinBox::valueChanged, this,
          [this, joint](double value) { change(joint, value); });
}

void JointPanel::set_row(std::optional<std::size_t> row) {
  if (row_ != row) {
    editor_.end_drag();
    if (name_ != nullptr) name_->setModified(false);
  }
  row_ = row;
  refresh();
}

void JointPanel::edit_name() {
  name_->setFocus();
  name_->selectAll();
}

void JointPanel::rename_pose() {
  if (!row_ || *row_ >= editor_.rows().rows.size()) return;
  const std::string from = editor_.rows().rows[*row_].pose;
  const std::string to = name_->text().toStdString();
  name_->setModified(false);
  if (from.empty() || from == to) return;
  if (!editor_.edit([&](MotionDocument& document) { document.rename_pose(from, to); })) refresh();
}

void JointPanel::refresh_pose(const MotionRow* row) {
  const bool is_move = row != nullptr && row->kind == simulation::StepSource::Kind::kMove;
  const bool has_name = is_move && !row->pose.empty();
  if (row == nullptr) {
    pose_->setText(tr("No step"));
  } else if (!is_move) {
    pose_->setText(tr("Angles after this step"));
  } else {
    pose_->setText(has_name ? tr("Pose") : tr("Pose of this step"));
  }
  name_->setVisible(has_name);
  if (has_name && !name_->isModified()) name_->setText(QString::fromStdString(row->pose));
  uses_->setVisible(has_name);
  if (has_name) uses_->setText(row->pose_uses == 1 ? tr("1 use") : tr("%1 uses").arg(row->pose_uses));
  this_step_->setVisible(has_name && row->pose_uses > 1);
}

void JointPanel::refresh() {
  if (robot_ == nullptr) return;
  const auto& rows = editor_.rows().rows;
  const MotionRow* const row = row_ && *row_ < rows.size() ? &rows[*row_] : nullptr;
  refresh_pose(row);
  const YamlNode* const tree = editor_.document().tree();
  const std::uint32_t allowed = tree != nullptr ? allowed_joints(*robot_, *tree) : 0;
  for (std::size_t joint = 0; joint < joints_.size(); ++joint)
    refresh_joint(joint, row, (allowed >> joint & 1U) != 0);
}

void JointPanel::refresh_joint(std::size_t joint, const MotionRow* row, bool is_allowed) {
  const JointRow& widgets = joints_[joint];
  const bool is_move = row != nullptr && row->kind == simulation::StepSource::Kind::kMove;
  const double angle_rad = row != nullptr && joint < row->angles_rad.size() ? row->angles_rad[joint] : 0.0;
  const double angle_deg = angle_rad * kDegreesPerRad;
  {
    const QSignalBlocker blocked_slider(widgets.slider);
    const QSignalBlocker blocked_box(widgets.box);
    if (!widgets.slider->isSliderDown())
      widgets.slider->setValue(static_cast<int>(std::lround(angle_deg * kUnitsPerDegree)));
    widgets.box->setValue(angle_deg);
  }
  // Joints that are not in the file's list `joints` keep their angle.
  widgets.slider->setEnabled(is_move && is_allowed);
  widgets.box->setEnabled(is_move && is_allowed);
  // Red: the joint is at a limit.
  const bool is_at_limit = is_move && (widgets.slider->value() <= widgets.slider->minimum() + kLimitUnits ||
                                       widgets.slider->value() >= widgets.slider->maximum() - kLimitUnits);
  if (widgets.name->property("limit").toBool() != is_at_limit) {
    widgets.name->setProperty("limit", is_at_limit);
    QPalette colours = palette();
    if (is_at_limit) colours.setColor(QPalette::WindowText, QColor(212, 58, 47));
    widgets.name->setPalette(colours);
  }
  // Bold: the step itself gives the angle.
  QFont font = widgets.name->font();
  const bool is_given = is_move && (row->moved >> joint & 1U) != 0;
  if (font.bold() == is_given) return;
  font.setBold(is_given);
  widgets.name->setFont(font);
}

PoseScope JointPanel::scope() const {
  const bool is_this_step = this_step_ != nullptr && !this_step_->isHidden() && this_step_->isChecked();
  return is_this_step ? PoseScope::kThisStep : PoseScope::kAllSteps;
}

void JointPanel::change(std::size_t joint, double angle_deg) {
  if (!row_) return;
  Q_EMIT joint_chosen(joint);
  const JointAngle angle{joint, angle_deg * kRadPerDegree};
  const bool is_drag = joints_[joint].slider->isSliderDown();
  const std::string drag = is_drag ? "slider " + std::to_string(joint) + " " + std::to_string(*row_) : "";
  const std::size_t row = *row_;
  if (!editor_.edit([&](MotionDocument& document) { document.set_angles(row, {&angle, 1}, scope(), drag); }))
    refresh();
}

void JointPanel::drag_ended(std::size_t joint) {
  static_cast<void>(joint);
  editor_.end_drag();
  refresh();
}

bool JointPanel::eventFilter(QObject* watched, QEvent* event) {
  const bool is_chosen = event->type() == QEvent::FocusIn || event->type() == QEvent::MouseButtonPress;
  if (is_chosen) {
    const auto found = std::ranges::find_if(joints_, [&](const JointRow& row) {
      return watched == row.name || watched == row.slider || watched == row.box;
    });
    if (found != joints_.end()) Q_EMIT joint_chosen(static_cast<std::size_t>(found - joints_.begin()));
  }
  return QScrollArea::eventFilter(watched, event);
}

}  // namespace koboshi::studio
