#pragma once

#include <QElapsedTimer>
#include <QTimer>
#include <QWidget>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "simulation/scenario/object_access.h"
#include "simulation/scenario/scenario.h"
#include "studio/gamepad/gamepad_pilot.h"
#include "studio/gamepad/held_walk.h"
#include "studio/run/controller_inquiry.h"
#include "tools/teleop/key.h"
#include "tools/teleop/pilot.h"

class QComboBox;
class QDoubleSpinBox;
class QGridLayout;
class QLabel;
class QPushButton;

namespace koboshi::studio {

class RunController;

// Commands to the controller of a simulated robot, or of a robot on a bus: by buttons, by the operator's keys
// and by a gamepad.
//
// On a bus, a walk is held: it lasts while the button is down, or for the keys while the window is active.
// Its velocity is repeated, and a stop follows. BusMonitor stops the walk if the repetition fails, and the
// robot stops by itself if this program is killed; a robot that cannot is pointed out.
class OperatorCommands final : public QWidget {
  Q_OBJECT

 public:
  // The controller of the run must outlive this widget.
  explicit OperatorCommands(RunController& run, QWidget* parent = nullptr);
  ~OperatorCommands() override;

  // Obeys a key as `koboshi run` with teleop does.
  void press(tools::Key key);
  // Number and name of the motions in the list.
  const std::vector<std::pair<std::uint16_t, std::string>>& motions() const { return motions_; }
  // Adds a motion that the simulated robot has from this time of the run on, and chooses it.
  void add_motion(std::uint16_t number, const std::string& name, std::uint64_t time_us);
  // Asks a robot on a bus anew for its motions, and chooses the one with this name.
  void read_motions(const std::string& name);
  // Replaces the gamepads of this machine. Null: none.
  void set_gamepads(std::unique_ptr<Gamepads> gamepads);

 protected:
  bool eventFilter(QObject* watched, QEvent* event) override;

 private:
  void add_commands();
  void add_walk();
  // A push button that gives a command, with its tooltip.
  QPushButton* button(const QString& text, const QString& tip, simulation::Command::Kind kind);
  void begin_walk();
  void play();
  void tick();
  void show_source();
  void show_gamepad(const std::optional<GamepadState>& state);
  void show_deadline();
  void ask_controller();
  void take_answer(const simulation::ObjectAnswer& answer);
  void show_motions(std::vector<std::pair<std::uint16_t, std::string>> motions, const QString& chosen = {});
  void forget_motions_after(std::uint64_t time_us);
  void set_limits(const walk::VelocityLimits& limits);
  bool is_on_bus() const;
  behaviour::State state() const;
  float bus_state() const;
  std::uint64_t now_us() const;
  double heading_rad() const;
  Eigen::Vector3d chosen_velocity() const;

  RunController& run_;
  std::unique_ptr<tools::Pilot> pilot_;
  HeldWalk held_;
  std::unique_ptr<Gamepads> gamepads_;
  GamepadPilot gamepad_pilot_;
  walk::VelocityLimits limits_;
  std::optional<ControllerInquiry> inquiry_;  // on a bus, until it is complete
  std::vector<std::pair<std::uint16_t, std::string>> motions_;
  std::vector<std::pair<std::uint64_t, std::uint16_t>> added_;  // time and number of motions of a simulation
  std::string wanted_;  // name of the motion to choose once the list is read
  QComboBox* const motion_;
  QDoubleSpinBox* const forward_;
  QDoubleSpinBox* const left_;
  QDoubleSpinBox* const turn_;
  QPushButton* const walk_;
  QLabel* const deadline_;
  QLabel* const gamepad_;
  QElapsedTimer clock_;
  QTimer timer_;
};

}  // namespace koboshi::studio
