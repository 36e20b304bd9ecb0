#pragma once

#include <QAbstractTableModel>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "bus/dictionary/object_dictionary.h"

namespace koboshi::studio {

// The objects of a node with the values that were read. Editing a value asks to write it.
class ObjectModel final : public QAbstractTableModel {
  Q_OBJECT

 public:
  enum Column { kAddress, kName, kValue, kUnit, kAccess, kType, kColumns };

  explicit ObjectModel(QObject* parent = nullptr) : QAbstractTableModel(parent) {}
  // `kind` must outlive the model, or the next call of this function. Null: none.
  void set_kind(const bus::NodeKind* kind);
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

  QString text_of(const bus::ObjectItem& item, const Value& value) const;

  std::vector<const bus::ObjectItem*> items_;
  std::vector<std::optional<Value>> values_;
};

// Returns the bytes of a value as a user writes it: a decimal or hexadecimal (0x) number, or one of the
// object's value names. Nothing for text that is no value of this object.
std::optional<std::vector<std::uint8_t>> object_bytes(const bus::ObjectItem& item, const QString& text);

}  // namespace koboshi::studio
