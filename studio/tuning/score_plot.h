#pragma once

#include <QString>
#include <QWidget>
#include <cstddef>
#include <optional>
#include <vector>

namespace koboshi::studio {

// The score of each evaluation of a study, and the best one so far.
class ScorePlot final : public QWidget {
  Q_OBJECT

 public:
  explicit ScorePlot(QWidget* parent = nullptr);

  // Scores in order of the evaluations, nothing for an infeasible one; `total`: how many there will be.
  void set_scores(std::vector<std::optional<double>> scores, std::size_t total);
  // The picture in words.
  QString text() const;

  QSize sizeHint() const override { return {320, 140}; }
  QSize minimumSizeHint() const override { return {160, 80}; }

 protected:
  void paintEvent(QPaintEvent* event) override;

 private:
  struct Range {
    double low = 0.0;
    double high = 1.0;
  };

  Range range() const;
  void draw_axes(QPainter& painter, const QRectF& area, const Range& range) const;

  std::vector<std::optional<double>> scores_;
  std::size_t total_ = 0;
};

}  // namespace koboshi::studio
