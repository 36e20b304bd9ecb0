#include "studio/plot/plot_row.h"

#include <QContextMenuEvent>
#include <QDropEvent>
#include <QMenu>
#include <QMimeData>
#include <QVBoxLayout>

#include "studio/plot/signal_list.h"

namespace koboshi::studio {

PlotRow::PlotRow(TimeView& view, QWidget* parent)
    : QWidget(parent), plot_(new PlotWidget(view, this)), close_(new QToolButton(this)) {
  setAcceptDrops(true);
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->addWidget(plot_);
  close_->setText(QStringLiteral("×"));
  close_->setAutoRaise(true);
  close_->setToolTip(tr("Remove this plot"));
  close_->setAccessibleName(close_->toolTip());
  close_->setFocusPolicy(Qt::TabFocus);
  close_->setFixedSize(20, 20);
  close_->raise();
  connect(close_, &QToolButton::clicked, this, &PlotRow::close_requested);
}

void PlotRow::contextMenuEvent(QContextMenuEvent* event) {
  QMenu menu;
  for (const Trace& trace : plot_->traces()) {
    const QString name = QString::fromStdString(trace.signal.name);
    menu.addAction(tr("Remove %1").arg(name), this, [this, name] { Q_EMIT remove_requested(name); });
  }
  menu.addSeparator();
  menu.addAction(tr("Remove this plot"), this, &PlotRow::close_requested);
  menu.addAction(tr("Show everything"), this, [this] { plot_->view().show_all(); });
  menu.exec(event->globalPos());
}

void PlotRow::dragEnterEvent(QDragEnterEvent* event) {
  if (event->mimeData()->hasFormat(QLatin1String(kSignalMimeType))) event->acceptProposedAction();
}

void PlotRow::dropEvent(QDropEvent* event) {
  const QStringList names = dragged_signals(*event->mimeData());
  event->acceptProposedAction();
  if (!names.isEmpty()) Q_EMIT dropped(names);
}

void PlotRow::resizeEvent(QResizeEvent* event) {
  QWidget::resizeEvent(event);
  close_->move(width() - close_->width() - 2, 1);
}

}  // namespace koboshi::studio
