#pragma once

#include <QStringList>
#include <QToolButton>
#include <QWidget>

#include "studio/plot/plot_widget.h"

namespace koboshi::studio {

// A plot of the panel: takes dropped signals, and has a button and a context menu to remove signals and
// itself.
class PlotRow final : public QWidget {
  Q_OBJECT

 public:
  PlotRow(TimeView& view, QWidget* parent);

  PlotWidget& plot() { return *plot_; }

 Q_SIGNALS:
  void dropped(const QStringList& names);
  void remove_requested(const QString& name);
  void close_requested();

 protected:
  void contextMenuEvent(QContextMenuEvent* event) override;
  void dragEnterEvent(QDragEnterEvent* event) override;
  void dropEvent(QDropEvent* event) override;
  void resizeEvent(QResizeEvent* event) override;

 private:
  PlotWidget* plot_;
  QToolButton* close_;
};

}  // namespace koboshi::studio
