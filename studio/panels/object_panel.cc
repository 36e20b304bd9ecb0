#include "studio/panels/object_panel.h"

#include <QCheckBox>
#include <QComboBox>
#include <QHBoxLayout>
#include <QLabel>
#include <QLineEdit>
#include <QPushButton>
#include <QSortFilterProxyModel>
#include <QTableView>
#include <QVBoxLayout>
#include <algorithm>

#include "bus/can/sdo_transfer.h"
#include "bus/dictionary/network.h"
#include "bus/dictionary/node_kinds.h"
#include "sim_board/sensor/sensor_node.h"
#include "simulation/model/robot_model.h"
#include "studio/widgets/table_style.h"

namespace koboshi::studio {
namespace {

constexpr int kLivePeriod_ms = 500;
// Rows that are read again in each period: an access takes up to a control cycle of 10 ms.
constexpr int kLiveRows = 24;

// Returns the kind of a node by its number.
const char* kind_of_node(std::uint8_t node_id, const sim_board::RobotDescription& robot) {
  const auto is_drive = std::ranges::any_of(
      robot.joints, [&](const sim_board::JointDescription& joint) { return joint.drive.node_id == node_id; });
  if (is_drive) return "drive";
  if (node_id == sim_board::kInertialNode) return "inertial";
  if (node_id == sim_board::kLeftAnkleNode || node_id == sim_board::kRightAnkleNode) return "ankle";
  return "controller";
}

}  // namespace

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
  style_table(*table_, tr("Objects"), {10, 34, 24});
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

void ObjectPanel::set_robot(const sim_board::RobotDescription* robot) {
  pending_.clear();
  model_->set_kind(nullptr);
  node_->clear();
  kinds_.clear();
  message_->clear();
  setEnabled(robot != nullptr);
  if (robot == nullptr) return;
  kinds_ = bus::documented_kinds(simulation::load_named_model(*robot).model);
  for (const bus::NetworkNode& node : bus::network_nodes(*robot)) {
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
  const auto kind = std::ranges::find(kinds_, name, &bus::NodeKind::name);
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
  simulation::ObjectRequest request{.number = ++last_number_,
                                    .node_id = node_id(),
                                    .address = model_->address(row),
                                    .data = std::move(data)};
  pending_[request.number] = {request.node_id, request.address, !request.data.empty()};
  Q_EMIT requested(request);
}

void ObjectPanel::take_answer(const simulation::ObjectAnswer& answer) {
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
  const QString error = QString::fromUtf8(bus::SdoAborted(answer.abort).what());
  if (pending.writes) {
    message_->setText(tr("Not written: %1").arg(error));
  } else {
    model_->set_error(row, error);
  }
}

void ObjectPanel::forget_requests() { pending_.clear(); }

}  // namespace koboshi::studio
