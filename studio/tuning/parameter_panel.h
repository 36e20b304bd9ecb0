#pragma once

#include <QTimer>
#include <QWidget>
#include <cstddef>
#include <vector>

#include "studio/tuning/parameter_editor.h"
#include "studio/widgets/message_kind.h"

class QAction;
class QCheckBox;
class QComboBox;
class QGridLayout;
class QHBoxLayout;
class QLabel;
class QLineEdit;
class QPushButton;
class QScrollArea;

namespace koboshi::studio {

class OfferBar;
class ParameterRow;

// The parameters of a robot, or of a gait, as sliders by group: searched, changed, undone, saved, and applied
// to the running controller.
class ParameterPanel final : public QWidget {
  Q_OBJECT

 public:
  explicit ParameterPanel(QWidget* parent = nullptr);

  ParameterEditor& editor() { return editor_; }
  // The row of a parameter of the shown file.
  ParameterRow& row(std::size_t index) { return *rows_.at(index); }
  // The last message of the compiler, the file or the controller; empty: none.
  QString message() const;
  // Saves the shown file. Refuses to overwrite what another program has written, unless it is called again.
  bool save();

 Q_SIGNALS:
  // The user wants the gait, or a value that the controller takes only from its storage, in a new run.
  void restart_wanted();
  // A message that the panel shows.
  void told(const QString& text, koboshi::studio::MessageKind kind);

 private:
  struct Group {
    QLabel* heading = nullptr;
    std::vector<std::size_t> rows;
  };

  void add_actions();
  QHBoxLayout* make_search();
  QHBoxLayout* make_buttons();
  void build();
  void add_group(QGridLayout& grid, std::size_t first, std::size_t last);
  void refresh();
  void refresh_row(std::size_t index);
  void refresh_file();
  void refresh_actions();
  void filter();
  void check();
  void show_error(const QString& error);
  void show_answer(std::size_t index);
  void edit(std::size_t index, double value, bool drags);
  void offer_recovery();

  ParameterEditor editor_;
  QComboBox* const file_;
  QLineEdit* const search_;
  QCheckBox* const changed_only_;
  QCheckBox* const live_;
  QPushButton* const apply_;
  QPushButton* const again_;
  QScrollArea* const area_;
  OfferBar* const offer_;
  QLabel* const message_;
  QAction* undo_ = nullptr;
  QAction* redo_ = nullptr;
  QAction* save_ = nullptr;
  QAction* reset_ = nullptr;
  std::vector<ParameterRow*> rows_;
  std::vector<Group> groups_;
  QTimer check_timer_;       // the compiler runs after the last edit
  QString error_;            // of the last edit, until the next one
  bool overwrites_ = false;  // the next save does not ask
};

}  // namespace koboshi::studio
