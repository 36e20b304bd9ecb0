#pragma once

#include <QAbstractTableModel>
#include <QTimer>
#include <QWidget>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sim_board/robot/description.h"
#include "sim_board/scenario/object_access.h"
#include "tools/dictionary/object_dictionary.h"

class QComboBox;
class QLabel;
class QLineEdit;
class QSortFilterProxyModel;
class QTableView;
class QCheckBox;

namespace koboshi::studio {

// The objects of a node with the values that were read. Editing a value asks to write it.
class ObjectModel final : public QAbstractTableModel {
  Q_OBJECT

 public:
  enum Column { kAddress, kName, kValue, kUnit, kAccess, kType, kColumns };

  explicit ObjectModel(QObject* parent = nullptr) : QAbstractTableModel(parent) {}
  // `kind` must outlive the model, or the next call of this function. Null: none.
  void set_kind(const tools::NodeKind* kind);
  canopen::ObjectAddress address(int row) const { return items_[static_cast<std::size_t>(row)]->address; }
  bool readable(int row) const;
  // The row of an object, -1: none.
  int row_of(canopen::ObjectAddress address) const;
  void set_value(int row, std::vector<std::uint8_t> data);
  void set_error(int row, const QString& error);

  int rowCount(const QModelIndex& parent = {}) const override;
  int columnCount(const QModelIndex& parent = {}) const override;
  QVariant data(const QModelIndex& index, int role) const override;
  bool setData(const QModelIndex& index, const QVariant& value, int role) override;
  Qt::ItemFlags flags(const QModelIndex& index) const override;
  QVariant headerData(int section, Qt::Orientation orientation, int role) const override;

 Q_SIGNALS:
  // The user wants this value, little-endian.
  void edited(int row, const std::vector<std::uint8_t>& data);
  // Text that is no value of the object.
  void refused(const QString& message);

 private:
  struct Value {
    std::vector<std::uint8_t> data;
    QString error;  // of the last access; empty: none
  };

  QString text_of(const tools::ObjectItem& item, const Value& value) const;

  std::vector<const tools::ObjectItem*> items_;
  std::vector<std::optional<Value>> values_;
};

// Returns the bytes of a value as a user writes it: a decimal or hexadecimal (0x) number, or one of the
// object's value names. Nothing for text that is no value of this object.
std::optional<std::vector<std::uint8_t>> object_bytes(const tools::ObjectItem& item, const QString& text);

// The object dictionaries of the nodes on the bus: reads and writes objects of the running robot by SDO.
class ObjectPanel final : public QWidget {
  Q_OBJECT

 public:
  explicit ObjectPanel(QWidget* parent = nullptr);

  // Shows the nodes of this robot; null: none, with which nothing can be read.
  void set_robot(const sim::RobotDescription* robot);
  void take_answer(const sim::ObjectAnswer& answer);
  // Forgets the requests that have no answer: the run has returned to an earlier moment.
  void forget_requests();

 Q_SIGNALS:
  void requested(const koboshi::sim::ObjectRequest& request);

 private:
  void show_node();
  void read_shown();
  void read(int row);
  void write(int row, const std::vector<std::uint8_t>& data);
  void request(int row, std::vector<std::uint8_t> data);
  std::uint8_t node_id() const;

  struct Pending {
    std::uint8_t node_id = 0;
    canopen::ObjectAddress address{};
    bool writes = false;
  };

  std::vector<tools::NodeKind> kinds_;
  ObjectModel* const model_;
  QSortFilterProxyModel* const shown_;
  QComboBox* const node_;
  QLineEdit* const filter_;
  QTableView* const table_;
  QLabel* const message_;
  QCheckBox* const live_;
  QTimer live_timer_;
  std::map<std::uint64_t, Pending> pending_;  // by number
  std::uint64_t last_number_ = 0;
};

}  // namespace koboshi::studio
