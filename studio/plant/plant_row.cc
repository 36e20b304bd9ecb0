#include "studio/plant/plant_row.h"

#include <QDoubleSpinBox>
#include <QGridLayout>
#include <QLabel>
#include <QSignalBlocker>
#include <QToolButton>
#include <algorithm>
#include <cmath>
#include <utility>

#include "studio/widgets/jump_slider.h"
#include "studio/widgets/value_filter.h"

namespace koboshi::studio {
namespace {

constexpr int kSliderSteps = 1000;

QString number_text_of(double value) { return QLocale::c().toString(value, 'g', 10); }

QString number_with_unit(const PlantQuantity& quantity, double value) {
  const QString text = number_text_of(value);
  return quantity.unit.empty() ? text : text + QLatin1Char(' ') + QString::fromStdString(quantity.unit);
}

}  // namespace

PlantRow::PlantRow(const PlantQuantity& quantity, QGridLayout& grid, QObject* parent)
    : QObject(parent),
      name_(new QLabel(QString::fromStdString(quantity.label))),
      slider_(new JumpSlider(Qt::Horizontal)),
      box_(new QDoubleSpinBox),
      model_(new QLabel),
      reset_(new QToolButton) {
  const QString accessible = tr("Simulated %1").arg(QString::fromStdString(quantity.name()));
  slider_->setRange(0, kSliderSteps);
  slider_->setSingleStep(5);
  slider_->setPageStep(50);
  slider_->setMinimumWidth(60);
  slider_->setObjectName(QString::fromStdString(quantity.name()));
  slider_->setAccessibleName(accessible);
  box_->setLocale(QLocale::c());
  box_->setKeyboardTracking(false);
  box_->setAlignment(Qt::AlignRight);
  box_->setAccessibleName(accessible);
  // Words of the table of keys, which are not translated.
  name_->setProperty("verbatim", true);
  model_->setProperty("verbatim", true);
  model_->setAlignment(Qt::AlignRight | Qt::AlignVCenter);
  reset_->setText(QStringLiteral("↺"));
  reset_->setAutoRaise(true);
  reset_->setToolTip(tr("Back to the value of the model"));
  const int line = grid.rowCount();
  int column = 0;
  auto* const filter = new ValueFilter(this);
  for (QWidget* widget : std::initializer_list<QWidget*>{name_, slider_, box_, model_, reset_}) {
    grid.addWidget(widget, line, column++);
    filter->watch(*widget);
  }
  show(quantity);
  connect(slider_, &QSlider::valueChanged, this,
          [this](int position) { Q_EMIT edited(value_of_slider(position), slider_->isSliderDown()); });
  connect(slider_, &QSlider::sliderReleased, this, &PlantRow::drag_ended);
  connect(box_, &QDoubleSpinBox::valueChanged, this, [this](double value) { Q_EMIT edited(value, false); });
  connect(reset_, &QToolButton::clicked, this, &PlantRow::reset_wanted);
}

// The range of the number is often that of all robots, and its ends are long.
int PlantRow::box_width() const {
  constexpr int kButtons_px = 34;
  int width = 0;
  for (const double value : {quantity_.slider_low, quantity_.slider_high, quantity_.plant})
    width = std::max(width, box_->fontMetrics().horizontalAdvance(
                                QLocale::c().toString(value, 'f', quantity_.decimals) + box_->suffix()));
  return width + kButtons_px;
}

// The place nearest to the model's value is that value.
double PlantRow::value_of_slider(int position) const {
  if (position == slider_of_value(quantity_.model)) return quantity_.model;
  const double share = static_cast<double>(position) / kSliderSteps;
  return quantity_.slider_low + share * (quantity_.slider_high - quantity_.slider_low);
}

int PlantRow::slider_of_value(double value) const {
  const double range = quantity_.slider_high - quantity_.slider_low;
  if (range <= 0.0) return 0;
  return static_cast<int>(std::lround(kSliderSteps * (value - quantity_.slider_low) / range));
}

QString PlantRow::tip() const {
  const sim_board::ModelField& field = quantity_.field;
  QStringList lines{QString::fromStdString(quantity_.name())};
  if (!field.note().meaning.empty()) lines << QString::fromStdString(field.note().meaning);
  lines << tr("Model: %1").arg(number_with_unit(quantity_, quantity_.model));
  lines << tr("Permitted: %1").arg(QString::fromStdString(field.expected()));
  if (!quantity_.unit.empty()) lines << tr("Shown in %1").arg(QString::fromStdString(quantity_.unit));
  return lines.join(QLatin1Char('\n'));
}

void PlantRow::show(const PlantQuantity& quantity) {
  const QSignalBlocker quiet_slider(slider_);
  const QSignalBlocker quiet_box(box_);
  // A slider that is held keeps its range.
  const bool is_held = slider_->isSliderDown();
  const PlantQuantity before = std::exchange(quantity_, quantity);
  if (is_held) {
    quantity_.slider_low = before.slider_low;
    quantity_.slider_high = before.slider_high;
    quantity_.decimals = before.decimals;
  } else {
    slider_->setValue(slider_of_value(quantity_.plant));
  }
  box_->setDecimals(quantity_.decimals);
  box_->setRange(quantity_.low, quantity_.high);
  const double range = quantity_.slider_high - quantity_.slider_low;
  box_->setSingleStep(std::max(std::pow(10.0, -quantity_.decimals), range / 200.0));
  box_->setSuffix(quantity_.unit.empty() ? QString()
                                         : QLatin1Char(' ') + QString::fromStdString(quantity_.unit));
  box_->setValue(quantity_.plant);
  QFont font = name_->font();
  font.setBold(quantity_.differs());
  name_->setFont(font);
  model_->setText(number_text_of(quantity_.model));
  reset_->setEnabled(quantity_.differs());
  const QString words = tip();
  for (QWidget* widget : std::initializer_list<QWidget*>{name_, slider_, box_, model_})
    widget->setToolTip(words);
}

}  // namespace koboshi::studio
