#include "studio/plant/plant_list.h"

#include <QHeaderView>
#include <QToolButton>

namespace koboshi::studio {

PlantList::PlantList(QWidget* parent) : QTreeWidget(parent) {
  setColumnCount(kColumns);
  setHeaderLabels({tr("Quantity"), tr("Simulated robot"), tr("Model"), QString()});
  setRootIsDecorated(false);
  setUniformRowHeights(true);
  setAlternatingRowColors(true);
  setAccessibleName(tr("Values that differ from the model"));
  header()->setStretchLastSection(false);
  header()->setSectionResizeMode(kQuantity, QHeaderView::Stretch);
  for (const int column : {kPlant, kModel, kRemove})
    header()->setSectionResizeMode(column, QHeaderView::ResizeToContents);
  connect(this, &QTreeWidget::itemClicked, this, [this](QTreeWidgetItem* item) {
    Q_EMIT chosen(static_cast<std::size_t>(indexOfTopLevelItem(item)));
  });
}

QSize PlantList::sizeHint() const { return {240, 6 * fontMetrics().height()}; }

void PlantList::show_entries(const std::vector<PlantDocument::Entry>& entries) {
  clear();
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const PlantDocument::Entry& entry = entries[i];
    auto* item =
        new QTreeWidgetItem(this, {QString::fromStdString(entry.path), QString::fromStdString(entry.shown),
                                   QString::fromStdString(entry.model)});
    item->setToolTip(kQuantity, QString::fromStdString(PlantDocument::text_of(entry)));
    auto* remove = new QToolButton;
    remove->setText(QStringLiteral("✕"));
    remove->setAutoRaise(true);
    remove->setObjectName(QStringLiteral("remove_plant"));
    remove->setToolTip(tr("Removes this value: the simulated robot has that of the model"));
    remove->setAccessibleName(tr("Remove %1").arg(item->text(kQuantity)));
    // Later: the list is filled anew, and the button deleted.
    connect(
        remove, &QToolButton::clicked, this, [this, i] { Q_EMIT removed(i); }, Qt::QueuedConnection);
    setItemWidget(item, kRemove, remove);
  }
}

}  // namespace koboshi::studio
