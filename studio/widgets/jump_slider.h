#pragma once

#include <QSlider>

namespace koboshi::studio {

// A slider that a click sets to the place of the click; from there it can be dragged on.
class JumpSlider final : public QSlider {
 public:
  using QSlider::QSlider;

 protected:
  void mousePressEvent(QMouseEvent* event) override;
};

}  // namespace koboshi::studio
