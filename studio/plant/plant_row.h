#pragma once

#include <QObject>
#include <QString>

#include "studio/plant/plant_quantity.h"

class QDoubleSpinBox;
class QGridLayout;
class QLabel;
class QSlider;
class QToolButton;

namespace koboshi::studio {

// A line of a grid: name, slider, the simulated robot's number with its unit, the model's, and a button that
// returns to it.
class PlantRow final : public QObject {
  Q_OBJECT

 public:
  // Adds its widgets to the next line of the grid. `parent` must not outlive the grid.
  PlantRow(const PlantQuantity& quantity, QGridLayout& grid, QObject* parent);

  const PlantQuantity& quantity() const { return quantity_; }
  // Shows another value of the same quantity.
  void show(const PlantQuantity& quantity);
  QSlider* slider() const { return slider_; }
  QDoubleSpinBox* box() const { return box_; }
  // The width that the number needs within the slider's range.
  int box_width() const;
  QToolButton* reset() const { return reset_; }

 Q_SIGNALS:
  // `drags`: the slider is held.
  void edited(double value, bool drags);
  void drag_ended();
  void reset_wanted();

 private:
  double value_of_slider(int position) const;
  int slider_of_value(double value) const;
  QString tip() const;

  PlantQuantity quantity_;
  QLabel* const name_;
  QSlider* const slider_;
  QDoubleSpinBox* const box_;
  QLabel* const model_;
  QToolButton* const reset_;
};

}  // namespace koboshi::studio
