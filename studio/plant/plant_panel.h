#pragma once

#include <QString>
#include <QTimer>
#include <QWidget>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "studio/plant/plant_document.h"
#include "studio/widgets/message_kind.h"

class QAction;
class QCheckBox;
class QComboBox;
class QGridLayout;
class QLabel;
class QLineEdit;
class QPushButton;
class QScrollArea;
class QToolBar;

namespace koboshi::studio {

class OfferBar;
class PlantList;
class PlantRow;

// The values of the simulated robot that the firmware's model does not have: sliders for the quantities of
// one link, joint or type of servo, the list of all differences, and a line that says whether the running
// simulation already has them. It edits the key `plant` of the open scenario.
class PlantPanel final : public QWidget {
  Q_OBJECT

 public:
  explicit PlantPanel(QWidget* parent = nullptr);
  ~PlantPanel() override;

  // Shows the plant of a scenario with the robot of this file. A scenario that is open stays with its
  // changes; changes of another one are kept for recovery.
  void open(const std::filesystem::path& scenario, const std::filesystem::path& robot);
  // Null before a scenario is open.
  const PlantDocument* document() const { return document_.get(); }
  bool modified() const { return document_ && document_->is_modified(); }
  // Tells the panel with which settings the simulation of the open scenario runs; nothing: it does not run.
  void set_running(const std::optional<std::vector<simulation::PlantSetting>>& settings);
  // How the running simulation differs from its model, one line for each value; empty: it does not.
  QString differences() const;

  // Chooses a link, joint or type of servo; an unknown one changes nothing.
  void choose(const QString& element);
  QString chosen() const;
  // The row of a quantity of the chosen element, by PlantQuantity::name(); null: there is none.
  PlantRow* row(const std::string& name) const;
  PlantList& list() { return *list_; }
  // The panel's sentences about the simulation and about the last edit.
  QString effect() const;
  QString message() const;

  bool undo();
  bool redo();
  // Returns false after an error, or if another program has changed the file; the panel says which.
  bool save();
  // Writes the scenario with the present values into another file, and asks for it to be opened. Returns
  // whether it was written.
  bool save_as(const std::filesystem::path& file);
  // The user does not want the unsaved changes: they leave no recovery.
  void discard() { is_discarded_ = true; }
  // Writes the recovery of unsaved changes now, which stays after the end of the program.
  void keep_recovery();

 Q_SIGNALS:
  // Another scenario, name, or state of saving.
  void title_changed();
  // By the user, also by undo and redo.
  void edited();
  // A message that the panel shows.
  void told(const QString& text, koboshi::studio::MessageKind kind);
  // The user wants the simulation to start again with the values as they are now.
  void start_again_requested();
  // The user wants this scenario to be opened.
  void open_requested(const QString& file);

 private:
  void build_actions();
  void build_menu();
  void choose_file();
  void build_layout();
  QWidget* make_entry_line();
  QAction* add(const char* name, const QString& text, const QString& tip, std::function<void()> act);
  bool attempt(const std::function<void()>& edit);
  void follow_document();
  void fill_elements();
  void build_rows();
  void add_heading(const std::string& group, bool is_first, QGridLayout& grid);
  void add_row(const PlantQuantity& quantity, QGridLayout& grid, QWidget& content);
  void edit(const PlantQuantity& quantity, double value, bool drags);
  void add_typed();
  void choose_entry(std::size_t index);
  void show_effect();
  void show_message(const QString& text, bool is_error, bool is_told = true);
  sim_board::Sides sides() const;
  void check_disk();
  void offer_recovery();

  std::unique_ptr<PlantDocument> document_;
  std::optional<std::vector<simulation::PlantSetting>> running_;
  QToolBar* tools_;
  QCheckBox* both_sides_;
  OfferBar* offer_;
  QComboBox* elements_;
  QScrollArea* area_;
  QLineEdit* typed_;
  PlantList* list_;
  QLabel* message_;
  QLabel* effect_;
  QPushButton* start_again_;
  QAction* undo_ = nullptr;
  QAction* redo_ = nullptr;
  QAction* save_ = nullptr;
  QAction* reset_ = nullptr;
  std::vector<PlantRow*> rows_;
  bool is_discarded_ = false;
  QTimer timer_;  // autosave and changes of the file
};

}  // namespace koboshi::studio
