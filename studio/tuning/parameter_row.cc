#include "studio/tuning/parameter_row.h"

#include <QAction>
#include <QDoubleSpinBox>
#include <QGridLayout>
#include <QLabel>
#include <QSignalBlocker>
#include <QSlider>
#include <QToolButton>
#include <algorithm>
#include <cmath>

#include "studio/widgets/jump_slider.h"
#include "studio/widgets/value_filter.h"

namespace koboshi::studio {
namespace {

constexpr int kSliderHalf = 1000;
// A range across zero is finer near zero: value = position^3. Most gains are a few hundredths of their range.
constexpr double kPower = 3.0;

// "step_time_ms" becomes "step time": the unit is beside the number.
QString readable_key(const ParameterInfo& info) {
  QString name = QString::fromStdString(info.key);
  if (info.object != nullptr && !name.contains(QLatin1Char('.')))
    name = QString::fromStdString(info.object->name_without_unit);
  name.replace(QLatin1Char('.'), QLatin1String(": "));
  return name.replace(QLatin1Char('_'), QLatin1Char(' '));
}

// Decimals with which every step of the parameter can be told apart.
int decimals_of(const ParameterInfo& info) {
  return std::clamp(static_cast<int>(std::ceil(std::log10(info.steps_per_unit) - 1e-9)), 0, 6);
}

QString number_text(const ParameterInfo& info, double value) {
  const QString text = QString::fromStdString(info.text(value));
  return info.unit.empty() ? text : text + QLatin1Char(' ') + QString::fromStdString(info.unit);
}

}  // namespace

ParameterRow::ParameterRow(const ParameterInfo& info, bool tells_effect, QGridLayout& grid, QObject* parent)
    : QObject(parent),
      info_(info),
      tells_effect_(tells_effect),
      name_(new QLabel(readable_key(info))),
      slider_(new JumpSlider(Qt::Horizontal)),
      box_(new QDoubleSpinBox),
      live_(new QLabel),
      reset_(new QToolButton) {
  slider_->setRange(info.low < 0.0 ? -kSliderHalf : 0, kSliderHalf);
  slider_->setSingleStep(5);
  slider_->setPageStep(50);
  slider_->setMinimumWidth(60);
  slider_->setObjectName(QString::fromStdString(info.key));
  const QString accessible = tr("Parameter %1").arg(name_->text());
  slider_->setAccessibleName(accessible);
  box_->setLocale(QLocale::c());
  box_->setDecimals(decimals_of(info));
  box_->setRange(info.low, info.high);
  const double step = std::max(1.0 / info.steps_per_unit, std::pow(10.0, -decimals_of(info)));
  box_->setSingleStep(info.high - info.low > 200.0 * step ? 5.0 * step : step);
  box_->setKeyboardTracking(false);
  box_->setAlignment(Qt::AlignRight);
  box_->setAccessibleName(accessible);
  if (!info.unit.empty()) box_->setSuffix(QLatin1Char(' ') + QString::fromStdString(info.unit));
  live_->setMinimumWidth(live_->fontMetrics().horizontalAdvance(tr("in force: %1").arg(999)));
  // Words of the tables of the firmware, which are not translated.
  name_->setProperty("verbatim", true);
  live_->setProperty("verbatim", true);
  reset_->setText(QStringLiteral("↺"));
  reset_->setAutoRaise(true);
  reset_->setToolTip(tr("Back to the value in the file; the menu has the default"));
  reset_->setPopupMode(QToolButton::MenuButtonPopup);
  auto* to_file = new QAction(tr("Value in the file"), reset_);
  auto* to_default = new QAction(tr("Default"), reset_);
  reset_->addActions({to_file, to_default});
  const int line = grid.rowCount();
  int column = 0;
  auto* const filter = new ValueFilter(this);
  for (QWidget* widget : std::initializer_list<QWidget*>{name_, slider_, box_, reset_, live_}) {
    grid.addWidget(widget, line, column++);
    filter->watch(*widget);
  }
  connect(slider_, &QSlider::valueChanged, this,
          [this](int position) { Q_EMIT edited(value_of_slider(position), slider_->isSliderDown()); });
  connect(slider_, &QSlider::sliderReleased, this, &ParameterRow::drag_ended);
  connect(box_, &QDoubleSpinBox::valueChanged, this, [this](double value) { Q_EMIT edited(value, false); });
  connect(reset_, &QToolButton::clicked, this, &ParameterRow::reset_wanted);
  connect(to_file, &QAction::triggered, this, &ParameterRow::reset_wanted);
  connect(to_default, &QAction::triggered, this, &ParameterRow::default_wanted);
}

double ParameterRow::value_of_slider(int position) const {
  const double share = static_cast<double>(position) / kSliderHalf;
  if (info_.low >= 0.0) return info_.low + share * (info_.high - info_.low);
  const double reach = share < 0.0 ? -info_.low : info_.high;
  return std::copysign(std::pow(std::abs(share), kPower), share) * reach;
}

int ParameterRow::slider_of_value(double value) const {
  if (info_.low >= 0.0)
    return static_cast<int>(std::lround(kSliderHalf * (value - info_.low) / (info_.high - info_.low)));
  const double reach = value < 0.0 ? -info_.low : info_.high;
  const double share = reach > 0.0 ? std::abs(value) / reach : 0.0;
  return static_cast<int>(std::lround(std::copysign(std::pow(share, 1.0 / kPower), value) * kSliderHalf));
}

// The unit, written out where it is a single letter.
QString ParameterRow::unit_word() const {
  if (info_.unit == "s") return tr("seconds");
  if (info_.unit == "N") return tr("newtons");
  return QString::fromStdString(info_.unit);
}

QString ParameterRow::tip(const ShownParameter& shown) const {
  QStringList lines{QString::fromStdString(info_.key)};
  if (!info_.meaning.empty()) lines << QString::fromStdString(info_.meaning);
  lines << tr("From %1 to %2 %3")
               .arg(QString::fromStdString(info_.text(info_.low)),
                    QString::fromStdString(info_.text(info_.high)), unit_word());
  lines << (info_.fallback ? tr("Default: %1").arg(number_text(info_, *info_.fallback))
                           : tr("No default: not set without a value"));
  if (shown.in_file) lines << tr("In the file: %1").arg(number_text(info_, *shown.in_file));
  lines << tr("Takes effect %1").arg(QString::fromStdString(info_.effect));
  if (info_.object != nullptr)
    lines << tr("Object %1:%2")
                 .arg(info_.object->address().index, 4, 16, QLatin1Char('0'))
                 .arg(info_.object->address().subindex, 2, 16, QLatin1Char('0'))
                 .toUpper();
  return lines.join(QLatin1Char('\n'));
}

void ParameterRow::show(const ShownParameter& shown) {
  const QSignalBlocker quiet_slider(slider_);
  const QSignalBlocker quiet_box(box_);
  const double value = shown.value.value_or(info_.low);
  if (!slider_->isSliderDown()) slider_->setValue(slider_of_value(value));
  box_->setSpecialValueText(shown.value ? QString() : tr("not set"));
  box_->setValue(value);
  QFont font = name_->font();
  font.setBold(shown.is_changed);
  name_->setFont(font);
  reset_->setEnabled(shown.is_changed || shown.value != info_.fallback);

  const LiveParameters::State& live = shown.live;
  const bool differs = live.is_known && shown.value &&
                       (!live.in_force || info_.steps(*live.in_force) != info_.steps(*shown.value));
  QString text;
  bool is_bad = false;
  if (!shown.is_connected) {
    text.clear();
  } else if (info_.object == nullptr) {
    text = shown.is_changed ? QString::fromStdString(info_.effect) : QString();
  } else if (live.is_pending) {
    text = tr("is written");
  } else if (!live.refusal.empty()) {
    text = tr("refused");
    is_bad = true;
  } else if (differs) {
    text = live.in_force ? tr("in force: %1").arg(QString::fromStdString(info_.text(*live.in_force)))
                         : tr("not set");
  } else if (live.is_known) {
    text = QStringLiteral("✓");
  }
  if (tells_effect_ && (text.isEmpty() || text == QStringLiteral("✓")))
    text = QStringList{text, QString::fromStdString(info_.effect)}.join(QLatin1Char(' ')).trimmed();
  live_->setText(text);
  QPalette colours = name_->palette();
  if (is_bad) colours.setColor(QPalette::WindowText, QColor(212, 58, 47));
  live_->setPalette(colours);
  const QString words = tip(shown);
  for (QWidget* widget : std::initializer_list<QWidget*>{name_, slider_, box_}) widget->setToolTip(words);
  const QString detail = is_bad ? QString::fromStdString(live.refusal) : text;
  live_->setToolTip(shown.is_connected ? tr("What the running controller has: %1").arg(detail) : QString());
}

QString ParameterRow::live_text() const { return live_->text(); }

void ParameterRow::set_visible(bool visible) {
  is_visible_ = visible;
  for (QWidget* widget : std::initializer_list<QWidget*>{name_, slider_, box_, reset_, live_})
    widget->setVisible(visible);
}

}  // namespace koboshi::studio
