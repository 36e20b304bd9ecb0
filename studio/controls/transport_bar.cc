#include "studio/controls/transport_bar.h"

#include <QAction>
#include <QComboBox>
#include <QEvent>
#include <QIcon>
#include <QLabel>
#include <QPainter>
#include <QPixmap>
#include <QPolygonF>
#include <QSignalBlocker>
#include <QSlider>
#include <algorithm>
#include <array>
#include <utility>

#include "studio/controls/run_controller.h"
#include "studio/widgets/jump_slider.h"

namespace koboshi::studio {
namespace {

constexpr std::uint64_t kTick_us = sim_board::SimBoard::kTick_us;
constexpr std::array<double, 7> kSpeeds{0.05, 0.1, 0.25, 0.5, 1.0, 2.0, Session::kUnpaced};
constexpr int kNormalSpeed = 4;

enum class Sign { kPlay, kPause, kTick, kRewind };

// The signs of a recorder, in the colour of texts.
QIcon icon(Sign sign, const QColor& colour) {
  constexpr int kSide_px = 64;
  QPixmap pixmap(kSide_px, kSide_px);
  pixmap.fill(Qt::transparent);
  QPainter painter(&pixmap);
  painter.setRenderHint(QPainter::Antialiasing);
  painter.setPen(Qt::NoPen);
  painter.setBrush(colour);
  const auto triangle = [&](qreal from, qreal to) {
    painter.drawPolygon(QPolygonF({QPointF(from, 12), QPointF(from, 52), QPointF(to, 32)}));
  };
  switch (sign) {
    case Sign::kPlay:
      triangle(16, 54);
      break;
    case Sign::kPause:
      painter.drawRect(QRectF(16, 12, 11, 40));
      painter.drawRect(QRectF(37, 12, 11, 40));
      break;
    case Sign::kTick:
      painter.drawRect(QRectF(12, 12, 9, 40));
      triangle(26, 56);
      break;
    case Sign::kRewind:
      painter.drawRect(QRectF(8, 12, 7, 40));
      triangle(35, 15);
      triangle(57, 37);
      break;
  }
  painter.end();
  return QIcon(pixmap);
}

QString seconds(std::uint64_t time_us) {
  return QString::number(1e-6 * static_cast<double>(time_us), 'f', 2);
}

}  // namespace

TransportBar::TransportBar(RunController& run, QWidget* parent)
    : QToolBar(tr("Transport"), parent),
      run_(run),
      speed_(new QComboBox(this)),
      slider_(new JumpSlider(Qt::Horizontal, this)),
      time_(new QLabel(this)) {
  setObjectName(QStringLiteral("transport_bar"));
  play_ = addAction(tr("Start"));
  play_->setObjectName(QStringLiteral("play"));
  play_->setShortcut(Qt::Key_Space);
  connect(play_, &QAction::triggered, this, [this] { run_.set_playing(!run_.playing()); });
  tick_ = addAction(tr("Advance one control tick (10 ms)"));
  tick_->setObjectName(QStringLiteral("tick"));
  tick_->setShortcut(Qt::Key_Period);
  connect(tick_, &QAction::triggered, this, [this] { run_.step(kTick_us / 1000); });
  rewind_ = addAction(tr("Rewind to the cursor"));
  rewind_->setObjectName(QStringLiteral("rewind"));
  rewind_->setShortcut(Qt::Key_Backspace);
  connect(rewind_, &QAction::triggered, this, [this] { run_.rewind_to_cursor(); });
  for (const double speed : kSpeeds)
    speed_->addItem(speed == Session::kUnpaced ? tr("as fast as possible") : tr("%1 x real time").arg(speed),
                    speed);
  speed_->setCurrentIndex(kNormalSpeed);
  speed_->setToolTip(tr("Simulated seconds per second of the clock"));
  speed_->setAccessibleName(tr("Speed"));
  connect(speed_, &QComboBox::currentIndexChanged, this,
          [this](int index) { run_.set_speed(kSpeeds[static_cast<std::size_t>(index)]); });
  addWidget(speed_);
  slider_->setMinimumWidth(200);
  slider_->setToolTip(tr("The moment that all panels show, in seconds of the run"));
  slider_->setAccessibleName(tr("Time"));
  slider_->setPageStep(100);
  connect(slider_, &QSlider::valueChanged, this,
          [this](int ticks) { run_.set_cursor(static_cast<std::uint64_t>(ticks) * kTick_us); });
  addWidget(slider_);
  time_->setMinimumWidth(
      time_->fontMetrics().horizontalAdvance(QStringLiteral("0000.00 / 0000.00 s  (00.00 x)")));
  time_->setAlignment(Qt::AlignRight | Qt::AlignVCenter);
  time_->setToolTip(tr("Cursor and end of the run; in brackets the speed reached"));
  addWidget(time_);
  connect(&run_, &RunController::cursor_moved, this, &TransportBar::update_slider);
  connect(&run_, &RunController::grown, this, &TransportBar::update_slider);
  connect(&run_, &RunController::rewound, this, &TransportBar::update_slider);
  connect(&run_, &RunController::opened, this, &TransportBar::update_slider);
  connect(&run_, &RunController::status_changed, this, &TransportBar::update_state);
  update_slider();
  update_icons();
}

void TransportBar::update_slider() {
  const QSignalBlocker blocker(slider_);
  slider_->setRange(0, static_cast<int>(run_.end_us() / kTick_us));
  slider_->setValue(static_cast<int>(run_.cursor_us() / kTick_us));
  update_state();
}

void TransportBar::changeEvent(QEvent* event) {
  if (event->type() == QEvent::PaletteChange && rewind_ != nullptr) update_icons();
  QToolBar::changeEvent(event);
}

void TransportBar::update_icons() {
  const QColor colour = palette().color(QPalette::ButtonText);
  tick_->setIcon(icon(Sign::kTick, colour));
  rewind_->setIcon(icon(Sign::kRewind, colour));
  update_state();
}

void TransportBar::update_state() {
  const bool playing = run_.playing();
  const bool simulates = run_.session() != nullptr;
  play_->setText(playing ? tr("Pause") : tr("Start"));
  play_->setIcon(icon(playing ? Sign::kPause : Sign::kPlay, palette().color(QPalette::ButtonText)));
  play_->setEnabled(run_.source() != RunController::Source::kNone);
  tick_->setEnabled(play_->isEnabled() && !playing);
  rewind_->setEnabled(simulates && run_.cursor_us() < run_.end_us());
  time_->setText(tr("%1 / %2 s  (%3 x)")
                     .arg(seconds(run_.cursor_us()), seconds(run_.end_us()))
                     .arg(run_.pace(), 0, 'f', 2));
}

}  // namespace koboshi::studio
