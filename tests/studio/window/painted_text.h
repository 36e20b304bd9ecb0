#pragma once

#include <QPaintDevice>
#include <QPaintEngine>
#include <QPainter>
#include <QStringList>
#include <QWidget>

// The texts that a widget paints itself.
namespace koboshi::studio::test {

// Keeps the texts and draws nothing.
class TextEngine final : public QPaintEngine {
 public:
  explicit TextEngine(QStringList& texts) : QPaintEngine(AllFeatures), texts_(texts) {}
  bool begin(QPaintDevice* /*device*/) override { return true; }
  bool end() override { return true; }
  void updateState(const QPaintEngineState& /*state*/) override {}
  void drawPixmap(const QRectF& /*to*/, const QPixmap& /*pixmap*/, const QRectF& /*from*/) override {}
  void drawImage(const QRectF& /*to*/, const QImage& /*image*/, const QRectF& /*from*/,
                 Qt::ImageConversionFlags /*flags*/) override {}
  void drawTiledPixmap(const QRectF& /*to*/, const QPixmap& /*pixmap*/, const QPointF& /*from*/) override {}
  void drawPath(const QPainterPath& /*path*/) override {}
  void drawPolygon(const QPointF* /*points*/, int /*count*/, PolygonDrawMode /*mode*/) override {}
  void drawTextItem(const QPointF& place, const QTextItem& item) override {
    // A text comes in parts if its font lacks a letter that another font has.
    if (!texts_.isEmpty() && place.y() == last_.y() && place.x() == last_.x() + last_width_) {
      texts_.back() += item.text();
    } else {
      texts_ << item.text();
    }
    last_ = place;
    last_width_ = item.width();
  }
  Type type() const override { return User; }

 private:
  QStringList& texts_;
  QPointF last_;
  double last_width_ = 0.0;
};

class TextDevice final : public QPaintDevice {
 public:
  explicit TextDevice(const QWidget& like) : like_(like), engine_(texts_) {}
  QPaintEngine* paintEngine() const override { return &engine_; }
  const QStringList& texts() const { return texts_; }

 protected:
  int metric(PaintDeviceMetric which) const override {
    switch (which) {
      case PdmWidth:
        return like_.width();
      case PdmHeight:
        return like_.height();
      case PdmDpiX:
      case PdmPhysicalDpiX:
        return like_.logicalDpiX();
      case PdmDpiY:
      case PdmPhysicalDpiY:
        return like_.logicalDpiY();
      case PdmDepth:
        return 32;
      case PdmDevicePixelRatio:
        return 1;
      default:
        return QPaintDevice::metric(which);
    }
  }

 private:
  const QWidget& like_;
  QStringList texts_;
  mutable TextEngine engine_;
};

// Without those of its children.
inline QStringList painted_texts(QWidget& widget) {
  TextDevice device(widget);
  QPainter painter(&device);
  widget.render(&painter, QPoint(), QRegion(), QWidget::RenderFlags());
  painter.end();
  return device.texts();
}

}  // namespace koboshi::studio::test
