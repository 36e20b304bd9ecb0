#include "studio/window/motion_playback.h"

#include <QAction>
#include <QCoreApplication>
#include <QPointer>
#include <QThreadPool>
#include <memory>
#include <utility>

#include "base/file/output_file.h"
#include "studio/controls/operator_commands.h"
#include "studio/controls/run_controller.h"
#include "studio/motion_editor/motion_panel.h"
#include "studio/widgets/message_bar.h"
#include "studio/window/motion_upload.h"
#include "tools/motion_check/check.h"
#include "tools/motion_stage/stage.h"
#include "tools/motion_view/preview.h"

namespace koboshi::studio {

MotionPlayback::MotionPlayback(RunController& run, MotionPanel& motion, OperatorCommands& commands,
                               MessageBar& messages, std::filesystem::path robot_file, QObject* parent)
    : QObject(parent),
      run_(run),
      motion_(motion),
      commands_(commands),
      messages_(messages),
      robot_file_(std::move(robot_file)),
      simulated_upload_(run) {
  connect(&simulated_upload_, &SimulatedUpload::done, this, &MotionPlayback::take_uploaded);
  connect(&simulated_upload_, &SimulatedUpload::failed, this, [this](const QString& reason) {
    messages_.show_error(tr("The controller has not stored the motion: %1").arg(reason));
  });
  connect(&motion_, &MotionPanel::play_requested, this, &MotionPlayback::play);
  connect(&run_, &RunController::opened, this, &MotionPlayback::show_opened);
  connect(&run_, &RunController::status_changed, this, &MotionPlayback::repeat);
}

std::optional<std::filesystem::path> MotionPlayback::write_copy(const std::string& text) {
  const std::filesystem::path name = motion_.file().empty() ? "untitled.yaml" : motion_.file().filename();
  const std::filesystem::path copy = std::filesystem::path(copies_.path().toStdString()) / name;
  try {
    write_whole_file(copy, text);
  } catch (const std::exception& error) {
    messages_.show_error(QString::fromUtf8(error.what()));
    return std::nullopt;
  }
  return copy;
}

void MotionPlayback::upload(const std::string& transport, const sim_board::TransportOptions& options) {
  if (!motion_.editor().is_open())
    return messages_.show_message(tr("No motion is open that could be uploaded."), MessageKind::kWarning);
  const auto copy = write_copy(motion_.text());
  if (!copy) return;
  if (run_.session() != nullptr) return upload_to_simulation(*copy);
  const QPointer<MotionPlayback> self(this);
  QThreadPool::globalInstance()->start(
      [self, upload = MotionUpload{*copy, robot_file_, transport, options, run_.borrow_sdo()}] {
        std::optional<UploadedMotion> uploaded;
        QString error;
        try {
          uploaded = studio::upload(upload);
        } catch (const std::exception& exception) {
          error = QString::fromUtf8(exception.what()).trimmed();
        }
        // The application outlives its thread pool; the window may be gone.
        QMetaObject::invokeMethod(
            QCoreApplication::instance(),
            [self, uploaded, error, place = QString::fromStdString(upload.transport)] {
              if (!self) return;
              if (!uploaded) return self->messages_.show_error(error);
              self->show_uploaded(*uploaded, tr("%1 is motion %2 of the robot on %3: %4 bytes, read back the "
                                                "same. The operator's list has it.")
                                                 .arg(QString::fromStdString(uploaded->name))
                                                 .arg(uploaded->number)
                                                 .arg(place)
                                                 .arg(uploaded->bytes));
            },
            Qt::QueuedConnection);
      });
}

void MotionPlayback::upload_to_simulation(const std::filesystem::path& copy) {
  try {
    simulated_upload_.start(compile_image(copy, run_.robot()->file), commands_.motions());
  } catch (const std::exception& error) {
    return messages_.show_error(QString::fromUtf8(error.what()).trimmed());
  }
  if (!run_.playing())
    messages_.show_message(tr("The simulation pauses: the motion goes to its robot once it runs (Space)."),
                           MessageKind::kInformation);
}

void MotionPlayback::take_uploaded(const UploadedMotion& motion, std::uint64_t time_us) {
  commands_.add_motion(motion.number, motion.name, time_us);
  messages_.show_message(tr("%1 is motion %2 of the simulated robot: %3 bytes, stored with the same CRC. The "
                            "operator's list has it.")
                             .arg(QString::fromStdString(motion.name))
                             .arg(motion.number)
                             .arg(motion.bytes),
                         MessageKind::kSuccess);
}

void MotionPlayback::show_uploaded(const UploadedMotion& motion, const QString& text) {
  commands_.read_motions(motion.name);
  messages_.show_message(text, MessageKind::kSuccess);
}

void MotionPlayback::play(bool physics, int from_row) {
  const auto row = static_cast<std::size_t>(from_row);
  const auto copy = write_copy(physics ? motion_.text_from(row) : motion_.text());
  if (!copy) return;
  run_.open(copy->filename(), [copy = *copy, physics, robot = robot_file_]() -> RunController::Opened {
    tools::MotionChecker checker(robot);
    const tools::MotionReport report = checker.check(copy);
    if (!physics) return {nullptr, tools::preview_recording(report, checker)};
    return {std::make_unique<Session>(tools::stage_scenario(copy, report)), {}};
  });
  play_when_opened_ = true;
  from_us_ = physics ? 0 : motion_.preview_start_us(row);
}

void MotionPlayback::show_opened() {
  if (std::exchange(play_when_opened_, false)) {
    start_opened();
  } else {
    from_us_ = 0;
  }
}

// The controller moves the cursor to the first sample after this.
void MotionPlayback::start_opened() {
  QMetaObject::invokeMethod(
      this,
      [this] {
        if (run_.session() == nullptr) run_.set_cursor(from_us_);
        run_.set_playing(true);
      },
      Qt::QueuedConnection);
}

// A playback has stopped by itself when it is at its end; a simulation goes on without end.
void MotionPlayback::repeat() {
  const bool is_playback = run_.session() == nullptr && run_.end_us() > from_us_;
  if (std::exchange(was_playing_, run_.playing()) && is_playback && loop_ != nullptr && loop_->isChecked() &&
      !run_.playing() && run_.cursor_us() >= run_.end_us())
    start_opened();
}

}  // namespace koboshi::studio
