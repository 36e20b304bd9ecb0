#include "studio/widgets/value_filter.h"

#include <QEvent>
#include <QKeyEvent>
#include <QLineEdit>
#include <QWidget>

namespace koboshi::studio {
namespace {

bool is_undo(const QEvent& event) {
  if (event.type() != QEvent::ShortcutOverride) return false;
  const auto& key = static_cast<const QKeyEvent&>(event);
  return key.matches(QKeySequence::Undo) || key.matches(QKeySequence::Redo);
}

bool is_wheel_over_other(const QObject& watched, const QEvent& event) {
  const auto* const widget = qobject_cast<const QWidget*>(&watched);
  return event.type() == QEvent::Wheel && widget != nullptr && !widget->hasFocus();
}

}  // namespace

void ValueFilter::watch(QWidget& widget) {
  widget.installEventFilter(this);
  // The line edit is a spin box's only child widget.
  if (auto* const edit = widget.findChild<QLineEdit*>()) edit->installEventFilter(this);
}

// An ignored event goes on to the parent of the widget.
bool ValueFilter::eventFilter(QObject* watched, QEvent* event) {
  if (!is_undo(*event) && !is_wheel_over_other(*watched, *event)) return QObject::eventFilter(watched, event);
  event->ignore();
  return true;
}

}  // namespace koboshi::studio
