#include "studio/widgets/keyboard.h"

#include <QAbstractButton>
#include <QAbstractItemView>
#include <QAbstractSlider>
#include <QApplication>
#include <QCompleter>
#include <QDoubleSpinBox>
#include <QKeyEvent>
#include <QLabel>
#include <QLineEdit>
#include <QPlainTextEdit>
#include <QSpinBox>
#include <QTextEdit>
#include <algorithm>
#include <initializer_list>

namespace koboshi::studio {
namespace {

enum class Owner { kWidget, kWindow, kQt };  // kQt: what Qt decides

bool is_one_of(const QKeyEvent& key, std::initializer_list<QKeySequence::StandardKey> keys) {
  return std::ranges::any_of(keys, [&](QKeySequence::StandardKey one) { return key.matches(one); });
}

// A key that writes something.
bool writes(const QKeyEvent& key) {
  const auto modifiers = key.modifiers() & ~(Qt::ShiftModifier | Qt::KeypadModifier);
  return modifiers == Qt::NoModifier && !key.text().isEmpty() && key.text().front().isPrint();
}

bool is_redo(const QKeyEvent& key) {
  return key.matches(QKeySequence::Redo) ||
         (key.key() == Qt::Key_Y && key.modifiers() == Qt::ControlModifier);
}

Owner owner_in_field(const QLineEdit& field, bool is_number, const QKeyEvent& key) {
  if (key.matches(QKeySequence::Undo)) return field.isUndoAvailable() ? Owner::kQt : Owner::kWindow;
  if (is_redo(key)) return field.isRedoAvailable() ? Owner::kWidget : Owner::kWindow;
  const bool is_digit =
      writes(key) && (key.text().front().isDigit() || QStringLiteral("+-.,").contains(key.text().front()));
  if (is_number && writes(key) && !is_digit) return Owner::kWindow;
  return Owner::kQt;
}

Owner owner_in_view(const QAbstractItemView& view, const QKeyEvent& key) {
  using enum QKeySequence::StandardKey;
  if (key.modifiers() == Qt::NoModifier && (key.key() == Qt::Key_Home || key.key() == Qt::Key_End))
    return Owner::kWidget;
  if (is_one_of(key, {Copy, SelectAll})) return Owner::kWidget;
  const QModelIndex cell = view.currentIndex();
  const bool is_typed_into = view.editTriggers().testFlag(QAbstractItemView::AnyKeyPressed) &&
                             cell.isValid() && cell.flags().testFlag(Qt::ItemIsEditable);
  return is_typed_into && writes(key) && key.key() != Qt::Key_Space ? Owner::kWidget : Owner::kQt;
}

// A table with the actions of its panel in it has no keys of its own for them.
bool has_action(const QWidget& widget, const QKeyEvent& key) {
  const QKeySequence keys(key.keyCombination());
  for (const QWidget* at = &widget; at != nullptr && !at->isWindow(); at = at->parentWidget())
    for (const QAction* action : at->actions())
      if (action->shortcuts().contains(keys)) return true;
  return false;
}

Owner owner_of(const QWidget& widget, const QKeyEvent& key) {
  if (const auto* box = qobject_cast<const QAbstractSpinBox*>(&widget))
    return owner_in_field(*box->findChild<QLineEdit*>(), true, key);
  if (const auto* field = qobject_cast<const QLineEdit*>(&widget))
    return owner_in_field(*field, qobject_cast<const QAbstractSpinBox*>(field->parentWidget()) != nullptr,
                          key);
  const bool copies = is_one_of(key, {QKeySequence::Copy, QKeySequence::SelectAll});
  const auto* label = qobject_cast<const QLabel*>(&widget);
  const bool is_text = qobject_cast<const QPlainTextEdit*>(&widget) != nullptr ||
                       qobject_cast<const QTextEdit*>(&widget) != nullptr ||
                       (label != nullptr && label->hasSelectedText());
  if (is_text && copies) return Owner::kWidget;
  // A text that cannot be edited needs none of these.
  if (is_text && (writes(key) || key.matches(QKeySequence::Undo) || is_redo(key) ||
                  key.key() == Qt::Key_Backspace || key.key() == Qt::Key_Delete))
    return Owner::kWindow;
  if (const auto* view = qobject_cast<const QAbstractItemView*>(&widget))
    return has_action(*view, key) ? Owner::kWindow : owner_in_view(*view, key);
  if (qobject_cast<const QAbstractSlider*>(&widget) != nullptr && key.modifiers() == Qt::NoModifier &&
      (key.key() == Qt::Key_Home || key.key() == Qt::Key_End))
    return Owner::kWidget;
  return Owner::kQt;
}

// The field of a number box, or one that is not the editor of a cell, which the table handles.
QLineEdit* field_of(QObject* watched) {
  auto* widget = qobject_cast<QWidget*>(watched);
  if (widget == nullptr) return nullptr;
  if (auto* popup = qobject_cast<QAbstractItemView*>(widget);
      popup != nullptr && popup->windowType() == Qt::Popup)
    return qobject_cast<QLineEdit*>(popup->focusProxy());
  auto* box = qobject_cast<QAbstractSpinBox*>(widget);
  auto* field = box != nullptr ? box->findChild<QLineEdit*>() : qobject_cast<QLineEdit*>(widget);
  for (QWidget* at = field; at != nullptr; at = at->parentWidget())
    if (qobject_cast<QAbstractItemView*>(at) != nullptr) return nullptr;
  return field;
}

// Takes back what was typed and not taken over.
void restore(QLineEdit& field) {
  if (auto* box = qobject_cast<QDoubleSpinBox*>(field.parentWidget())) return box->setValue(box->value());
  if (auto* box = qobject_cast<QSpinBox*>(field.parentWidget())) return box->setValue(box->value());
  if (field.isClearButtonEnabled()) return field.clear();
  while (field.isUndoAvailable()) field.undo();
}

}  // namespace

Keyboard::Keyboard(QWidget& window, QWidget& home) : QObject(&window), window_(window), home_(home) {
  QApplication::instance()->installEventFilter(this);
  connect(qApp, &QApplication::focusChanged, this, [this](QWidget* /*before*/, QWidget* now) {
    if (now != nullptr && is_inside(*now) && field_of(now) == nullptr) place_ = now;
  });
}

// Also in a panel that is a window of its own.
bool Keyboard::is_inside(const QWidget& widget) const {
  const QWidget* top = widget.window();
  return top == &window_ || (top->windowType() == Qt::Tool && top->parentWidget() == &window_);
}

void Keyboard::leave(QLineEdit& field) {
  restore(field);
  if (field.completer() != nullptr) field.completer()->popup()->hide();
  QWidget* const place =
      place_ != nullptr && place_->isVisible() && place_->isEnabled() ? place_.data() : &home_;
  place->activateWindow();
  place->setFocus(Qt::OtherFocusReason);
}

bool Keyboard::eventFilter(QObject* watched, QEvent* event) {
  if (event->type() != QEvent::ShortcutOverride && event->type() != QEvent::KeyPress) return false;
  auto* widget = qobject_cast<QWidget*>(watched);
  if (widget == nullptr) return false;
  const auto& key = static_cast<const QKeyEvent&>(*event);
  QLineEdit* const field = field_of(widget);
  if (!is_inside(field != nullptr ? *field : *widget)) return false;
  if (event->type() == QEvent::ShortcutOverride) {
    const Owner owner = owner_of(*widget, key);
    if (owner == Owner::kQt) return false;
    event->setAccepted(owner == Owner::kWidget);
    return true;
  }
  if (key.key() == Qt::Key_Escape && field != nullptr) {
    leave(*field);
    return true;
  }
  auto* const button = qobject_cast<QAbstractButton*>(widget);
  if (button == nullptr || (key.key() != Qt::Key_Return && key.key() != Qt::Key_Enter)) return false;
  button->animateClick();
  return true;
}

}  // namespace koboshi::studio
