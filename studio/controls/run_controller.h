#pragma once

#include <QElapsedTimer>
#include <QObject>
#include <QString>
#include <QTimer>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/yaml/yaml_tree.h"
#include "studio/run/bus_monitor.h"
#include "studio/run/overview_reader.h"
#include "studio/run/recording_window.h"
#include "studio/run/session.h"
#include "view/recording/recording.h"

namespace koboshi::studio {

// The run in the window: a simulation, a recorded run, or a robot on a CAN bus, and the cursor, the moment
// that all panels show. While a simulation runs, the cursor is at its newest sample until somebody moves it.
class RunController final : public QObject {  // Large: what every panel may ask of a run
  Q_OBJECT

 public:
  enum class Source { kNone, kSimulation, kRecording, kBus };
  // The signal of a bus that has the state of the controller.
  static constexpr const char* kBusState = "controller_TPDO1.state";

  explicit RunController(QObject* parent = nullptr);
  ~RunController() override;

  // A recorded run on the disk, of which the blocks around the cursor are in memory.
  struct RecordedRun {
    explicit RecordedRun(const std::filesystem::path& run) : window(run), overview(run) {}
    RecordingWindow window;
    OverviewReader overview;
  };
  // The run that open() shows: a session, a recording in memory or on the disk, or a bus.
  struct Opened {
    std::unique_ptr<Session> session;
    view::Recording recording;
    std::unique_ptr<BusMonitor> bus = nullptr;
    std::unique_ptr<RecordedRun> recorded = nullptr;
  };

  // All read in the background and end with opened() or failed().
  void open_scenario(const std::filesystem::path& file, std::span<const Override> overrides = {});
  void open_recording(const std::filesystem::path& run);
  // Follows the robot of this file on a bus, named as for sim_board::open_transport.
  void open_bus(const std::string& transport, const sim_board::TransportOptions& options,
                const std::filesystem::path& robot);
  // Shows what this function makes, in another thread; `file` is for the title.
  void open(const std::filesystem::path& file, std::function<Opened()> make);
  // Each scenario that is opened from now on passes through a function that `provider` gives at that time,
  // in another thread, before it is compiled.
  using Preparation = std::function<void(simulation::Scenario&)>;
  void set_preparation(std::function<Preparation()> provider) { preparation_ = std::move(provider); }
  // A scenario that is opened from now on has the overrides that `provider` gives for its file at that time:
  // edits of it that are not saved.
  using Edits = std::function<std::vector<Override>(const std::filesystem::path& scenario)>;
  void set_edits(Edits provider) { edits_ = std::move(provider); }
  // Every scenario that is opened from now on has the robot of this file instead of its own.
  void set_robot_of_scenarios(const std::filesystem::path& robot) {
    robot_of_scenarios_ = std::filesystem::absolute(robot);
  }
  // The overrides with which a scenario is read accordingly.
  std::vector<Override> overrides_of_scenarios() const;
  // Opens the scenario again with these overrides, and with the robot of set_robot().
  void reopen(std::span<const Override> overrides);
  // The file of the robot with which the scenario opens again, until another file is opened; empty: its own.
  void set_robot(const std::filesystem::path& robot) { robot_file_ = robot; }

  Source source() const { return source_; }
  const std::filesystem::path& file() const { return file_; }
  // If the run is recorded on the disk: samples, pushes and frames around the cursor, and the events read so
  // far.
  const view::Recording& recording() const { return recording_; }
  // Whether recording() holds a part of the run only.
  bool is_windowed() const { return recorded_ != nullptr; }
  // Null without a simulation.
  Session* session() { return session_.get(); }
  // Null without a bus.
  const BusMonitor* bus() const { return bus_.get(); }
  // The SDO channels of the bus for a client of one's own; null without a bus.
  std::shared_ptr<SdoLoan> borrow_sdo() { return bus_ ? bus_->borrow_sdo() : nullptr; }
  // The bus that open_bus() was called for last.
  const std::string& bus_address() const { return bus_address_; }
  // The robot of the simulation or on the bus; null for a recording.
  const sim_board::RobotDescription* robot() const;
  const SessionStatus& status() const { return status_; }
  bool playing() const;
  std::uint64_t cursor_us() const { return cursor_us_; }
  // The last moment of the run so far.
  std::uint64_t end_us() const;
  double speed() const { return speed_; }
  // Simulated seconds per second of the wall clock, measured over the last second.
  double pace() const { return pace_; }

  void set_playing(bool playing);
  // Advances a simulation by this much; moves the cursor in a recording.
  void step(std::uint64_t milliseconds);
  void set_speed(double speed);
  // Shows this moment.
  void set_cursor(std::uint64_t time_us);
  // Returns the simulation to the cursor, and forgets all that came after it.
  void rewind_to_cursor();
  void give(Input input);

 Q_SIGNALS:
  // Another scenario or recording: everything that was shown is gone.
  void opened();
  // Samples from this index on are new; frames, events and pushes may be.
  void grown(std::size_t first_sample);
  // The recording holds another part of the run: every index into it is void.
  void window_moved();
  // Values and times of these samples and these events of a recorded run have been read; in order of time.
  void overview_read(const std::vector<koboshi::view::Recording>& blocks);
  void answered(const koboshi::simulation::ObjectAnswer& answer);
  void rewound(std::uint64_t time_us);
  void cursor_moved(std::uint64_t time_us);
  void status_changed();
  // One line for the user.
  void failed(const QString& message);

 private:
  void poll();
  void take_batch(Batch batch);
  void take_status(SessionStatus status);
  SessionStatus bus_status() const;
  void play_recording();
  void read_recording_on();
  bool move_window(const std::function<bool(RecordingWindow&)>& move);
  void measure_pace();
  void show(Opened opened, const std::filesystem::path& file);

  Source source_ = Source::kNone;
  std::filesystem::path file_;
  std::function<Preparation()> preparation_;
  Edits edits_;
  std::unique_ptr<Session> session_;
  std::unique_ptr<BusMonitor> bus_;
  std::string bus_address_;
  std::unique_ptr<RecordedRun> recorded_;
  view::Recording recording_;
  SessionStatus status_;
  std::uint64_t cursor_us_ = 0;
  std::uint64_t polled_cursor_us_ = 0;  // at the last poll
  bool follow_ = true;
  double speed_ = 1.0;
  bool plays_recording_ = false;
  double played_us_ = 0.0;  // place of the playback, finer than the cursor
  QElapsedTimer played_;
  QTimer timer_;
  QElapsedTimer pace_timer_;
  std::uint64_t pace_start_us_ = 0;
  double pace_ = 0.0;
  std::filesystem::path robot_file_;  // of set_robot()
  std::filesystem::path robot_of_scenarios_;
  std::uint64_t request_ = 0;  // the last file asked for: an earlier one that comes late is dropped
};

}  // namespace koboshi::studio
