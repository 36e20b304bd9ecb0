#pragma once

#include <QDoubleSpinBox>
#include <string>

namespace koboshi::studio {

// Makes a box for a number with its unit; one decimal, or two for steps below 0.1.
inline QDoubleSpinBox* number_box(double low, double high, double step, double value, const QString& unit,
                                  const QString& tip) {
  auto* box = new QDoubleSpinBox;
  box->setRange(low, high);
  box->setSingleStep(step);
  box->setDecimals(step < 0.1 ? 2 : 1);
  box->setValue(value);
  box->setSuffix(unit.isEmpty() ? QString() : QLatin1Char(' ') + unit);
  box->setToolTip(tip);
  return box;
}

// The number as it is shown, without the unit.
inline std::string text_of(const QDoubleSpinBox& box) {
  return QString::number(box.value(), 'f', box.decimals()).toStdString();
}

}  // namespace koboshi::studio
