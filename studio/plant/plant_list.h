#pragma once

#include <QTreeWidget>
#include <vector>

#include "studio/plant/plant_document.h"

namespace koboshi::studio {

// The values in which the simulated robot differs from the firmware's model, each with a button that removes
// it.
class PlantList final : public QTreeWidget {
  Q_OBJECT

 public:
  enum Column { kQuantity, kPlant, kModel, kRemove, kColumns };

  explicit PlantList(QWidget* parent = nullptr);

  void show_entries(const std::vector<PlantDocument::Entry>& entries);
  QSize sizeHint() const override;

 Q_SIGNALS:
  void removed(std::size_t entry);
  // The user has clicked on an entry.
  void chosen(std::size_t entry);
};

}  // namespace koboshi::studio
