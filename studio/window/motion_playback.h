#pragma once

#include <QObject>
#include <QTemporaryDir>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "sim_board/can/transport/transport.h"
#include "studio/window/simulated_upload.h"

class QAction;

namespace koboshi::studio {

class MessageBar;
class MotionPanel;
class OperatorCommands;
class RunController;

// Plays the motion of the editor as it is, saved or not: as a preview or in a simulation, from a step on, and
// again at its end. Uploads it to a robot. Errors go to the message bar.
class MotionPlayback final : public QObject {
  Q_OBJECT

 public:
  // All must outlive this object; `robot_file` is that of the edited motions.
  MotionPlayback(RunController& run, MotionPanel& motion, OperatorCommands& commands, MessageBar& messages,
                 std::filesystem::path robot_file, QObject* parent = nullptr);

  // A playback that ends while this action is checked begins again.
  void set_loop(QAction* loop) { loop_ = loop; }
  // Compiles the motion, stores it in the controller of the simulation, or else of a robot on this bus, and
  // checks what the controller then has. The operator's list gets it.
  void upload(const std::string& transport, const sim_board::TransportOptions& options);

 private:
  std::optional<std::filesystem::path> write_copy(const std::string& text);
  void upload_to_simulation(const std::filesystem::path& copy);
  void take_uploaded(const UploadedMotion& motion, std::uint64_t time_us);
  void show_uploaded(const UploadedMotion& motion, const QString& text);
  void play(bool physics, int from_row);
  void start_opened();
  void show_opened();
  void repeat();

  RunController& run_;
  MotionPanel& motion_;
  OperatorCommands& commands_;
  MessageBar& messages_;
  const std::filesystem::path robot_file_;
  SimulatedUpload simulated_upload_;
  QTemporaryDir copies_;  // texts of motions that are played before they are saved
  QAction* loop_ = nullptr;
  std::uint64_t from_us_ = 0;  // of a playback
  bool play_when_opened_ = false;
  bool was_playing_ = false;
};

}  // namespace koboshi::studio
