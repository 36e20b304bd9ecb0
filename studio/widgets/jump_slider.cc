#include "studio/widgets/jump_slider.h"

#include <QMouseEvent>
#include <QStyle>
#include <QStyleOptionSlider>

namespace koboshi::studio {

// Moves the handle under the mouse; QSlider then finds the press on the handle.
void JumpSlider::mousePressEvent(QMouseEvent* event) {
  QStyleOptionSlider option;
  initStyleOption(&option);
  const auto part = [&](QStyle::SubControl control) {
    return style()->subControlRect(QStyle::CC_Slider, &option, control, this);
  };
  const QRect handle = part(QStyle::SC_SliderHandle);
  if (event->button() == Qt::LeftButton && !handle.contains(event->position().toPoint())) {
    const QRect groove = part(QStyle::SC_SliderGroove);
    const bool is_flat = orientation() == Qt::Horizontal;
    const int room_px = is_flat ? groove.width() - handle.width() : groove.height() - handle.height();
    const QPoint place_px =
        event->position().toPoint() - groove.topLeft() - QPoint(handle.width() / 2, handle.height() / 2);
    setSliderDown(true);
    setSliderPosition(QStyle::sliderValueFromPosition(
        minimum(), maximum(), is_flat ? place_px.x() : place_px.y(), room_px, option.upsideDown));
  }
  QSlider::mousePressEvent(event);
}

}  // namespace koboshi::studio
