#pragma once

#include <QAbstractTableModel>
#include <QWidget>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "bus/can/describe.h"
#include "bus/can/sdo_blocks.h"
#include "bus/dictionary/network.h"
#include "studio/panels/node_table.h"
#include "view/recording/recording.h"

class QLabel;
class QLineEdit;
class QTabWidget;
class QTableView;

namespace koboshi::studio {

// The frames of a run that pass a filter, decoded when they are shown: time, identifier, node or message,
// data, meaning.
class FrameModel final : public QAbstractTableModel {
  Q_OBJECT

 public:
  enum Column { kTime, kIdentifier, kSender, kData, kMeaning, kColumns };

  explicit FrameModel(QObject* parent = nullptr);
  // The recording must outlive the model, or the next call of this function. Null: none.
  void set_recording(const view::Recording* recording, bus::Network network);
  // Adds the frames that the recording has got since; after a rewind, drops those that it has lost.
  void update();
  // Begins again: the recording has other frames.
  void reset();
  // Shows frames whose identifier, sender or kind contains this text; all words must be found.
  void set_filter(const QString& text);
  // The row of the last frame at or before a time, -1: none.
  int row_at(std::uint64_t time_us) const;
  std::uint64_t time_us(int row) const;

  int rowCount(const QModelIndex& parent = {}) const override;
  int columnCount(const QModelIndex& parent = {}) const override;
  QVariant data(const QModelIndex& index, int role) const override;
  QVariant headerData(int section, Qt::Orientation orientation, int role) const override;

 private:
  static constexpr std::size_t kIdentifiers = 2048;

  QString sender_of(const hal::CanFrame& frame) const;
  QString meaning_of(std::uint32_t row) const;  // an index of the recording
  bool passes(const hal::CanFrame& frame);

  const view::Recording* recording_ = nullptr;
  bus::Network network_;
  bus::ObjectNames names_;
  QString filter_;
  std::vector<signed char> passing_;  // by identifier: 1 shown, 0 not, -1 unknown
  std::size_t seen_ = 0;              // frames of the recording
  bus::SdoBlocks blocks_;
  std::vector<bool> segments_;       // frames of the recording that are segments of SDO blocks
  std::vector<std::uint32_t> rows_;  // indices of frames
};

// The CAN bus of a run: frames at the cursor, filtered, and counters.
class CanPanel final : public QWidget {
  Q_OBJECT

 public:
  explicit CanPanel(QWidget* parent = nullptr);
  // As FrameModel::set_recording. `is_part`: the recording holds the frames around the cursor only.
  void set_recording(const view::Recording* recording, bus::Network network, bool is_part = false);
  // Shows the recording's frames anew: they are others.
  void reset_frames();
  void update_frames();
  // Nodes and load of a simulated bus; no nodes: unknown.
  void show_nodes(const SessionStatus& status);
  // Scrolls to this moment.
  void set_cursor(std::uint64_t time_us);

 Q_SIGNALS:
  // The user has chosen a frame.
  void cursor_moved(std::uint64_t time_us);

 private:
  void show_count();

  FrameModel* const model_;
  NodeModel* const nodes_;
  QLineEdit* const filter_;
  QTableView* const table_;
  QTableView* const node_table_;
  QTabWidget* const tables_;
  QLabel* const count_;
  const view::Recording* recording_ = nullptr;
  bool is_part_ = false;
  double bus_load_ = 0.0;
  std::uint64_t cursor_us_ = 0;
};

}  // namespace koboshi::studio
