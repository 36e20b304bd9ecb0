#pragma once

#include <QObject>
#include <QString>
#include <optional>

#include "studio/parameters/live_parameters.h"
#include "studio/parameters/parameter_table.h"

class QDoubleSpinBox;
class QGridLayout;
class QLabel;
class QSlider;
class QToolButton;

namespace koboshi::studio {

// The contents of a row.
struct ShownParameter {
  std::optional<double> value{};
  std::optional<double> in_file{};
  bool is_changed = false;
  bool is_connected = false;
  LiveParameters::State live{};
};

// A line of a grid: name, slider, number with its unit, and what the controller has.
class ParameterRow final : public QObject {
  Q_OBJECT

 public:
  // Adds its widgets to the next line of the grid. The information must outlive the row. `tells_effect`: the
  // heading does not say when a change takes effect, so the row does.
  ParameterRow(const ParameterInfo& info, bool tells_effect, QGridLayout& grid, QObject* parent);

  void show(const ShownParameter& shown);
  void set_visible(bool visible);
  bool is_visible() const { return is_visible_; }
  QSlider* slider() const { return slider_; }
  QDoubleSpinBox* box() const { return box_; }
  // The row's text about the running controller.
  QString live_text() const;

 Q_SIGNALS:
  // `drags`: the slider is held.
  void edited(double value, bool drags);
  void drag_ended();
  void reset_wanted();
  void default_wanted();

 private:
  QString unit_word() const;
  QString tip(const ShownParameter& shown) const;
  double value_of_slider(int position) const;
  int slider_of_value(double value) const;

  const ParameterInfo& info_;
  const bool tells_effect_;
  QLabel* const name_;
  QSlider* const slider_;
  QDoubleSpinBox* const box_;
  QLabel* const live_;
  QToolButton* const reset_;
  bool is_visible_ = true;
};

}  // namespace koboshi::studio
