#pragma once

#include <QObject>
#include <QString>
#include <cstddef>
#include <span>
#include <vector>

#include "studio/window/pose_ghost.h"
#include "view/render/renderer.h"

class QAction;
class QMenu;

namespace koboshi::studio {

class MotionPanel;

// The poses of the moves before (orange) and after (blue) the current step, fainter with each move. Each
// stands on the sole that it shares best with the pose of the current step.
class OnionSkin final : public QObject {
  Q_OBJECT

 public:
  static constexpr std::size_t kMostPoses = 5;  // on each side

  explicit OnionSkin(const MotionPanel& motion, QObject* parent = nullptr);

  // Adds the switch and the numbers of poses, which are remembered.
  void fill_menu(QMenu& menu);
  // The poses around the current step, whose pose stands with its links at `shown`.
  [[nodiscard]] std::vector<view::Ghost> poses(const PoseGhost& robot,
                                               std::span<const view::Pose> shown) const;

 Q_SIGNALS:
  void changed();

 private:
  // The choices of a number of poses; %1 is the number.
  struct Numbers {
    QString title;
    QString text;
    QString key;  // of the setting
    QString shortcut;
  };
  void add_numbers(QMenu& menu, const Numbers& texts, std::size_t& number);

  const MotionPanel& motion_;
  QAction* shown_ = nullptr;
  std::size_t before_ = 1;
  std::size_t after_ = 1;
};

}  // namespace koboshi::studio
