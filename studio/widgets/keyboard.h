#pragma once

#include <QObject>
#include <QPointer>

class QKeyEvent;
class QLineEdit;
class QWidget;

namespace koboshi::studio {

// Decides which keys belong to the widget that has the keyboard, and which to the commands of the window.
//
// - A text field has the keys that edit a text. Undo and redo are its own only if there is something typed to
//   take back. A number box has digits, signs and points; other letters and the space go to the window.
// - A table or list has the keys that copy its rows and that move to its ends; a table whose cells are edited
//   by typing has what is typed. A slider has the keys that move it to its ends.
// - Escape leaves a text field: a search field becomes empty, another one gets its former text back. The
//   keyboard returns to where it was before, but not to a text field.
// - Enter presses the button that has the keyboard: Space starts the run.
class Keyboard final : public QObject {
 public:
  // `window`: whose keys these are. `home` gets the keyboard when no other widget had it. Both must outlive
  // this object.
  Keyboard(QWidget& window, QWidget& home);

 protected:
  bool eventFilter(QObject* watched, QEvent* event) override;

 private:
  bool is_inside(const QWidget& widget) const;
  void leave(QLineEdit& field);

  QWidget& window_;
  QWidget& home_;
  QPointer<QWidget> place_;  // what had the keyboard last and is no text field
};

}  // namespace koboshi::studio
