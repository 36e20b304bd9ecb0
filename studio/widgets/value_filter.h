#pragma once

#include <QObject>

class QWidget;

namespace koboshi::studio {

// Keeps the events of a panel from the sliders and number boxes in it. Undo and redo concern the document and
// not the digits of a box; the wheel scrolls the panel, unless the user has chosen the widget.
class ValueFilter final : public QObject {
 public:
  using QObject::QObject;

  // Filters the events of this widget, and of the line edit of a spin box.
  void watch(QWidget& widget);

 protected:
  bool eventFilter(QObject* watched, QEvent* event) override;
};

}  // namespace koboshi::studio
