#include "studio/panels/node_table.h"

#include <QColor>
#include <algorithm>

namespace koboshi::studio {
namespace {

QString state_name(const NodeStatus& node) {
  if (!node.powered) return NodeModel::tr("no power");
  switch (node.can.state) {
    case hal::CanErrorState::kErrorActive:
      return NodeModel::tr("error-active");
    case hal::CanErrorState::kErrorPassive:
      return NodeModel::tr("error-passive");
    case hal::CanErrorState::kBusOff:
      return NodeModel::tr("bus-off");
  }
  return {};
}

}  // namespace

void NodeModel::show(std::vector<NodeStatus> nodes) {
  if (nodes.size() != nodes_.size()) {
    beginResetModel();
    nodes_ = std::move(nodes);
    return endResetModel();
  }
  nodes_ = std::move(nodes);
  if (!nodes_.empty())
    Q_EMIT dataChanged(index(0, 0), index(static_cast<int>(nodes_.size()) - 1, kColumns - 1));
}

int NodeModel::rowCount(const QModelIndex& parent) const {
  return parent.isValid() ? 0 : static_cast<int>(nodes_.size());
}

int NodeModel::columnCount(const QModelIndex& parent) const { return parent.isValid() ? 0 : kColumns; }

QVariant NodeModel::data(const QModelIndex& index, int role) const {
  if (!index.isValid()) return {};
  const NodeStatus& node = nodes_[static_cast<std::size_t>(index.row())];
  const bool healthy = node.powered && node.can.state == hal::CanErrorState::kErrorActive;
  if (role == Qt::ForegroundRole && !healthy) return QColor(200, 30, 30);
  if (role == Qt::TextAlignmentRole && index.column() > kState)
    return static_cast<int>(Qt::AlignRight | Qt::AlignVCenter);
  if (role != Qt::DisplayRole) return {};
  switch (index.column()) {
    case kNode: {
      const auto name = std::ranges::find(names_, node.node_id, &bus::NetworkNode::node_id);
      return QStringLiteral("%1  %2")
          .arg(node.node_id)
          .arg(name == names_.end() ? QString() : QString::fromStdString(name->name));
    }
    case kState:
      return state_name(node);
    case kTransmitErrors:
      return node.can.transmit_error_count;
    case kReceiveErrors:
      return node.can.receive_error_count;
    case kSent:
      return static_cast<qulonglong>(node.counters.sent);
    case kReceived:
      return static_cast<qulonglong>(node.counters.received);
    case kLost:
      return static_cast<qulonglong>(node.counters.overruns);
  }
  return {};
}

QVariant NodeModel::headerData(int section, Qt::Orientation orientation, int role) const {
  if (orientation != Qt::Horizontal || (role != Qt::DisplayRole && role != Qt::ToolTipRole)) return {};
  const bool tip = role == Qt::ToolTipRole;
  switch (section) {
    case kNode:
      return tip ? tr("Node on the bus") : tr("Node");
    case kState:
      return tip ? tr("Error state of the CAN controller (ISO 11898-1)") : tr("State");
    case kTransmitErrors:
      return tip ? tr("Transmit error count; error-passive from 128, bus-off from 256") : tr("TEC");
    case kReceiveErrors:
      return tip ? tr("Receive error count; error-passive from 128") : tr("REC");
    case kSent:
      return tip ? tr("Frames sent") : tr("Sent");
    case kReceived:
      return tip ? tr("Frames received") : tr("Received");
    case kLost:
      return tip ? tr("Frames lost because a transmit FIFO was full") : tr("Lost");
  }
  return {};
}

}  // namespace koboshi::studio
