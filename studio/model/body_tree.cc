#include "studio/model/body_tree.h"

#include <QHeaderView>
#include <QStyle>
#include <QTreeWidgetItemIterator>
#include <utility>

namespace koboshi::studio {
namespace {

QTreeWidgetItem* heading(QTreeWidget& tree, const QString& text) {
  auto* item = new QTreeWidgetItem(&tree, {text});
  item->setFlags(Qt::ItemIsEnabled);
  item->setFirstColumnSpanned(true);
  return item;
}

}  // namespace

BodyTree::BodyTree(QWidget* parent) : QTreeWidget(parent) {
  setColumnCount(2);
  setHeaderLabels({tr("Body"), tr("Joint")});
  setSelectionBehavior(SelectItems);
  setUniformRowHeights(true);
  setIndentation(10);
  setAccessibleName(tr("Bodies and joints"));
  header()->setSectionResizeMode(kBody, QHeaderView::Stretch);
  header()->setSectionResizeMode(kJoint, QHeaderView::ResizeToContents);
  header()->setStretchLastSection(false);
  connect(this, &QTreeWidget::currentItemChanged, this, [this] {
    if (!quiet_ && !chosen().isEmpty()) Q_EMIT element_chosen(chosen());
  });
  connect(selectionModel(), &QItemSelectionModel::currentColumnChanged, this, [this] {
    if (!quiet_ && !chosen().isEmpty()) Q_EMIT element_chosen(chosen());
  });
}

void BodyTree::show_robot(const ModelDocument& document) {
  const QString kept = chosen();
  quiet_ = true;
  clear();
  const sim_board::RobotDescription& robot = document.robot();
  add_body(*invisibleRootItem(), robot, 0);
  QTreeWidgetItem* servos = nullptr;
  for (const sim_board::ModelElement& element : document.elements()) {
    if (element.is("koboshi:battery")) new QTreeWidgetItem(this, {QString::fromStdString(element.name)});
    if (!element.is("koboshi:servo_type")) continue;
    if (servos == nullptr) servos = heading(*this, tr("Servo types"));
    new QTreeWidgetItem(servos, {QString::fromStdString(element.name)});
  }
  expandAll();
  quiet_ = false;
  choose(kept);
}

void BodyTree::add_body(QTreeWidgetItem& parent, const sim_board::RobotDescription& robot, int link) {
  auto* item = new QTreeWidgetItem(
      &parent, {QString::fromStdString(robot.links[static_cast<std::size_t>(link)].name)});
  for (std::size_t i = 0; i < robot.hinge_count(); ++i) {
    const sim_board::JointDescription& joint = robot.hinge(i);
    if (joint.child == link) item->setText(kJoint, QString::fromStdString(joint.name));
    if (joint.parent == link) add_body(*item, robot, joint.child);
  }
}

void BodyTree::mark(const std::set<std::string>& elements) {
  const QIcon warning = style()->standardIcon(QStyle::SP_MessageBoxWarning);
  for (QTreeWidgetItemIterator item(this); *item != nullptr; ++item)
    for (const int column : {kBody, kJoint})
      (*item)->setIcon(column, elements.contains((*item)->text(column).toStdString()) ? warning : QIcon());
}

void BodyTree::choose(const QString& element) {
  if (element.isEmpty() || element == chosen()) return;
  for (QTreeWidgetItemIterator item(this); *item != nullptr; ++item)
    for (const int column : {kBody, kJoint})
      if ((*item)->text(column) == element && (*item)->flags().testFlag(Qt::ItemIsSelectable)) {
        const bool was_quiet = std::exchange(quiet_, true);
        setCurrentItem(*item, column);
        scrollToItem(*item);
        quiet_ = was_quiet;
        return;
      }
}

QString BodyTree::chosen() const {
  const QTreeWidgetItem* item = currentItem();
  if (item == nullptr || !item->flags().testFlag(Qt::ItemIsSelectable)) return {};
  return item->text(currentColumn());
}

}  // namespace koboshi::studio
