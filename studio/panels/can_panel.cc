#include "studio/panels/can_panel.h"

#include <QFontDatabase>
#include <QLabel>
#include <QLineEdit>
#include <QTabWidget>
#include <QTableView>
#include <QVBoxLayout>
#include <algorithm>
#include <string>
#include <utility>

#include "bus/can/frame_text.h"
#include "bus/dictionary/object_names.h"
#include "studio/run/bus_load.h"
#include "studio/widgets/table_style.h"

namespace koboshi::studio {
namespace {

QString kind_name(bus::FrameKind kind) {
  switch (kind) {
    case bus::FrameKind::kNmt:
      return QStringLiteral("NMT");
    case bus::FrameKind::kSync:
      return QStringLiteral("SYNC");
    case bus::FrameKind::kEmergency:
      return QStringLiteral("EMCY");
    case bus::FrameKind::kTime:
      return QStringLiteral("TIME");
    case bus::FrameKind::kPdo:
      return QStringLiteral("PDO");
    case bus::FrameKind::kSdo:
      return QStringLiteral("SDO");
    case bus::FrameKind::kHeartbeat:
      return QStringLiteral("heartbeat");
    case bus::FrameKind::kLss:
      return QStringLiteral("LSS");
    case bus::FrameKind::kOther:
      return QStringLiteral("other");
  }
  return {};
}

}  // namespace

FrameModel::FrameModel(QObject* parent)
    : QAbstractTableModel(parent), names_(bus::object_names()), passing_(kIdentifiers, -1) {}

void FrameModel::set_recording(const view::Recording* recording, bus::Network network) {
  recording_ = recording;
  network_ = std::move(network);
  passing_.assign(kIdentifiers, -1);
  reset();
}

void FrameModel::update() {
  if (recording_ == nullptr) return;
  const std::size_t count = recording_->frames.size();
  if (count < seen_) {
    const auto kept = std::ranges::lower_bound(rows_, static_cast<std::uint32_t>(count));
    const auto first = static_cast<int>(kept - rows_.begin());
    if (kept != rows_.end()) {
      beginRemoveRows({}, first, static_cast<int>(rows_.size()) - 1);
      rows_.erase(kept, rows_.end());
      endRemoveRows();
    }
    seen_ = count;
    segments_.clear();
    blocks_ = {};
    for (std::size_t i = 0; i < count; ++i) segments_.push_back(blocks_.follow(recording_->frames[i].frame));
  }
  std::vector<std::uint32_t> added;
  for (; seen_ < count; ++seen_) {
    const hal::CanFrame& frame = recording_->frames[seen_].frame;
    segments_.push_back(blocks_.follow(frame));
    if (passes(frame)) added.push_back(static_cast<std::uint32_t>(seen_));
  }
  if (added.empty()) return;
  beginInsertRows({}, static_cast<int>(rows_.size()), static_cast<int>(rows_.size() + added.size()) - 1);
  rows_.insert(rows_.end(), added.begin(), added.end());
  endInsertRows();
}

void FrameModel::reset() {
  beginResetModel();
  seen_ = 0;
  segments_.clear();
  blocks_ = {};
  rows_.clear();
  endResetModel();
  update();
}

void FrameModel::set_filter(const QString& text) {
  filter_ = text.simplified();
  passing_.assign(kIdentifiers, -1);
  reset();
}

bool FrameModel::passes(const hal::CanFrame& frame) {
  signed char& passing = passing_[frame.identifier % kIdentifiers];
  if (passing < 0) {
    const QString text = QStringLiteral("%1 %2 %3")
                             .arg(frame.identifier, 3, 16, QLatin1Char('0'))
                             .arg(sender_of(frame), kind_name(bus::kind_of(frame)));
    const QStringList words = filter_.split(QLatin1Char(' '), Qt::SkipEmptyParts);
    passing = std::ranges::all_of(
        words, [&](const QString& word) { return text.contains(word, Qt::CaseInsensitive); });
  }
  return passing == 1;
}

int FrameModel::row_at(std::uint64_t time_us) const {
  const auto after = std::ranges::upper_bound(
      rows_, time_us, {}, [this](std::uint32_t i) { return recording_->frames[i].end_us; });
  return static_cast<int>(after - rows_.begin()) - 1;
}

std::uint64_t FrameModel::time_us(int row) const {
  return recording_->frames[rows_[static_cast<std::size_t>(row)]].end_us;
}

int FrameModel::rowCount(const QModelIndex& parent) const {
  return parent.isValid() ? 0 : static_cast<int>(rows_.size());
}

int FrameModel::columnCount(const QModelIndex& parent) const { return parent.isValid() ? 0 : kColumns; }

QString FrameModel::sender_of(const hal::CanFrame& frame) const {
  if (const bus::Message* message = network_.find(frame.identifier))
    return QString::fromStdString(message->name);
  const int node = bus::node_of(frame);
  const auto known =
      std::ranges::find(network_.nodes, node, [](const bus::NetworkNode& one) { return int{one.node_id}; });
  if (node != 0 && known != network_.nodes.end()) return QString::fromStdString(known->name);
  return kind_name(bus::kind_of(frame));
}

QString FrameModel::meaning_of(std::uint32_t row) const {
  const hal::CanFrame& frame = recording_->frames[row].frame;
  const std::string described = bus::describe(frame, names_, segments_[row]);
  if (!described.empty()) return QString::fromStdString(described);
  QStringList readings;
  for (const bus::Reading& reading : bus::decode(network_, frame)) {
    const QString value = reading.name.empty()
                              ? QString::number(reading.value, 'g', 6)
                              : QString::fromUtf8(reading.name.data(), static_cast<int>(reading.name.size()));
    readings << QStringLiteral("%1 %2 %3")
                    .arg(QString::fromStdString(reading.signal->name), value,
                         QString::fromStdString(reading.signal->unit))
                    .trimmed();
  }
  return readings.join(QStringLiteral(", "));
}

QVariant FrameModel::data(const QModelIndex& index, int role) const {
  if (!index.isValid()) return {};
  const view::Frame& frame = recording_->frames[rows_[static_cast<std::size_t>(index.row())]];
  if (role == Qt::FontRole && index.column() != kMeaning && index.column() != kSender)
    return QFontDatabase::systemFont(QFontDatabase::FixedFont);
  if (role != Qt::DisplayRole && role != Qt::ToolTipRole) return {};
  switch (index.column()) {
    case kTime:
      return QString::number(1e-6 * static_cast<double>(frame.end_us), 'f', 6);
    case kIdentifier:
      return QStringLiteral("%1").arg(frame.frame.identifier, 3, 16, QLatin1Char('0')).toUpper();
    case kSender:
      return sender_of(frame.frame);
    case kData: {
      const QString text = QString::fromStdString(bus::frame_text(frame.frame));
      return text.mid(text.indexOf(QLatin1Char('#')) + 1);
    }
    case kMeaning:
      return meaning_of(rows_[static_cast<std::size_t>(index.row())]);
  }
  return {};
}

QVariant FrameModel::headerData(int section, Qt::Orientation orientation, int role) const {
  if (orientation != Qt::Horizontal || role != Qt::DisplayRole) return {};
  switch (section) {
    case kTime:
      return tr("Time [s]");
    case kIdentifier:
      return tr("COB-ID");
    case kSender:
      return tr("Message or node");
    case kData:
      return tr("Data");
    case kMeaning:
      return tr("Meaning");
  }
  return {};
}

CanPanel::CanPanel(QWidget* parent)
    : QWidget(parent),
      model_(new FrameModel(this)),
      nodes_(new NodeModel(this)),
      filter_(new QLineEdit(this)),
      table_(new QTableView(this)),
      node_table_(new QTableView(this)),
      tables_(new QTabWidget(this)),
      count_(new QLabel(this)) {
  filter_->setPlaceholderText(tr("Filter: identifier, node or kind, such as left_knee PDO"));
  filter_->setClearButtonEnabled(true);
  filter_->setAccessibleName(tr("Filter of frames"));
  connect(filter_, &QLineEdit::textChanged, this, [this](const QString& text) {
    model_->set_filter(text);
    update_frames();
  });
  table_->setModel(model_);
  table_->setObjectName(QStringLiteral("frames"));
  style_table(*table_, tr("Frames on the CAN bus"), {13, 9, 24, 22});
  node_table_->setModel(nodes_);
  style_table(*node_table_, tr("Nodes on the CAN bus"), {24, 14, 9, 9, 9, 9});
  node_table_->setSelectionMode(QAbstractItemView::NoSelection);
  connect(table_, &QTableView::clicked, this,
          [this](const QModelIndex& index) { Q_EMIT cursor_moved(model_->time_us(index.row())); });
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(4, 4, 4, 4);
  layout->addWidget(filter_);
  tables_->addTab(table_, tr("Frames"));
  tables_->addTab(node_table_, tr("Nodes"));
  tables_->setTabPosition(QTabWidget::West);
  layout->addWidget(tables_, 1);
  layout->addWidget(count_);
}

void CanPanel::set_recording(const view::Recording* recording, bus::Network network, bool is_part) {
  recording_ = recording;
  is_part_ = is_part;
  nodes_->set_names(network.nodes);
  model_->set_recording(recording, std::move(network));
  update_frames();
}

void CanPanel::reset_frames() {
  model_->reset();
  show_count();
}

void CanPanel::update_frames() {
  model_->update();
  show_count();
}

// The load of a simulated bus is that of its bits; of other buses it follows from the frames of the last
// second before the cursor.
void CanPanel::show_count() {
  if (recording_ == nullptr) return count_->clear();
  const auto of = static_cast<qulonglong>(recording_->frames.size());
  QString text = is_part_ ? tr("%1 of %2 frames around the cursor").arg(model_->rowCount()).arg(of)
                          : tr("%1 of %2 frames").arg(model_->rowCount()).arg(of);
  if (nodes_->rowCount() > 0) {
    text += tr(", bus load %1 %").arg(100.0 * bus_load_, 0, 'f', 0);
  } else if (of > 0) {
    text += tr(", bus load %1 % at 1 Mbit/s; error counters are known of simulations only")
                .arg(100.0 * load_of_frames(recording_->frames, cursor_us_), 0, 'f', 0);
  }
  count_->setText(text);
}

void CanPanel::show_nodes(const SessionStatus& status) {
  bus_load_ = status.bus_load;
  nodes_->show(status.nodes);
  tables_->setTabEnabled(tables_->indexOf(node_table_), !status.nodes.empty());
  show_count();
}

void CanPanel::set_cursor(std::uint64_t time_us) {
  cursor_us_ = time_us;
  if (nodes_->rowCount() == 0) show_count();
  const int row = recording_ == nullptr ? -1 : model_->row_at(time_us);
  if (row < 0) return;
  table_->setCurrentIndex(model_->index(row, 0));
}

}  // namespace koboshi::studio
