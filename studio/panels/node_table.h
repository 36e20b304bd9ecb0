#pragma once

#include <QAbstractTableModel>
#include <vector>

#include "bus/dictionary/network.h"
#include "studio/run/session.h"

namespace koboshi::studio {

// The nodes of a simulated bus with the state and the counters of their CAN controllers.
class NodeModel final : public QAbstractTableModel {
  Q_OBJECT

 public:
  enum Column { kNode, kState, kTransmitErrors, kReceiveErrors, kSent, kReceived, kLost, kColumns };

  explicit NodeModel(QObject* parent = nullptr) : QAbstractTableModel(parent) {}
  void set_names(std::vector<bus::NetworkNode> names) { names_ = std::move(names); }
  void show(std::vector<NodeStatus> nodes);

  int rowCount(const QModelIndex& parent = {}) const override;
  int columnCount(const QModelIndex& parent = {}) const override;
  QVariant data(const QModelIndex& index, int role) const override;
  QVariant headerData(int section, Qt::Orientation orientation, int role) const override;

 private:
  std::vector<bus::NetworkNode> names_;
  std::vector<NodeStatus> nodes_;
};

}  // namespace koboshi::studio
