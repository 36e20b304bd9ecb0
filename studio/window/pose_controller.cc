#include "studio/window/pose_controller.h"

#include <QAction>
#include <QActionGroup>
#include <QMenu>
#include <algorithm>
#include <cmath>

#include "firmware/fixed/host/convert.h"

#include "base/text/user_units.h"
#include "simulation/motion_language/parse/joints.h"
#include "studio/controls/run_controller.h"
#include "studio/motion_editor/motion_panel.h"
#include "view/render/marks.h"
#include "view/render/playback.h"

namespace koboshi::studio {
namespace {

constexpr double kLimitMark_m = 0.012;  // radius of the spheres at joints that are at a limit
constexpr view::Colour kLimitColour{0.83F, 0.18F, 0.16F};
constexpr float kLevel_m = 0.005F;   // between feet that stand on the same ground
constexpr float kLimitShare = 0.5F;  // of that colour in the links of the limb

}  // namespace

PoseController::PoseController(RobotView& view, MotionPanel& motion, RunController& run, QObject* parent)
    : QObject(parent), view_(view), motion_(motion), run_(run), onion_(new OnionSkin(motion, this)) {
  connect(onion_, &OnionSkin::changed, this, &PoseController::show_onion);
  connect(&view_, &RobotView::pose_drag_began, this, &PoseController::begin);
  connect(&view_, &RobotView::pose_dragged, this, &PoseController::drag);
  connect(&view_, &RobotView::pose_drag_ended, this, &PoseController::end);
}

void PoseController::set_robot(std::shared_ptr<const sim_board::RobotDescription> robot) {
  ghost_.emplace(std::move(robot));
  const view::Scene scene = ghost_->scene();
  links_ = {{0}, {scene.sole_links[0]}, {scene.sole_links[1]}, {-1}, {-1}};
  for (std::size_t body = 0; body < 3; ++body) links_[body].rotates = true;  // trunk and feet
  const simulation::NamedModel model = simulation::load_named_model(ghost_->robot());
  for (std::size_t side = 0; side < 2; ++side) {
    const auto elbow =
        model.model.find(side == 0 ? robot::JointRole::kLeftElbow : robot::JointRole::kRightElbow);
    if (!elbow || !model.hands[side]) continue;
    const sim_board::JointDescription& joint = ghost_->robot().joints[*elbow];
    const Eigen::Vector3d tip_M = joint.p_MJ + Eigen::Vector3d(fixed::to_double(model.hands[side]->x),
                                                               fixed::to_double(model.hands[side]->y),
                                                               fixed::to_double(model.hands[side]->z));
    const auto child = static_cast<std::size_t>(joint.child);
    links_[static_cast<std::size_t>(DragBody::kLeftHand) + side] = {
        joint.child, ghost_->robot().links[child].X_ML.inverse() * tip_M};
  }
}

QAction* PoseController::add_choice(QMenu& menu, const QString& text, Support support) {
  QAction* action = menu.addAction(text);
  action->setToolTip(
      support == kBoth
          ? tr("The trunk moves over both feet, which stay where they are. A hand moves its arm only.")
      : support == kAutomatic
          ? tr("The trunk moves over the lower foot, or over both if they stand at the same height "
               "(5 mm). A hand moves its arm only.")
          : tr("The trunk moves over this foot; the other leg keeps its joint angles and goes with "
               "the trunk. A hand moves its arm only."));
  action->setShortcut(
      QKeySequence(Qt::ALT | Qt::SHIFT | static_cast<Qt::Key>(static_cast<int>(Qt::Key_1) + support)));
  action->setCheckable(true);
  action->setChecked(support == support_);
  connect(action, &QAction::triggered, this, [this, support] { support_ = support; });
  return action;
}

void PoseController::fill_menu(QMenu& menu) {
  by_mouse_ = menu.addAction(tr("Edit poses by &mouse"));
  by_mouse_->setShortcut(QKeySequence(tr("Ctrl+Shift+I")));
  by_mouse_->setToolTip(
      tr("Drag hand, foot or trunk of the pose in the view, by the arrows along and by the rings about the "
         "world's axes; Ctrl+Shift rotates freely"));
  by_mouse_->setCheckable(true);
  by_mouse_->setChecked(true);
  connect(by_mouse_, &QAction::toggled, this, &PoseController::update_posable);
  QMenu* support = menu.addMenu(tr("&Support foot while dragging"));
  support->setToolTipsVisible(true);
  auto* group = new QActionGroup(this);
  group->addAction(add_choice(*support, tr("Support: &lower foot"), kAutomatic));
  group->addAction(add_choice(*support, tr("Support: left &foot"), kLeft));
  group->addAction(add_choice(*support, tr("Support: &right foot"), kRight));
  group->addAction(add_choice(*support, tr("Support: &both feet"), kBoth));
  QAction* insert = menu.addAction(tr("Insert the &run's pose"));
  insert->setShortcut(QKeySequence(tr("Ctrl+Shift+Ins")));
  insert->setToolTip(tr("Insert a move to the joint angles of the run at the cursor"));
  connect(insert, &QAction::triggered, this, &PoseController::insert_run_pose);
  menu.addSeparator();
  onion_->fill_menu(menu);
}

void PoseController::update_posable() {
  std::vector<RobotView::Posable> links;
  const bool is_edited = ghost_ && by_mouse_ != nullptr && by_mouse_->isChecked() &&
                         !motion_.editable_pose().empty() &&
                         view_.picture().posed().size() == ghost_->robot().links.size();
  // The robot of a run is no pose: only its ghost is.
  const bool is_pose = run_.source() == RunController::Source::kNone || view_.picture().has_ghost();
  for (const RobotView::Posable& body : links_)
    if (is_edited && is_pose && body.link >= 0) links.push_back(body);
  view_.set_posable(std::move(links));
}

void PoseController::show_pose(const std::vector<double>& angles_rad) {
  shown_rad_ = angles_rad;
  if (angles_rad.empty() || !ghost_) {
    view_.show_ghost({});
    view_.show_onion({});
    return update_posable();
  }
  if (anchor_ && motion_.current_row() != anchor_->row) anchor_.reset();
  const bool is_alone = run_.source() == RunController::Source::kNone;
  const view::Recording& recording = run_.recording();
  std::vector<view::Pose> links;
  if (anchor_) {
    links = ghost_->hold(angles_rad, anchor_->link, anchor_->at);
  } else if (is_alone) {
    links = ghost_->stand(angles_rad);
  } else {
    if (recording.samples.empty() || recording.scene.links.size() != ghost_->robot().links.size()) return;
    const std::vector<view::Pose> run_links = view::poses_at(recording, run_.cursor_us());
    links = ghost_->stand(angles_rad, &run_links.front());
  }
  if (is_alone) {
    view_.show_robot(std::move(links), {});
  } else {
    view_.show_ghost(std::move(links));
  }
  show_onion();
  update_posable();
}

void PoseController::show_onion() {
  const bool is_shown =
      ghost_ && !shown_rad_.empty() && view_.picture().posed().size() == ghost_->robot().links.size();
  view_.show_onion(is_shown ? onion_->poses(*ghost_, view_.picture().posed()) : std::vector<view::Ghost>());
}

std::optional<DragBody> PoseController::body_of(int link) const {
  const auto found = std::ranges::find(links_, link, &RobotView::Posable::link);
  if (link < 0 || found == links_.end()) return std::nullopt;
  return static_cast<DragBody>(found - links_.begin());
}

// Whether the user has chosen this foot to stay where it is.
bool PoseController::is_support(DragBody body) const {
  if (body == DragBody::kLeftFoot) return support_ == kLeft || support_ == kBoth;
  if (body == DragBody::kRightFoot) return support_ == kRight || support_ == kBoth;
  return false;
}

// The feet over which the trunk moves.
DragSupport PoseController::trunk_support() const {
  if (support_ == kLeft) return DragSupport::kLeftFoot;
  if (support_ == kRight) return DragSupport::kRightFoot;
  const float lower_m = foot_height_m(DragBody::kRightFoot) - foot_height_m(DragBody::kLeftFoot);
  if (support_ == kBoth || std::abs(lower_m) < kLevel_m) return DragSupport::kBothFeet;
  return lower_m < 0.0F ? DragSupport::kRightFoot : DragSupport::kLeftFoot;
}

float PoseController::foot_height_m(DragBody foot) const {
  const int link = links_[static_cast<std::size_t>(foot)].link;
  return view_.picture().posed()[static_cast<std::size_t>(link)].p_WL_m.z();
}

// The foot that stays in its place: never the dragged one. If neither is dragged, either may be held.
DragBody PoseController::anchor_foot(DragBody body) const {
  if (body == DragBody::kLeftFoot) return DragBody::kRightFoot;
  if (body == DragBody::kRightFoot) return DragBody::kLeftFoot;
  if (support_ == kLeft || support_ == kRight)
    return support_ == kLeft ? DragBody::kLeftFoot : DragBody::kRightFoot;
  return foot_height_m(DragBody::kRightFoot) < foot_height_m(DragBody::kLeftFoot) ? DragBody::kRightFoot
                                                                                  : DragBody::kLeftFoot;
}

void PoseController::begin(int link, const Eigen::Vector3d& p_W_m) {
  drag_.reset();
  const auto body = body_of(link);
  const std::vector<double> angles_rad = motion_.editable_pose();
  const auto row = motion_.current_row();
  if (!body || !row || angles_rad.empty()) return;
  if (is_support(*body)) {
    Q_EMIT told(tr("This is a support foot: choose another support (menu Pose) to drag it."));
    return;
  }
  const view::Pose& trunk = view_.picture().posed().front();
  q_WB_ = trunk.q_WL.cast<double>().normalized();
  const Eigen::Vector3d grabbed_B_m = q_WB_.conjugate() * (p_W_m - trunk.p_WL_m.cast<double>());
  const int foot = links_[static_cast<std::size_t>(anchor_foot(*body))].link;
  anchor_ = {*row, foot, view_.picture().posed()[static_cast<std::size_t>(foot)]};
  drag_.emplace(motion_.editor().document().robot(), angles_rad, *body, grabbed_B_m, trunk_support());
}

void PoseController::drag(const Eigen::Vector3d& displacement_W_m, const Eigen::Vector3d& rotation_W_rad) {
  if (!drag_) return;
  const DraggedPose pose =
      drag_->move(q_WB_.conjugate() * displacement_W_m, q_WB_.conjugate() * rotation_W_rad);
  std::vector<JointAngle> angles;
  for (std::size_t joint = 0; joint < pose.angles_rad.size(); ++joint)
    if ((drag_->joints() >> joint & 1U) != 0) angles.push_back({joint, pose.angles_rad[joint]});
  if (motion_.drag_pose(angles)) show_limits(pose, rotation_text(rotation_W_rad));
}

// A rotation about one axis has a sign; another one is an angle. Empty: none.
QString PoseController::rotation_text(const Eigen::Vector3d& rotation_W_rad) {
  const auto degrees = [](double angle_rad) { return QString::number(kDegreesPerRad * angle_rad, 'f', 1); };
  for (int axis = 0; axis < 3; ++axis)
    if (rotation_W_rad[axis] != 0.0 && std::abs(rotation_W_rad[axis]) == rotation_W_rad.norm())
      return tr("Rotation by %1° about %2").arg(degrees(rotation_W_rad[axis])).arg(QChar(u"xyz"[axis]));
  return rotation_W_rad.isZero() ? QString() : tr("Rotation by %1°").arg(degrees(rotation_W_rad.norm()));
}

void PoseController::show_limits(const DraggedPose& pose, const QString& drag_text) {
  view::Marks marks;
  QStringList names;
  const auto& model = motion_.editor().document().robot().model;
  for (const std::size_t joint : pose.at_limit) {
    names << QString::fromStdString(model.joint_names[joint]).replace(u'_', u' ');
    const sim_board::JointDescription& description = ghost_->robot().joints[joint];
    const view::Pose& child = view_.picture().posed()[static_cast<std::size_t>(description.child)];
    const Eigen::Isometry3d& X_ML = ghost_->robot().links[static_cast<std::size_t>(description.child)].X_ML;
    const Eigen::Vector3d anchor_L = X_ML.inverse() * description.p_MJ;
    view::add_sphere(marks, child.p_WL_m.cast<double>() + child.q_WL.cast<double>() * anchor_L, kLimitMark_m,
                     kLimitColour);
  }
  view_.change().show_limits(std::move(marks), tints_of(pose));
  QStringList told_parts;
  if (!drag_text.isEmpty()) told_parts << drag_text;
  if (!pose.reached)
    told_parts << (pose.missing_rad > 0.0
                       ? tr("Out of reach by %1°").arg(kDegreesPerRad * pose.missing_rad, 0, 'f', 1)
                       : tr("Out of reach by %1 mm").arg(kMmPerM * pose.missing_m, 0, 'f', 1));
  if (!names.isEmpty()) told_parts << tr("At the limit: %1").arg(names.join(QStringLiteral(", ")));
  Q_EMIT told(told_parts.join(QStringLiteral(". ")));
}

// All links of a limb that has a joint at its limit.
std::vector<view::Tint> PoseController::tints_of(const DraggedPose& pose) const {
  if (pose.at_limit.empty()) return {};
  std::vector<view::Tint> tints(ghost_->robot().links.size());
  const simulation::JointNames names(motion_.editor().document().robot().model);
  for (const char* limb : {"left_arm", "right_arm", "left_leg", "right_leg"}) {
    const std::uint32_t joints = names.mask(limb);
    const auto is_in = [&](std::size_t joint) { return (joints >> joint & 1U) != 0; };
    if (std::ranges::none_of(pose.at_limit, is_in)) continue;
    for (std::size_t joint = 0; joint < ghost_->robot().joints.size(); ++joint)
      if (is_in(joint))
        tints[static_cast<std::size_t>(ghost_->robot().joints[joint].child)] = {kLimitColour, kLimitShare};
  }
  return tints;
}

void PoseController::end() {
  drag_.reset();
  view_.change().show_limits({}, {});
  motion_.end_pose_drag();
}

void PoseController::insert_run_pose() {
  const view::Recording& recording = run_.recording();
  if (!ghost_ || !motion_.editor().is_open() || recording.samples.empty() ||
      recording.scene.links.size() != ghost_->robot().links.size()) {
    Q_EMIT told(tr("There is no run of this robot, or no motion is open."));
    return;
  }
  motion_.insert_pose(ghost_->angles_of(view::poses_at(recording, run_.cursor_us())), "captured");
}

}  // namespace koboshi::studio
