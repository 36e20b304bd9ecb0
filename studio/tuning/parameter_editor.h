#pragma once

#include <QObject>
#include <QString>
#include <QTimer>
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "sim_board/description/description.h"
#include "simulation/model/robot_model.h"
#include "simulation/scenario/object_access.h"
#include "studio/parameters/live_parameters.h"
#include "studio/parameters/parameter_document.h"

namespace koboshi::studio {

// The files of parameters of a robot and of the gait that its scenario walks with, and the controller that
// runs with them. One of the two files is shown and edited.
//
// While changes are applied live, every change of a document, also by undo and redo, is written to the
// running controller.
class ParameterEditor final : public QObject {  // Large: one function per action of the panel
  Q_OBJECT

 public:
  enum File { kRobot, kGait, kFiles };

  explicit ParameterEditor(QObject* parent = nullptr);

  // Opens the parameters beside the robot's file, unless they are open already. Without the file there is no
  // document. Errors are emitted as refused().
  void set_robot(const sim_board::RobotDescription& robot);
  // Opens the gait of a scenario; an empty path closes it.
  void set_gait(const std::filesystem::path& gait);
  void show(File file);
  File shown() const { return shown_; }
  bool has(File file) const { return files_[file].document.has_value(); }

  // The document of the file that is shown; null: it is not open.
  const ParameterDocument* document() const { return document(shown_); }
  const ParameterDocument* document(File file) const {
    return files_[file].document ? &*files_[file].document : nullptr;
  }
  // Whether one of the files has changes that are not saved.
  bool is_modified() const;
  bool is_modified(File file) const { return has(file) && document(file)->is_modified(); }
  const LiveParameters& live() const { return *files_[shown_].live; }

  // Each returns whether it changed something; an error is emitted as refused().
  bool set(std::size_t index, double value, const QString& drag = {});
  bool adopt(std::span<const ParameterValue> values, const QString& label);
  bool reset_to_file(std::size_t index);
  bool reset_to_default(std::size_t index);
  bool reset_all();
  void end_drag();
  bool undo();
  bool redo();
  // Refuses to overwrite what another program has written, unless forced.
  bool save(bool forced = false);
  bool reload();
  // Writes the recoveries of unsaved changes now, which stay after the end of the program.
  void keep_recoveries();
  // The user does not want the unsaved changes of this file: they leave no recovery.
  void discard(File file) { files_[file].is_discarded = true; }
  // The recovery that a crash has left of an open file; nothing: none.
  std::optional<std::pair<File, Recovery>> recovery() const;
  // Takes over the text of a recovery as one change, or drops it.
  void restore(File file, const Recovery& recovery);
  // The compiler's complaint about the shown document on this robot; empty: none.
  QString problem() const;

  // The running controller: none, with known values (a simulation), or a robot on a bus, to which nothing is
  // sent until the user reads, applies or switches to live.
  void run_closed();
  void run_opened(const app::ControllerValues& values);
  void run_attached();
  void run_rewound(std::uint64_t time_us);
  void take_answer(const simulation::ObjectAnswer& answer);
  bool is_connected() const { return connected_; }
  bool is_attached() const { return live_before_bus_.has_value(); }
  bool is_live() const { return is_live_; }
  void set_live(bool live);
  // Writes all values of the shown document that the controller does not have.
  void apply_all();
  void read_all();

  // Gives a scenario the values of the documents as they are now; usable in any thread.
  [[nodiscard]] std::function<void(simulation::Scenario&)> preparation() const;

 Q_SIGNALS:
  // Another document, or none.
  void opened();
  void changed();
  // By the user, also by undo and redo.
  void edited();
  void live_changed(std::size_t index);
  void all_live_changed();
  void refused(const QString& message);
  void requested(const koboshi::simulation::ObjectRequest& request);

 private:
  struct OpenFile {
    std::optional<ParameterDocument> document;
    std::unique_ptr<Autosave> autosave;  // of the document
    bool is_discarded = false;
    std::unique_ptr<LiveParameters> live;
  };

  OpenFile& file() { return files_[shown_]; }
  void open(File file, const std::filesystem::path& path);
  bool edit(const std::function<void(ParameterDocument&)>& change);
  void autosave();
  void write_changes(const std::vector<std::optional<double>>& before);
  std::vector<std::optional<double>> values() const;

  std::array<OpenFile, kFiles> files_;
  File shown_ = kRobot;
  std::filesystem::path robot_file_;
  std::optional<sim_board::RobotDescription> robot_;
  std::optional<simulation::NamedModel> model_;
  bool connected_ = false;
  bool is_live_ = true;
  std::optional<bool> live_before_bus_;  // while a bus is attached
  QTimer autosave_timer_;
};

}  // namespace koboshi::studio
