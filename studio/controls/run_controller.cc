#include "studio/controls/run_controller.h"

#include <QCoreApplication>
#include <QMetaObject>
#include <QPointer>
#include <QThreadPool>
#include <algorithm>
#include <exception>
#include <iterator>
#include <stdexcept>
#include <utility>
#include <vector>

#include "simulation/scenario/reader.h"

namespace koboshi::studio {
namespace {

constexpr int kPoll_ms = 33;  // 30 pictures a second; the simulation has the rest of the machine
constexpr qint64 kPaceWindow_ms = 1000;

}  // namespace

RunController::RunController(QObject* parent) : QObject(parent) {
  timer_.setInterval(kPoll_ms);
  connect(&timer_, &QTimer::timeout, this, &RunController::poll);
  timer_.start();
  pace_timer_.start();
}

RunController::~RunController() = default;

void RunController::open(const std::filesystem::path& file, std::function<Opened()> make) {
  const std::uint64_t request = ++request_;
  const QPointer<RunController> self(this);
  QThreadPool::globalInstance()->start([self, request, file, make = std::move(make)] {
    auto opened = std::make_shared<std::optional<Opened>>();
    QString error;
    try {
      opened->emplace(make());
    } catch (const std::exception& exception) {
      error = QString::fromUtf8(exception.what()).trimmed();
    }
    // The application outlives its thread pool; the controller may be gone.
    QMetaObject::invokeMethod(
        QCoreApplication::instance(),
        [self, request, file, opened, error] {
          if (!self || request != self->request_) return;
          if (*opened) {
            self->show(std::move(**opened), file);
          } else {
            Q_EMIT self->failed(error);
          }
        },
        Qt::QueuedConnection);
  });
}

std::vector<Override> RunController::overrides_of_scenarios() const {
  if (robot_of_scenarios_.empty()) return {};
  return {{"robot", robot_of_scenarios_.string(), "--robot"}};
}

void RunController::open_scenario(const std::filesystem::path& file, std::span<const Override> overrides) {
  robot_file_.clear();
  std::vector<Override> all(overrides.begin(), overrides.end());
  if (std::ranges::find(all, "robot", &Override::path) == all.end())
    std::ranges::copy(overrides_of_scenarios(), std::back_inserter(all));
  if (edits_) std::ranges::copy(edits_(file), std::back_inserter(all));
  open(file,
       [file, prepare = preparation_ ? preparation_() : Preparation(), all = std::move(all)]() -> Opened {
         simulation::Scenario scenario = simulation::read_scenario(file, all);
         if (prepare) prepare(scenario);
         return {std::make_unique<Session>(scenario), {}};
       });
}

void RunController::reopen(std::span<const Override> overrides) {
  if (source_ != Source::kSimulation) return;
  std::vector<Override> all(overrides.begin(), overrides.end());
  const std::filesystem::path robot = robot_file_;
  if (!robot.empty()) all.push_back({"robot", robot.string(), "the model editor"});
  open_scenario(file_, all);
  robot_file_ = robot;
}

void RunController::open_recording(const std::filesystem::path& run) {
  open(run, [run]() -> Opened { return {nullptr, {}, nullptr, std::make_unique<RecordedRun>(run)}; });
}

void RunController::open_bus(const std::string& transport, const sim_board::TransportOptions& options,
                             const std::filesystem::path& robot) {
  bus_address_ = transport;
  open(transport, [transport, options, robot]() -> Opened {
    std::unique_ptr<sim_board::Transport> opened = sim_board::open_transport(transport, options);
    if (!opened || !opened->is_live())
      throw std::invalid_argument("found the bus " + transport +
                                  ", expected socketcan:INTERFACE, udp:ADDRESS:PORT or slcan");
    return {nullptr, {}, std::make_unique<BusMonitor>(std::move(opened), robot)};
  });
}

void RunController::show(Opened opened, const std::filesystem::path& file) {
  session_ = std::move(opened.session);
  bus_ = std::move(opened.bus);
  recorded_ = std::move(opened.recorded);
  recording_ = session_    ? session_->head()
               : bus_      ? bus_->head()
               : recorded_ ? recorded_->window.head()
                           : std::move(opened.recording);
  source_ = session_ ? Source::kSimulation : bus_ ? Source::kBus : Source::kRecording;
  file_ = file;
  plays_recording_ = false;
  follow_ = session_ != nullptr || bus_ != nullptr;
  cursor_us_ = 0;
  status_ = session_ ? session_->status() : SessionStatus();
  if (session_) {
    session_->set_speed(speed_);
    session_->step(sim_board::SimBoard::kTick_us / 1000);  // so that there is something to see
  }
  pace_start_us_ = 0;
  pace_ = 0.0;
  Q_EMIT this->opened();
  Q_EMIT status_changed();
  if (recorded_) {
    move_window([](RecordingWindow& window) { return window.show(0); });
  } else if (!recording_.samples.empty()) {
    Q_EMIT grown(0);
  }
  if (!recording_.samples.empty()) set_cursor(recording_.samples.front().time_us);
}

bool RunController::playing() const {
  return session_ || bus_ ? status_.state == SessionStatus::State::kRunning : plays_recording_;
}

const sim_board::RobotDescription* RunController::robot() const {
  return session_ ? &session_->robot() : bus_ ? &bus_->robot() : nullptr;
}

std::uint64_t RunController::end_us() const {
  if (recorded_) return recorded_->window.end_us();
  return recording_.samples.empty() ? 0 : recording_.samples.back().time_us;
}

void RunController::set_playing(bool playing) {
  if (session_) {
    follow_ = true;
    if (playing) {
      session_->start();
    } else {
      session_->pause();
    }
  } else if (source_ == Source::kRecording) {
    if (playing && cursor_us_ >= end_us()) set_cursor(0);
    plays_recording_ = playing;
    played_us_ = static_cast<double>(cursor_us_);
    played_.start();
    Q_EMIT status_changed();
  }
}

void RunController::step(std::uint64_t milliseconds) {
  if (session_) {
    follow_ = true;
    session_->step(milliseconds);
  } else {
    set_cursor(cursor_us_ + 1000 * milliseconds);
  }
}

void RunController::set_speed(double speed) {
  speed_ = speed;
  if (session_) session_->set_speed(speed);
}

void RunController::set_cursor(std::uint64_t time_us) {
  time_us = std::min(time_us, end_us());
  follow_ = (session_ || bus_) && time_us == end_us();
  played_us_ = static_cast<double>(time_us);
  move_window([time_us](RecordingWindow& window) { return window.show(time_us); });
  if (std::exchange(cursor_us_, time_us) != time_us) Q_EMIT cursor_moved(time_us);
}

void RunController::rewind_to_cursor() {
  if (!session_) return;
  follow_ = true;
  session_->rewind(cursor_us_);
}

void RunController::give(Input input) {
  if (session_) session_->give(std::move(input));
  if (bus_ && !bus_->give(input)) Q_EMIT failed(tr("Only a simulation can do this."));
}

void RunController::poll() {
  if (session_) {
    take_batch(session_->take());
    take_status(session_->status());
  } else if (bus_) {
    take_batch(bus_->take());
    take_status(bus_status());
  } else if (plays_recording_) {
    play_recording();
  }
  if (recorded_) read_recording_on();
  measure_pace();
}

// Moves the window of a recorded run; an error ends the reading. Returns whether the recording has changed.
bool RunController::move_window(const std::function<bool(RecordingWindow&)>& move) {
  if (!recorded_) return false;
  try {
    if (!move(recorded_->window)) return false;
  } catch (const std::exception& error) {
    Q_EMIT failed(QString::fromUtf8(error.what()));
    return false;
  }
  recorded_->window.copy_to(recording_);
  Q_EMIT window_moved();
  return true;
}

// Takes what the threads have read of a recorded run for plots and lists, and reads ahead around the cursor.
void RunController::read_recording_on() {
  constexpr std::size_t kBlocksPerPoll = 160;  // 50 ms of work for the plots of 135 signals
  if (!recorded_->overview.finished()) {
    const std::vector<view::Recording> blocks = recorded_->overview.take(kBlocksPerPoll);
    for (const view::Recording& block : blocks)
      recording_.events.insert(recording_.events.end(), block.events.begin(), block.events.end());
    if (!blocks.empty()) Q_EMIT overview_read(blocks);
    if (recorded_->overview.finished()) {
      if (const std::string error = recorded_->overview.error(); !error.empty())
        Q_EMIT failed(QString::fromStdString(error));
      Q_EMIT status_changed();
    }
  }
  // While somebody drags the cursor, its place alone counts.
  const bool is_dragged = std::exchange(polled_cursor_us_, cursor_us_) != cursor_us_ && !plays_recording_;
  if (!is_dragged) move_window([](RecordingWindow& window) { return window.extend(); });
}

void RunController::take_batch(Batch batch) {
  const std::uint64_t end_before_us = end_us();
  const std::optional<Rewind> rewind = batch.rewound;
  const bool has_events = batch.events.has_value();
  const std::vector<simulation::ObjectAnswer> answers = std::move(batch.answers);
  append(std::move(batch), recording_);
  if (rewind) Q_EMIT rewound(rewind->time_us);
  const std::uint64_t known_us = rewind ? std::min(end_before_us, rewind->time_us) : end_before_us;
  const auto first = std::ranges::upper_bound(recording_.samples, known_us, {}, &view::Sample::time_us);
  // The events of a run may change without a sample, such as after a rewind of a run that stays paused.
  if (first != recording_.samples.end() || rewind || has_events)
    Q_EMIT grown(static_cast<std::size_t>(first - recording_.samples.begin()));
  if (follow_ && cursor_us_ != end_us()) {
    cursor_us_ = end_us();
    Q_EMIT cursor_moved(cursor_us_);
  }
  for (const simulation::ObjectAnswer& answer : answers) Q_EMIT answered(answer);
}

// A bus runs until its monitor ends.
SessionStatus RunController::bus_status() const {
  SessionStatus status;
  status.message = bus_->error();
  status.state = status.message.empty() ? SessionStatus::State::kRunning : SessionStatus::State::kFailed;
  status.time_us = end_us();
  return status;
}

void RunController::take_status(SessionStatus status) {
  const bool told = !status.message.empty() && status.message != status_.message;
  const bool changed = status.state != status_.state || status.time_us != status_.time_us;
  status_ = std::move(status);
  if (told) Q_EMIT failed(QString::fromStdString(status_.message));
  if (changed) Q_EMIT status_changed();
}

void RunController::play_recording() {
  const double speed = speed_ == Session::kUnpaced ? 1.0 : speed_;
  const double next_us = played_us_ + speed * 1e-3 * static_cast<double>(played_.nsecsElapsed());
  played_.restart();
  set_cursor(static_cast<std::uint64_t>(next_us));
  played_us_ = std::min(next_us, static_cast<double>(end_us()));
  if (cursor_us_ < end_us()) return;
  plays_recording_ = false;
  Q_EMIT status_changed();
}

void RunController::measure_pace() {
  if (pace_timer_.elapsed() < kPaceWindow_ms) return;
  const std::uint64_t now_us = session_ || bus_ ? status_.time_us : cursor_us_;
  const double wall_us = 1e-3 * static_cast<double>(pace_timer_.nsecsElapsed());
  pace_ = now_us > pace_start_us_ ? static_cast<double>(now_us - pace_start_us_) / wall_us : 0.0;
  pace_start_us_ = now_us;
  pace_timer_.restart();
  Q_EMIT status_changed();
}

}  // namespace koboshi::studio
