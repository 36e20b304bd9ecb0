#pragma once

#include <QString>
#include <QTreeWidget>
#include <set>
#include <string>

#include "studio/model/model_document.h"

namespace koboshi::studio {

// The bodies of a robot below the bodies that carry them, each beside the joint that moves it; then the
// battery and the types of servo.
class BodyTree final : public QTreeWidget {
  Q_OBJECT

 public:
  enum Column { kBody, kJoint };

  explicit BodyTree(QWidget* parent = nullptr);

  // Shows the elements of a document. The chosen one stays chosen if it is still there.
  void show_robot(const ModelDocument& document);
  // Elements with findings get a mark.
  void mark(const std::set<std::string>& elements);
  // Chooses an element by its name, without a signal; an unknown one changes nothing.
  void choose(const QString& element);
  // The chosen element; empty: none.
  QString chosen() const;

 Q_SIGNALS:
  void element_chosen(const QString& element);

 private:
  void add_body(QTreeWidgetItem& parent, const sim_board::RobotDescription& robot, int link);

  bool quiet_ = false;
};

}  // namespace koboshi::studio
