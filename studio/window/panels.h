#pragma once

#include <QObject>
#include <QString>
#include <QTimer>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "view/recording/recording.h"

class QDockWidget;
class QMainWindow;
class QMenu;
class QMenuBar;
class QSettings;
class QWidget;

namespace koboshi::studio {

class CanPanel;
class EventPanel;
class LogPanel;
class MessageBar;
class ModelPanel;
class MotionPanel;
class ObjectPanel;
class OperatorPanel;
class PlantPanel;
class PlotPanel;
class RunController;
class SolePanel;
class TuningPanels;

// The docks of the window and the panels in them, connected with the run, and their remembered places.
//
// A new panel takes one line in make(): add() with a Place. Its widget connects itself with the run. Its
// actions (QWidget::addAction) get a menu if Place::menu is set, and with it a place in the command search.
class Panels final : public QObject {
  Q_OBJECT

 public:
  // Run and messages must outlive the panels. The window owns the docks.
  Panels(QMainWindow& window, RunController& run, MessageBar& messages);
  ~Panels() override;

  MotionPanel& motion() { return *motion_; }
  ModelPanel& model() { return *model_; }
  PlantPanel& plant() { return *plant_; }
  OperatorPanel& operator_panel() { return *operator_; }
  TuningPanels& tuning() { return *tuning_; }
  // Shows a panel in front of those it shares a place with; `name` is that of its dock.
  void raise(const QString& name);
  // Marks the name of a panel: its document has unsaved changes, or is the active one.
  void mark(const QString& name, bool is_modified, bool is_active);

  // Adds a switch for each panel, and the default layout.
  void fill_menu(QMenu& menu);
  // Adds the menus that panels bring.
  void add_menus(QMenuBar& bar);

  // The sizes of the docks as they are now are those of the default layout.
  void remember_default_layout();
  void restore_layout(const QSettings& settings);
  void save_layout(QSettings& settings) const;

 Q_SIGNALS:
  // The user, or the program for him, has brought this panel to the front.
  void shown(const QWidget* panel);

 private:
  struct Place {
    QString name;   // of the dock, for the remembered layout
    QString title;  // visible
    Qt::DockWidgetArea area = Qt::BottomDockWidgetArea;
    bool is_scrolled = false;  // the panel is higher than the window
    QString menu = {};         // of the panel's actions; empty: none
  };

  void make();
  void add(QWidget* panel, const Place& place);
  struct Dock;
  void show_or_close(const Dock& dock);
  void connect_run();
  void show_opened();
  void show_grown(std::size_t first_sample);
  void show_overview(const std::vector<view::Recording>& blocks);
  void show_cursor();
  void update_bus();

  struct Dock {
    QDockWidget* dock;
    QWidget* panel;
    QString title;
    QString menu;
  };

  QMainWindow& window_;
  RunController& run_;
  MessageBar& messages_;
  std::vector<Dock> docks_;
  PlotPanel* plots_ = nullptr;
  SolePanel* soles_ = nullptr;
  CanPanel* can_ = nullptr;
  EventPanel* events_ = nullptr;
  LogPanel* log_ = nullptr;
  ObjectPanel* objects_ = nullptr;
  MotionPanel* motion_ = nullptr;
  ModelPanel* model_ = nullptr;
  PlantPanel* plant_ = nullptr;
  OperatorPanel* operator_ = nullptr;
  TuningPanels* const tuning_;
  QByteArray default_layout_;
  QTimer can_timer_;  // the table of frames is updated less often than the view
};

}  // namespace koboshi::studio
