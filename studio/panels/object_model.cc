#include "studio/panels/object_model.h"

#include <QFontDatabase>
#include <algorithm>

namespace koboshi::studio {
namespace {

QString hex(unsigned value, int digits) {
  return QStringLiteral("%1").arg(value, digits, 16, QLatin1Char('0')).toUpper();
}

std::int64_t number_of(const bus::ObjectItem& item, const std::vector<std::uint8_t>& data) {
  std::uint64_t number = 0;
  for (std::size_t i = 0; i < data.size() && i < 8; ++i) number |= std::uint64_t{data[i]} << (8 * i);
  const std::size_t bits = 8 * data.size();
  if (bus::is_signed(item.data_type) && bits > 0 && bits < 64 && (number >> (bits - 1)) != 0)
    number |= ~std::uint64_t{0} << bits;
  return static_cast<std::int64_t>(number);
}

}  // namespace

std::optional<std::vector<std::uint8_t>> object_bytes(const bus::ObjectItem& item, const QString& text) {
  const unsigned bits = bus::size_bits(item.data_type);
  if (bits == 0) return std::nullopt;
  const QString trimmed = text.trimmed();
  bool ok = false;
  qlonglong number = trimmed.toLongLong(&ok, 10);
  if (!ok && trimmed.startsWith(QLatin1String("0x"))) number = trimmed.mid(2).toLongLong(&ok, 16);
  if (!ok) {
    const auto named = std::ranges::find_if(item.values, [&](const canopen::ValueName& value) {
      return trimmed == QString::fromUtf8(value.name.data(), static_cast<int>(value.name.size()));
    });
    if (named == item.values.end()) return std::nullopt;
    number = named->value;
  }
  const bool is_signed = bus::is_signed(item.data_type);
  const qlonglong span = qlonglong{1} << bits;
  const qlonglong low = is_signed ? -span / 2 : 0;
  const qlonglong high = is_signed ? span / 2 - 1 : span - 1;
  if (number < low || number > high) return std::nullopt;
  std::vector<std::uint8_t> bytes(bits / 8);
  for (std::size_t i = 0; i < bytes.size(); ++i)
    bytes[i] = static_cast<std::uint8_t>(static_cast<std::uint64_t>(number) >> (8 * i));
  return bytes;
}

void ObjectModel::set_kind(const bus::NodeKind* kind) {
  beginResetModel();
  items_.clear();
  if (kind != nullptr)
    for (const bus::Object& object : kind->objects)
      for (const bus::ObjectItem& item : object.items) items_.push_back(&item);
  values_.assign(items_.size(), std::nullopt);
  endResetModel();
}

bool ObjectModel::readable(int row) const { return items_[static_cast<std::size_t>(row)]->access != "wo"; }

int ObjectModel::row_of(canopen::ObjectAddress address) const {
  const auto found = std::ranges::find(items_, address, &bus::ObjectItem::address);
  return found == items_.end() ? -1 : static_cast<int>(found - items_.begin());
}

void ObjectModel::set_value(int row, std::vector<std::uint8_t> data) {
  values_[static_cast<std::size_t>(row)] = Value{std::move(data), {}};
  Q_EMIT dataChanged(index(row, kValue), index(row, kValue));
}

void ObjectModel::set_error(int row, const QString& error) {
  auto& value = values_[static_cast<std::size_t>(row)];
  if (!value) value.emplace();
  value->error = error;
  Q_EMIT dataChanged(index(row, kValue), index(row, kValue));
}

int ObjectModel::rowCount(const QModelIndex& parent) const {
  return parent.isValid() ? 0 : static_cast<int>(items_.size());
}

int ObjectModel::columnCount(const QModelIndex& parent) const { return parent.isValid() ? 0 : kColumns; }

QString ObjectModel::text_of(const bus::ObjectItem& item, const Value& value) const {
  if (!value.error.isEmpty()) return value.error;
  if (bus::size_bits(item.data_type) == 0)
    return QString::fromLatin1(reinterpret_cast<const char*>(value.data.data()),
                               static_cast<int>(value.data.size()));
  const std::int64_t number = number_of(item, value.data);
  const auto named = std::ranges::find_if(
      item.values, [&](const canopen::ValueName& one) { return std::int64_t{one.value} == number; });
  // Identifiers, mappings and node lists of the communication profile are read in hexadecimal.
  constexpr unsigned kFirstOfDevice = 0x2000;
  QString text =
      item.address.index < kFirstOfDevice && value.data.size() > 1
          ? QStringLiteral("0x") + hex(static_cast<unsigned>(number), 2 * static_cast<int>(value.data.size()))
          : QString::number(number);
  if (named != item.values.end())
    text += QStringLiteral(" (%1)").arg(
        QString::fromUtf8(named->name.data(), static_cast<int>(named->name.size())));
  return text;
}

QVariant ObjectModel::data(const QModelIndex& index, int role) const {
  if (!index.isValid()) return {};
  const bus::ObjectItem& item = *items_[static_cast<std::size_t>(index.row())];
  const auto& value = values_[static_cast<std::size_t>(index.row())];
  if (role == Qt::FontRole && index.column() == kAddress)
    return QFontDatabase::systemFont(QFontDatabase::FixedFont);
  if (role == Qt::ToolTipRole) {
    QStringList parts{QString::fromStdString(item.name)};
    if (!item.comment.empty()) parts << QString::fromStdString(item.comment);
    if (item.limits) parts << tr("From %1 to %2.").arg(item.limits->low).arg(item.limits->high);
    if (!item.default_value.empty())
      parts << tr("Default: %1.").arg(QString::fromStdString(item.default_value));
    if (value && value->error.isEmpty() && bus::size_bits(item.data_type) != 0) {
      QString bytes;
      for (auto byte = value->data.rbegin(); byte != value->data.rend(); ++byte) bytes += hex(*byte, 2);
      parts << QStringLiteral("0x") + bytes;
    }
    return parts.join(QLatin1Char('\n'));
  }
  if (role == Qt::EditRole && index.column() == kValue)
    return value && value->error.isEmpty() && bus::size_bits(item.data_type) != 0
               ? QVariant(QString::number(number_of(item, value->data)))
               : QVariant();
  if (role != Qt::DisplayRole) return {};
  switch (index.column()) {
    case kAddress:
      return hex(item.address.index, 4) + QLatin1Char(':') + hex(item.address.subindex, 2);
    case kName:
      return QString::fromStdString(item.name);
    case kValue:
      return value ? text_of(item, *value) : QString();
    case kUnit:
      return QString::fromStdString(bus::unit_text(item.unit));
    case kAccess:
      return QString::fromStdString(item.access);
    case kType:
      return QString::fromStdString(bus::data_type_name(item.data_type));
  }
  return {};
}

Qt::ItemFlags ObjectModel::flags(const QModelIndex& index) const {
  Qt::ItemFlags flags = QAbstractTableModel::flags(index);
  if (!index.isValid()) return flags;
  const bus::ObjectItem& item = *items_[static_cast<std::size_t>(index.row())];
  const bool writable = item.access.find('w') != std::string::npos && bus::size_bits(item.data_type) != 0;
  if (index.column() == kValue && writable) flags |= Qt::ItemIsEditable;
  return flags;
}

bool ObjectModel::setData(const QModelIndex& index, const QVariant& value, int role) {
  if (role != Qt::EditRole || !index.isValid()) return false;
  const bus::ObjectItem& item = *items_[static_cast<std::size_t>(index.row())];
  const auto bytes = object_bytes(item, value.toString());
  if (!bytes) {
    Q_EMIT refused(tr("Found %1, expected %2 or the name of a value")
                       .arg(value.toString(), QString::fromStdString(bus::data_type_name(item.data_type))));
    return false;
  }
  Q_EMIT edited(index.row(), *bytes);
  return true;
}

QVariant ObjectModel::headerData(int section, Qt::Orientation orientation, int role) const {
  if (orientation != Qt::Horizontal || role != Qt::DisplayRole) return {};
  switch (section) {
    case kAddress:
      return tr("Object");
    case kName:
      return tr("Name");
    case kValue:
      return tr("Value");
    case kUnit:
      return tr("Unit");
    case kAccess:
      return tr("Access");
    case kType:
      return tr("Type");
  }
  return {};
}

}  // namespace koboshi::studio
