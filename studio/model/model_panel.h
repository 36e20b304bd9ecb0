#pragma once

#include <QString>
#include <QTimer>
#include <QWidget>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "studio/model/model_document.h"
#include "studio/widgets/message_kind.h"

class QAction;
class QCheckBox;
class QLabel;
class QPushButton;
class QToolBar;

namespace koboshi::studio {

class BodyTree;
class FieldView;
class OfferBar;

// The model editor: the bodies and joints of a robot, the values of the chosen one, and a line that says
// whether the running simulation already has the model. It never opens a window because of an error.
class ModelPanel final : public QWidget {
  Q_OBJECT

 public:
  explicit ModelPanel(QWidget* parent = nullptr);
  ~ModelPanel() override;

  // Opens a robot's file. Returns an error of one line, or nothing.
  std::optional<QString> open(const std::filesystem::path& robot);
  // Null before a file is open.
  const ModelDocument* document() const { return document_.get(); }
  // Whether the robot differs from its file.
  bool modified() const { return document_ && document_->is_modified(); }
  // Sets a value by its path; with both sides, as the panel's switch says. Returns whether it was permitted:
  // the panel says why not.
  bool set(const QString& path, const QString& typed);
  bool undo();
  bool redo();
  // Returns false after an error, or if the file was changed by another program; the panel says which.
  bool save();
  // Writes the recovery of unsaved changes now, which stays after the end of the program.
  void keep_recovery();

  // Shows an element by its name; an unknown one changes nothing.
  void choose(const QString& element);
  QString chosen() const;
  // Tells the panel with which text of the robot's file the simulation runs; nothing: there is no simulation
  // of this robot.
  void set_running(const std::optional<std::string>& text);

  BodyTree& bodies() { return *bodies_; }
  FieldView& fields() { return *fields_; }
  // The panel's sentences about the simulation and about the last edit.
  QString effect() const;
  QString message() const;
  // Whether edits are made on both sides of the robot.
  void set_both_sides(bool both);
  QSize sizeHint() const override;

 Q_SIGNALS:
  // Another text: an edit, undo, redo, or another file.
  void changed();
  // Whether the robot differs from its file may have changed.
  void title_changed();
  // By the user, also by undo and redo.
  void edited();
  // A message that the panel shows.
  void told(const QString& text, koboshi::studio::MessageKind kind);
  void chosen_changed(const QString& element);
  // The user wants the simulation to start again with the model as it is now.
  void start_again_requested();

 private:
  void build_actions();
  void build_layout();
  QAction* add(const char* name, const QString& text, const QString& tip, std::function<void()> act);
  bool attempt(const std::function<void()>& edit);
  void follow_document();
  void show_element();
  void show_effect();
  void show_message(const QString& text, bool is_error);
  void autosave();
  void check_disk();
  void offer_recovery();

  std::unique_ptr<ModelDocument> document_;
  std::optional<XmlDocument> running_;
  QToolBar* tools_;
  QCheckBox* both_sides_;
  OfferBar* offer_;
  BodyTree* bodies_;
  FieldView* fields_;
  QLabel* message_;
  QLabel* effect_;
  QPushButton* start_again_;
  QAction* undo_ = nullptr;
  QAction* redo_ = nullptr;
  QAction* save_ = nullptr;
  QTimer timer_;  // autosave and changes of the file
};

}  // namespace koboshi::studio
