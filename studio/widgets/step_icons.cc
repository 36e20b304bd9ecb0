#include "studio/widgets/step_icons.h"

#include <QPainter>
#include <QPainterPath>
#include <QPixmap>
#include <functional>

#include "studio/widgets/colours.h"

namespace koboshi::studio {
namespace {

using simulation::Severity;
using Kind = simulation::StepSource::Kind;

constexpr int kIconSize = 16;
constexpr int kIconScale = 2;  // for displays with twice the density

QPixmap pixmap_of(const std::function<void(QPainter&)>& paint) {
  QPixmap pixmap(kIconSize * kIconScale, kIconSize * kIconScale);
  pixmap.setDevicePixelRatio(kIconScale);
  pixmap.fill(Qt::transparent);
  QPainter painter(&pixmap);
  painter.setRenderHint(QPainter::Antialiasing);
  paint(painter);
  painter.end();
  return pixmap;
}

void arrow_head(QPainter& painter, QPointF tip, QPointF one, QPointF other) {
  painter.drawLine(tip, one);
  painter.drawLine(tip, other);
}

void paint_kind(QPainter& painter, Kind kind, const Colours& colours) {
  painter.setPen(QPen(colours.arrow, 1.6, Qt::SolidLine, Qt::RoundCap, Qt::RoundJoin));
  switch (kind) {
    case Kind::kMove:
      painter.setPen(Qt::NoPen);
      painter.setBrush(colours.key);
      painter.drawPolygon(QPolygonF({{8, 3}, {13, 8}, {8, 13}, {3, 8}}));
      break;
    case Kind::kWait:
    case Kind::kAwait:
      painter.drawLine(QPointF(6, 4), QPointF(6, 12));
      painter.drawLine(QPointF(10, 4), QPointF(10, 12));
      break;
    case Kind::kLoop:
      painter.drawArc(QRectF(3, 3, 10, 10), 70 * 16, 290 * 16);
      arrow_head(painter, {13, 8.5}, {10.5, 7}, {15, 6});
      break;
    case Kind::kIf:
      painter.drawLine(QPointF(3, 8), QPointF(7, 8));
      painter.drawLine(QPointF(7, 8), QPointF(13, 4));
      painter.drawLine(QPointF(7, 8), QPointF(13, 12));
      break;
    case Kind::kLabel:
      painter.drawLine(QPointF(5, 3), QPointF(5, 13));
      painter.setBrush(colours.jump);
      painter.drawPolygon(QPolygonF({{5, 3}, {12, 5.5}, {5, 8}}));
      break;
    case Kind::kJump:
    case Kind::kCall:
    case Kind::kReturn:
      painter.setPen(QPen(colours.jump, 1.6, Qt::SolidLine, Qt::RoundCap));
      painter.drawLine(QPointF(3, 8), QPointF(13, 8));
      arrow_head(painter, {13, 8}, {9.5, 5}, {9.5, 11});
      break;
    default:
      painter.setBrush(colours.arrow);
      painter.drawEllipse(QPointF(8, 8), 1.5, 1.5);
  }
}

}  // namespace

QIcon kind_icon(Kind kind, const QPalette& palette) {
  const auto paint = [&](const Colours& colours) {
    return pixmap_of([&](QPainter& painter) { paint_kind(painter, kind, colours); });
  };
  Colours selected = colours_of(palette);
  selected.arrow = selected.key = selected.jump = palette.color(QPalette::HighlightedText);
  QIcon icon(paint(colours_of(palette)));
  icon.addPixmap(paint(selected), QIcon::Selected);
  return icon;
}

QIcon severity_icon(Severity severity, const QPalette& palette) {
  const QPixmap pixmap = pixmap_of([&](QPainter& painter) {
    painter.setPen(Qt::NoPen);
    painter.setBrush(colours_of(palette).of(severity));
    if (severity == Severity::kError) painter.drawEllipse(QRectF(2, 2, 12, 12));
    if (severity == Severity::kWarning) painter.drawPolygon(QPolygonF({{8, 2}, {15, 14}, {1, 14}}));
    if (severity == Severity::kNote) painter.drawRoundedRect(QRectF(2.5, 2.5, 11, 11), 2, 2);
    painter.setPen(QPen(palette.color(QPalette::Base), 1.8, Qt::SolidLine, Qt::RoundCap));
    const double top = severity == Severity::kWarning ? 6.5 : 4.8;
    painter.drawLine(QPointF(8, top), QPointF(8, 9));
    painter.drawPoint(QPointF(8, 11.7));
  });
  QIcon icon(pixmap);
  icon.addPixmap(pixmap, QIcon::Selected);  // the colour of the severity also in a selected row
  return icon;
}

QIcon good_icon(const QPalette& palette) {
  return QIcon(pixmap_of([&](QPainter& painter) {
    painter.setPen(QPen(colours_of(palette).stable, 2.2, Qt::SolidLine, Qt::RoundCap, Qt::RoundJoin));
    painter.drawPolyline(QPolygonF({{3, 8.5}, {6.5, 12}, {13, 4.5}}));
  }));
}

}  // namespace koboshi::studio
