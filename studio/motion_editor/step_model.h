#pragma once

#include <QAbstractTableModel>
#include <QColor>
#include <QIcon>
#include <QPalette>
#include <QStringList>
#include <array>
#include <functional>
#include <string>
#include <vector>

#include "studio/motion_editor/motion_editor.h"

namespace koboshi::studio {

// The steps as a table. A change of the document emits signals for the cells whose contents change.
class StepModel final : public QAbstractTableModel {
  Q_OBJECT

 public:
  enum Column { kStep, kStart, kTime, kSpeed, kPause, kInterpolation, kFinding, kColumns };

  explicit StepModel(MotionEditor& editor, QObject* parent = nullptr);

  // A change of one of the selected rows concerns all of them that have such a value.
  void set_selection(std::function<std::vector<std::size_t>()> selected) { selected_ = std::move(selected); }
  // Takes over the signs for another palette.
  void set_palette(const QPalette& palette);
  const MotionEditor& editor() const { return editor_; }

  int rowCount(const QModelIndex& parent = {}) const override;
  int columnCount(const QModelIndex& parent = {}) const override;
  QVariant data(const QModelIndex& index, int role) const override;
  QVariant headerData(int section, Qt::Orientation orientation, int role) const override;
  Qt::ItemFlags flags(const QModelIndex& index) const override;
  bool setData(const QModelIndex& index, const QVariant& value, int role) override;

  // Rows are moved by drag and drop within the table.
  Qt::DropActions supportedDropActions() const override { return Qt::MoveAction; }
  QStringList mimeTypes() const override;
  QMimeData* mimeData(const QModelIndexList& indexes) const override;
  bool canDropMimeData(const QMimeData* data, Qt::DropAction action, int row, int column,
                       const QModelIndex& parent) const override;
  bool dropMimeData(const QMimeData* data, Qt::DropAction action, int row, int column,
                    const QModelIndex& parent) override;

  // Whether the cell has a value that can be edited.
  bool is_editable(std::size_t row, Column column) const;

 Q_SIGNALS:
  // Rows were moved by a drop: the first one and their number.
  void rows_dropped(std::size_t first, std::size_t count);

 private:
  // The contents of a row.
  struct Cells {
    std::array<QString, kColumns> text = {};
    int depth = 0;
    simulation::StepSource::Kind kind = simulation::StepSource::Kind::kEnd;
    bool inherits_interpolation = false;
    int severity = -1;  // of the worst finding; -1: none
    QString findings = {};

    bool operator==(const Cells&) const = default;
    bool is_same_step(const Cells& other) const {
      return text[kStep] == other.text[kStep] && kind == other.kind && depth == other.depth;
    }
  };

  Cells cells_of(const MotionRow& row, std::size_t index) const;
  void reset();
  void refresh();
  void emit_changes(const std::vector<Cells>& wanted);
  QString tooltip(std::size_t row, int column) const;
  QVariant decoration(const Cells& cells, int column) const;
  QVariant edit_value(const MotionRow& row, int column) const;
  void apply(MotionDocument& document, const std::vector<std::size_t>& rows, int column,
             const QVariant& value) const;
  // The key of the value that is edited in the column of steps, "loop.times", with its text; empty: none.
  struct StepValue {
    std::string key;
    std::string text;
    bool is_flow = false;  // a list or map in flow style
  };
  StepValue step_value(const MotionRow& row) const;
  std::vector<std::size_t> concerned(std::size_t row, Column column) const;

  MotionEditor& editor_;
  std::function<std::vector<std::size_t>()> selected_;
  std::vector<Cells> cells_;
  std::array<QIcon, 16> kind_icons_;
  std::array<QIcon, 3> severity_icons_;
  QColor dim_;
};

}  // namespace koboshi::studio
