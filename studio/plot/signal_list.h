#pragma once

#include <QLineEdit>
#include <QSortFilterProxyModel>
#include <QStandardItemModel>
#include <QStringList>
#include <QTreeView>
#include <QWidget>
#include <span>

#include "view/recording/recording.h"

namespace koboshi::studio {

// The type of dragged signals: their names in UTF-8, one a line.
inline constexpr char kSignalMimeType[] = "application/x-koboshi-signals";

// The signals as a tree: those whose names differ in the last part only, such as left_knee_target and
// left_knee_true, are in a group.
class SignalModel final : public QStandardItemModel {
  Q_OBJECT

 public:
  static constexpr int kNameRole = Qt::UserRole + 1;  // of a signal; empty for a group

  explicit SignalModel(QObject* parent = nullptr);
  void set_signals(std::span<const view::Signal> signals);

  QStringList mimeTypes() const override;
  QMimeData* mimeData(const QModelIndexList& indexes) const override;
};

// Returns the names of signals in dragged data.
QStringList dragged_signals(const QMimeData& data);

// A searchable list of signals, from which they are dragged, or added to the plots by a double click or the
// Enter key.
class SignalList final : public QWidget {
  Q_OBJECT

 public:
  explicit SignalList(QWidget* parent = nullptr);
  void set_signals(std::span<const view::Signal> signals);

 Q_SIGNALS:
  void chosen(const QStringList& names);

 private:
  void choose(const QModelIndex& index);

  QLineEdit* search_;
  QTreeView* tree_;
  SignalModel* model_;
  QSortFilterProxyModel* proxy_;
};

}  // namespace koboshi::studio
