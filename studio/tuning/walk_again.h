#pragma once

#include <QObject>
#include <QTimer>
#include <cstdint>

#include "simulation/scenario/object_access.h"

namespace koboshi::studio {

// Lets a walking robot stop and, once it stands, walk again at the same velocity, so that a new gait takes
// effect. A robot that stands begins to walk. It commands and reads the controller's objects by SDO.
class WalkAgain final : public QObject {
  Q_OBJECT

 public:
  explicit WalkAgain(QObject* parent = nullptr);

  void start();
  // Forgets what it was about: another run, or an earlier moment.
  void cancel();
  void take_answer(const simulation::ObjectAnswer& answer);

 Q_SIGNALS:
  void requested(const koboshi::simulation::ObjectRequest& request);
  void failed(const QString& message);

 private:
  enum class Stage { kIdle, kStop, kAwaitStand, kWalk };

  void request(Stage stage);

  Stage stage_ = Stage::kIdle;
  std::uint64_t number_;
  QTimer timer_;  // until the state is read again
};

}  // namespace koboshi::studio
