#pragma once

#include <QTimer>
#include <QWidget>
#include <cstdint>
#include <map>
#include <vector>

#include "bus/dictionary/object_dictionary.h"
#include "sim_board/description/description.h"
#include "simulation/scenario/object_access.h"
#include "studio/panels/object_model.h"

class QComboBox;
class QLabel;
class QLineEdit;
class QSortFilterProxyModel;
class QTableView;
class QCheckBox;

namespace koboshi::studio {

// The object dictionaries of the nodes on the bus: reads and writes objects of the running robot by SDO.
class ObjectPanel final : public QWidget {
  Q_OBJECT

 public:
  explicit ObjectPanel(QWidget* parent = nullptr);

  // Shows the nodes of this robot; null: none, with which nothing can be read.
  void set_robot(const sim_board::RobotDescription* robot);
  void take_answer(const simulation::ObjectAnswer& answer);
  // Forgets the requests that have no answer: the run has returned to an earlier moment.
  void forget_requests();

 Q_SIGNALS:
  void requested(const koboshi::simulation::ObjectRequest& request);

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

  std::vector<bus::NodeKind> kinds_;
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
