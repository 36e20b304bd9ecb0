#include "tools/studio/window/object_panel.h"

#include <QCheckBox>
#include <QComboBox>
#include <QFontDatabase>
#include <QHBoxLayout>
#include <QHeaderView>
#include <QLabel>
#include <QLineEdit>
#include <QPushButton>
#include <QSortFilterProxyModel>
#include <QTableView>
#include <QVBoxLayout>
#include <algorithm>

#include "sim_board/sensor/sensor_node.h"
#include "simulation/model/robot_model.h"
#include "tools/can/sdo_transfer.h"
#include "tools/dictionary/network.h"
#include "tools/dictionary/node_kinds.h"

namespace koboshi::studio {
namespace {

constexpr int kLivePeriod_ms = 500;
// Rows that are read again in each period: an access takes up to a control cycle of 10 ms.
constexpr int kLiveRows = 24;

QString hex(unsigned value, int digits) {
  return QStringLiteral("%1").arg(value, digits, 16, QLatin1Char('0')).toUpper();
}

std::int64_t number_of(const tools::ObjectItem& item, const std::vector<std::uint8_t>& data) {
  std::uint64_t number = 0;
  for (std::size_t i = 0; i < data.size() && i < 8; ++i) number |= std::uint64_t{data[i]} << (8 * i);
  const std::size_t bits = 8 * data.size();
  if (tools::is_signed(item.data_type) && bits > 0 && bits < 64 && (number >> (bits - 1)) != 0)
    number |= ~std::uint64_t{0} << bits;
  return static_cast<std::int64_t>(number);
}

// Which kind of node this is, by its number.
const char* kind_of_node(std::uint8_t node_id, const sim::RobotDescription& robot) {
  const auto is_drive = std::ranges::any_of(
      robot.joints, [&](const sim::JointDescription& joint) { return joint.drive.node_id == node_id; });
  if (is_drive) return "drive";
  if (node_id == sim::kInertialNode) return "inertial";
  if (node_id == sim::kLeftAnkleNode || node_id == sim::kRightAnkleNode) return "ankle";
  return "controller";
}

}  // namespace

std::optional<std::vector<std::uint8_t>> object_bytes(const tools::ObjectItem& item, const QString& text) {
  const unsigned bits = tools::size_bits(item.data_type);
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
  const bool is_signed = tools::is_signed(item.data_type);
  const qlonglong span = qlonglong{1} << bits;
  const qlonglong low = is_signed ? -span / 2 : 0;
  const qlonglong high = is_signed ? span / 2 - 1 : span - 1;
  if (number < low || number > high) return std::nullopt;
  std::vector<std::uint8_t> bytes(bits / 8);
  for (std::size_t i = 0; i < bytes.size(); ++i)
    bytes[i] = static_cast<std::uint8_t>(static_cast<std::uint64_t>(number) >> (8 * i));
  return bytes;
}

void ObjectModel::set_kind(const tools::NodeKind* kind) {
  beginResetModel();
  items_.clear();
  if (kind != nullptr)
    for (const tools::Object& object : kind->objects)
      for (const tools::ObjectItem& item : object.items) items_.push_back(&item);
  values_.assign(items_.size(), std::nullopt);
  endResetModel();
}

bool ObjectModel::readable(int row) const { return items_[static_cast<std::size_t>(row)]->access != "wo"; }

int ObjectModel::row_of(canopen::ObjectAddress address) const {
  const auto found = std::ranges::find(items_, address, &tools::ObjectItem::address);
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

QString ObjectModel::text_of(const tools::ObjectItem& item, const Value& value) const {
  if (!value.error.isEmpty()) return value.error;
  if (tools::size_bits(item.data_type) == 0)
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
  const tools::ObjectItem& item = *items_[static_cast<std::size_t>(index.row())];
  const auto& value = values_[static_cast<std::size_t>(index.row())];
  if (role == Qt::FontRole && index.column() == kAddress)
    return QFontDatabase::systemFont(QFontDatabase::FixedFont);
  if (role == Qt::ToolTipRole) {
    QStringList parts{QString::fromStdString(item.name)};
    if (!item.comment.empty()) parts << QString::fromStdString(item.comment);
    if (item.limits) parts << tr("From %1 to %2.").arg(item.limits->low).arg(item.limits->high);
    if (!item.default_value.empty())
      parts << tr("Default: %1.").arg(QString::fromStdString(item.default_value));
    if (value && value->error.isEmpty() && tools::size_bits(item.data_type) != 0) {
      QString bytes;
      for (auto byte = value->data.rbegin(); byte != value->data.rend(); ++byte) bytes += hex(*byte, 2);
      parts << QStringLiteral("0x") + bytes;
    }
    return parts.join(QLatin1Char('\n'));
  }
  if (role == Qt::EditRole && index.column() == kValue)
    return value && value->error.isEmpty() && tools::size_bits(item.data_type) != 0
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
      return QString::fromStdString(tools::unit_text(item.unit));
    case kAccess:
      return QString::fromStdString(item.access);
    case kType:
      return QString::fromStdString(tools::data_type_name(item.data_type));
  }
  return {};
}

Qt::ItemFlags ObjectModel::flags(const QModelIndex& index) const {
  Qt::ItemFlags flags = QAbstractTableModel::flags(index);
  if (!index.isValid()) return flags;
  const tools::ObjectItem& item = *items_[static_cast<std::size_t>(index.row())];
  const bool writable = item.access.find('w') != std::string::npos && tools::size_bits(item.data_type) != 0;
  if (index.column() == kValue && writable) flags |= Qt::ItemIsEditable;
  return flags;
}

bool ObjectModel::setData(const QModelIndex& index, const QVariant& value, int role) {
  if (role != Qt::EditRole || !index.isValid()) return false;
  const tools::ObjectItem& item = *items_[static_cast<std::size_t>(index.row())];
  const auto bytes = object_bytes(item, value.toString());
  if (!bytes) {
    Q_EMIT refused(tr("Found %1, expected %2 or the name of a value")
                       .arg(value.toString(), QString::fromStdString(tools::data_type_name(item.data_type))));
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

ObjectPanel::ObjectPanel(QWidget* parent)
    : QWidget(parent),
      model_(new ObjectModel(this)),
      shown_(new QSortFilterProxyModel(this)),
      node_(new QComboBox(this)),
      filter_(new QLineEdit(this)),
      table_(new QTableView(this)),
      message_(new QLabel(this)),
      live_(new QCheckBox(tr("Live"), this)) {
  node_->setAccessibleName(tr("Node"));
  node_->setSizeAdjustPolicy(QComboBox::AdjustToContents);
  node_->setToolTip(tr("Node whose object dictionary is shown"));
  filter_->setPlaceholderText(tr("Filter: index or name"));
  filter_->setClearButtonEnabled(true);
  filter_->setAccessibleName(tr("Filter of objects"));
  auto* read_all = new QPushButton(tr("Read"), this);
  read_all->setObjectName(QStringLiteral("read_objects"));
  read_all->setToolTip(tr("Reads all objects that are shown, by SDO"));
  live_->setToolTip(tr("Reads the visible objects twice a second"));
  auto* bar = new QHBoxLayout;
  bar->addWidget(node_);
  bar->addWidget(filter_, 1);
  bar->addWidget(read_all);
  bar->addWidget(live_);

  shown_->setSourceModel(model_);
  shown_->setFilterKeyColumn(-1);
  shown_->setFilterCaseSensitivity(Qt::CaseInsensitive);
  table_->setModel(shown_);
  table_->setSelectionBehavior(QAbstractItemView::SelectRows);
  table_->setWordWrap(false);
  table_->setAlternatingRowColors(true);
  table_->verticalHeader()->hide();
  table_->verticalHeader()->setDefaultSectionSize(table_->fontMetrics().height() + 6);
  table_->horizontalHeader()->setStretchLastSection(true);
  const int digit = table_->fontMetrics().horizontalAdvance(QLatin1Char('0'));
  table_->setColumnWidth(ObjectModel::kAddress, 10 * digit);
  table_->setColumnWidth(ObjectModel::kName, 34 * digit);
  table_->setColumnWidth(ObjectModel::kValue, 24 * digit);
  table_->setAccessibleName(tr("Objects"));
  message_->setWordWrap(true);
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(4, 4, 4, 4);
  layout->addLayout(bar);
  layout->addWidget(table_, 1);
  layout->addWidget(message_);

  connect(node_, qOverload<int>(&QComboBox::currentIndexChanged), this, &ObjectPanel::show_node);
  connect(filter_, &QLineEdit::textChanged, shown_, &QSortFilterProxyModel::setFilterFixedString);
  connect(read_all, &QPushButton::clicked, this, [this] {
    for (int row = 0; row < shown_->rowCount(); ++row) read(shown_->mapToSource(shown_->index(row, 0)).row());
  });
  connect(table_, &QTableView::clicked, this,
          [this](const QModelIndex& index) { read(shown_->mapToSource(index).row()); });
  connect(model_, &ObjectModel::edited, this, &ObjectPanel::write);
  connect(model_, &ObjectModel::refused, message_, &QLabel::setText);
  connect(live_, &QCheckBox::toggled, this, [this](bool on) {
    if (on) {
      live_timer_.start(kLivePeriod_ms);
    } else {
      live_timer_.stop();
    }
  });
  connect(&live_timer_, &QTimer::timeout, this, &ObjectPanel::read_shown);
}

void ObjectPanel::set_robot(const sim::RobotDescription* robot) {
  pending_.clear();
  model_->set_kind(nullptr);
  node_->clear();
  kinds_.clear();
  message_->clear();
  setEnabled(robot != nullptr);
  if (robot == nullptr) return;
  kinds_ = tools::documented_kinds(simulation::load_named_model(*robot).model);
  for (const tools::NetworkNode& node : tools::network_nodes(*robot)) {
    if (node.node_id == 0) continue;
    node_->addItem(QStringLiteral("%1  %2").arg(node.node_id).arg(QString::fromStdString(node.name)),
                   QVariantList{node.node_id, QLatin1String(kind_of_node(node.node_id, *robot))});
  }
  show_node();
}

std::uint8_t ObjectPanel::node_id() const {
  const QVariantList chosen = node_->currentData().toList();
  return chosen.isEmpty() ? std::uint8_t{0} : static_cast<std::uint8_t>(chosen.front().toInt());
}

void ObjectPanel::show_node() {
  const QVariantList chosen = node_->currentData().toList();
  if (chosen.isEmpty()) return model_->set_kind(nullptr);
  const std::string name = chosen.back().toString().toStdString();
  const auto kind = std::ranges::find(kinds_, name, &tools::NodeKind::name);
  model_->set_kind(kind == kinds_.end() ? nullptr : &*kind);
  message_->clear();
}

void ObjectPanel::read_shown() {
  if (!isVisible() || !pending_.empty()) return;  // the last reading is still under way
  int row = table_->rowAt(0);
  for (int count = 0; row >= 0 && row < shown_->rowCount() && count < kLiveRows; ++row, ++count)
    read(shown_->mapToSource(shown_->index(row, 0)).row());
}

void ObjectPanel::read(int row) {
  if (model_->readable(row)) request(row, {});
}

// Reads the value again afterwards: a node may have rounded it.
void ObjectPanel::write(int row, const std::vector<std::uint8_t>& data) {
  request(row, data);
  read(row);
}

void ObjectPanel::request(int row, std::vector<std::uint8_t> data) {
  sim::ObjectRequest request{.number = ++last_number_,
                             .node_id = node_id(),
                             .address = model_->address(row),
                             .data = std::move(data)};
  pending_[request.number] = {request.node_id, request.address, !request.data.empty()};
  Q_EMIT requested(request);
}

void ObjectPanel::take_answer(const sim::ObjectAnswer& answer) {
  const auto found = pending_.find(answer.number);
  if (found == pending_.end()) return;
  const Pending pending = found->second;
  pending_.erase(found);
  const int row = model_->row_of(pending.address);
  if (pending.node_id != node_id() || row < 0) return;
  if (answer.abort == canopen::AbortCode::kNone) {
    if (!pending.writes) model_->set_value(row, answer.data);
    if (pending.writes) message_->clear();
    return;
  }
  const QString error = QString::fromUtf8(tools::SdoAborted(answer.abort).what());
  if (pending.writes) {
    message_->setText(tr("Not written: %1").arg(error));
  } else {
    model_->set_error(row, error);
  }
}

void ObjectPanel::forget_requests() { pending_.clear(); }

}  // namespace koboshi::studio
