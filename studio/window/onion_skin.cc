#include "studio/window/onion_skin.h"

#include <QAction>
#include <QActionGroup>
#include <QMenu>
#include <QSettings>
#include <algorithm>
#include <cmath>

#include "studio/document/neighbours.h"
#include "studio/motion_editor/motion_panel.h"
#include "view/render/overlay.h"

namespace koboshi::studio {
namespace {

constexpr float kNearestOpacity = 0.40F;
constexpr float kFading = 0.7F;  // per move
constexpr float kTintShare = 0.75F;

// The foot that is lower in both of two poses that stand on the ground.
int shared_sole(const view::Scene& scene, std::span<const view::Pose> one,
                std::span<const view::Pose> other) {
  const auto height_m = [&](int link) {
    const auto index = static_cast<std::size_t>(link);
    return std::max(one[index].p_WL_m.z(), other[index].p_WL_m.z());
  };
  const auto [left, right] = scene.sole_links;
  return height_m(right) < height_m(left) ? right : left;
}

}  // namespace

OnionSkin::OnionSkin(const MotionPanel& motion, QObject* parent) : QObject(parent), motion_(motion) {}

void OnionSkin::fill_menu(QMenu& menu) {
  shown_ = menu.addAction(tr("&Onion skin"));
  shown_->setShortcut(QKeySequence(tr("Ctrl+Shift+O")));
  shown_->setToolTip(tr("Show the poses of the moves before (orange) and after (blue) the current step"));
  shown_->setCheckable(true);
  shown_->setChecked(QSettings().value(QStringLiteral("onion/shown"), false).toBool());
  connect(shown_, &QAction::toggled, this, [this](bool on) {
    QSettings().setValue(QStringLiteral("onion/shown"), on);
    Q_EMIT changed();
  });
  add_numbers(menu,
              {tr("Poses &before the step"), tr("Onion skin: %1 before"), QStringLiteral("onion/before"),
               tr("Ctrl+Meta+%1")},
              before_);
  add_numbers(menu,
              {tr("Poses &after the step"), tr("Onion skin: %1 after"), QStringLiteral("onion/after"),
               tr("Ctrl+Alt+Shift+%1")},
              after_);
}

void OnionSkin::add_numbers(QMenu& menu, const Numbers& texts, std::size_t& number) {
  const QString& key = texts.key;
  number = std::min<std::size_t>(QSettings().value(key, 1).toUInt(), kMostPoses);
  QMenu* choices = menu.addMenu(texts.title);
  auto* group = new QActionGroup(this);
  for (std::size_t i = 0; i <= kMostPoses; ++i) {
    QAction* action = choices->addAction(texts.text.arg(i));
    action->setObjectName(key + u'/' + QString::number(i));
    action->setShortcut(QKeySequence(texts.shortcut.arg(i)));
    action->setCheckable(true);
    action->setChecked(i == number);
    group->addAction(action);
    connect(action, &QAction::triggered, this, [this, key, i, &number] {
      number = i;
      QSettings().setValue(key, static_cast<unsigned>(i));
      Q_EMIT changed();
    });
  }
}

std::vector<view::Ghost> OnionSkin::poses(const PoseGhost& robot, std::span<const view::Pose> shown) const {
  std::vector<view::Ghost> ghosts;
  const auto row = motion_.current_row();
  if (shown_ == nullptr || !shown_->isChecked() || !row) return ghosts;
  const MotionRows& rows = motion_.editor().rows();
  const NeighbouringMoves moves = neighbouring_moves(rows, *row, before_, after_);
  const view::Scene scene = robot.scene();
  const auto add = [&](std::size_t move, const view::Colour& colour, std::size_t distance) {
    const std::vector<double>& angles_rad = rows.rows[move].angles_rad;
    const int sole = shared_sole(scene, shown, robot.stand(angles_rad));
    view::Ghost ghost;
    ghost.links = robot.hold(angles_rad, sole, shown[static_cast<std::size_t>(sole)]);
    ghost.tints.assign(ghost.links.size(), {colour, kTintShare});
    ghost.opacity = kNearestOpacity * std::pow(kFading, static_cast<float>(distance));
    ghosts.push_back(std::move(ghost));
  };
  // Nearest first: a pose hides those behind it that are farther in time.
  for (std::size_t i = 0; i < std::max(moves.before.size(), moves.after.size()); ++i) {
    if (i < moves.before.size()) add(moves.before[i], view::kPlannedColour, i);
    if (i < moves.after.size()) add(moves.after[i], view::kMeasuredColour, i);
  }
  return ghosts;
}

}  // namespace koboshi::studio
