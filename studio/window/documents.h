#pragma once

#include <QObject>
#include <QString>
#include <array>
#include <functional>
#include <string>
#include <vector>

#include "studio/document/text_document.h"
#include "studio/widgets/message_kind.h"

class QMainWindow;
class QWidget;

namespace koboshi::studio {

class Panels;

// The documents of the window: a motion, a robot, its parameters, a gait, and the scenario. One of them is
// the active one. Save, undo and redo act on it, wherever the keyboard is. The one becomes active whose panel
// gets the keyboard or comes to the front, or that was edited last, also by the mouse in the view.
class Documents final : public QObject {
  Q_OBJECT

 public:
  enum Kind { kMotion, kRobot, kParameters, kGait, kScenario, kKinds };

  // Both must outlive this object.
  Documents(QMainWindow& window, Panels& panels);

  Kind active() const { return active_; }
  void activate(Kind kind);
  // Null: none is open.
  const TextDocument* document(Kind kind) const;
  bool is_modified(Kind kind) const;
  // "Motion", translated.
  QString kind_name(Kind kind) const;
  // The name of its file; "untitled" without one.
  QString file_name(Kind kind) const;
  // Name of the dock with its panel.
  QString dock(Kind kind) const;
  std::vector<Kind> unsaved() const;

  // Act on the active document, and tell what they did.
  void undo();
  void redo();
  void save();
  // Returns false if the document was not saved: its panel says why, or the user has chosen no file.
  bool save(Kind kind);

  // Takes over the number or name that is being typed.
  void take_typed();

  // Goes on once no change of these documents can get lost: at once, or after the user has answered the
  // question whether to save or to discard them. It does not go on if he cancels, or if one cannot be saved.
  // `title` asks: "Save changes before closing?"
  void settle(const std::vector<Kind>& kinds, const QString& title, std::function<void()> go_on);
  // The same at the end of the desktop's session, which waits for the answer. Returns whether to end.
  [[nodiscard]] bool settle_now(const QString& title);
  // Writes the recoveries of all unsaved changes, which stay after the end of the program.
  void keep_recoveries();

 Q_SIGNALS:
  // Another active document, another name, or another state of saving.
  void changed();
  // One of the documents, by the user.
  void edited();
  // News for the status line.
  void told(const QString& text);

 private:
  void watch_panels(QMainWindow& window);
  QString names(const std::vector<Kind>& kinds) const;
  void discard(const std::vector<Kind>& kinds);
  bool save_all(const std::vector<Kind>& kinds);
  void travel(const QString& nothing, const QString& done, bool back);

  Panels& panels_;
  QWidget& window_;
  Kind active_ = kMotion;
  bool asking_ = false;
};

}  // namespace koboshi::studio
