#include "studio/tuning/compare_panel.h"

#include <QComboBox>
#include <QCoreApplication>
#include <QDoubleSpinBox>
#include <QHBoxLayout>
#include <QHeaderView>
#include <QLabel>
#include <QPointer>
#include <QPushButton>
#include <QSplitter>
#include <QTableWidget>
#include <QThreadPool>
#include <QVBoxLayout>
#include <algorithm>
#include <cmath>
#include <exception>
#include <utility>

#include "simulation/scenario/reader.h"
#include "studio/tuning/compare_plot.h"
#include "studio/tuning/compared_robots.h"
#include "studio/view/robot_view.h"

namespace koboshi::studio {
namespace {

constexpr int kTick_ms = 33;
constexpr int kResults_ms = 500;
constexpr double kMaxChunk_ms = 100.0;  // simulated at once, so that a command is obeyed soon
// Choices of a set; kept sets follow.
enum Choice { kInFile, kEdited, kFirstKept };

QDoubleSpinBox* velocity(double bound, double step, const QString& unit, const QString& tip) {
  auto* box = new QDoubleSpinBox;
  box->setLocale(QLocale::c());
  box->setRange(-bound, bound);
  box->setSingleStep(step);
  box->setSuffix(QLatin1Char(' ') + unit);
  box->setToolTip(tip);
  box->setAccessibleName(tip);
  return box;
}

}  // namespace

ComparePanel::ComparePanel(QWidget* parent)
    : QWidget(parent),
      start_(new QPushButton(tr("Compare"))),
      play_(new QPushButton(tr("Pause"))),
      speed_(new QComboBox),
      forward_(velocity(0.5, 0.05, QStringLiteral("m/s"), tr("Forward velocity in m/s"))),
      left_(velocity(0.3, 0.02, QStringLiteral("m/s"), tr("Velocity to the left in m/s"))),
      turn_(velocity(2.0, 0.1, QStringLiteral("rad/s"),
                     tr("Turning rate in rad/s, counter-clockwise from above"))),
      robots_(new ComparedRobots),
      table_(new QTableWidget),
      plot_(new ComparePlot) {
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(4, 4, 4, 4);
  layout->addLayout(make_sets());
  layout->addLayout(make_commands());
  auto* splitter = new QSplitter(Qt::Horizontal);
  splitter->addWidget(robots_);
  splitter->addWidget(make_results());
  splitter->setStretchFactor(0, 3);
  splitter->setStretchFactor(1, 2);
  splitter->setChildrenCollapsible(false);
  layout->addWidget(splitter, 1);
  connect(plot_, &ComparePlot::cursor_moved, this, &ComparePanel::show_time);
  connect(&robots_->view(), &RobotView::failed, this, &ComparePanel::failed);
  timer_.setInterval(kTick_ms);
  connect(&timer_, &QTimer::timeout, this, &ComparePanel::tick);
}

ComparePanel::~ComparePanel() = default;

RobotView& ComparePanel::view() { return robots_->view(); }

QHBoxLayout* ComparePanel::make_sets() {
  auto* line = new QHBoxLayout;
  for (std::size_t run = 0; run < kRuns; ++run) {
    auto* label = new QLabel(run == 0 ? QStringLiteral("A") : QStringLiteral("B"));
    QPalette palette = label->palette();
    palette.setColor(QPalette::WindowText, colour_of_run(run));
    label->setPalette(palette);
    auto* choice = new QComboBox;
    choice->addItem(tr("Values in the file"));
    choice->addItem(tr("Values in the editor"));
    choice->setCurrentIndex(run == 0 ? kInFile : kEdited);
    choice->setToolTip(tr("Parameters with which this robot walks"));
    choice->setAccessibleName(run == 0 ? tr("Set A") : tr("Set B"));
    choices_[run] = choice;
    line->addWidget(label);
    line->addWidget(choice, 1);
  }
  auto* keep = new QPushButton(tr("Keep"));
  keep->setToolTip(tr("Keeps the values of the editor as a further choice"));
  connect(keep, &QPushButton::clicked, this, &ComparePanel::keep);
  start_->setObjectName(QStringLiteral("compare"));
  start_->setToolTip(tr("Runs the open scenario twice, with the same seed and these two sets"));
  start_->setEnabled(false);
  connect(start_, &QPushButton::clicked, this, &ComparePanel::start);
  line->addWidget(keep);
  line->addWidget(start_);
  return line;
}

QHBoxLayout* ComparePanel::make_commands() {
  play_->setEnabled(false);
  connect(play_, &QPushButton::clicked, this, [this] { set_playing(!playing_); });
  const std::pair<QString, double> speeds[]{
      {tr("as fast as possible"), 0.0}, {tr("real time"), 1.0}, {tr("1/4 of real time"), 0.25}};
  for (const auto& [name, speed] : speeds) speed_->addItem(name, speed);
  speed_->setToolTip(tr("Speed of the simulations"));
  forward_->setValue(0.2);
  auto* walk = new QPushButton(tr("Walk both"));
  walk->setObjectName(QStringLiteral("walk_both"));
  walk->setToolTip(tr("Gives both robots this velocity at the same simulated time"));
  connect(walk, &QPushButton::clicked, this, &ComparePanel::walk);
  auto* line = new QHBoxLayout;
  for (QWidget* widget : std::initializer_list<QWidget*>{play_, speed_, forward_, left_, turn_, walk})
    line->addWidget(widget);
  line->addStretch(1);
  return line;
}

QWidget* ComparePanel::make_results() {
  table_->setColumnCount(4);
  table_->setHorizontalHeaderLabels(
      {tr("Result"), QStringLiteral("A"), QStringLiteral("B"), QStringLiteral("B − A")});
  table_->setEditTriggers(QAbstractItemView::NoEditTriggers);
  table_->verticalHeader()->hide();
  table_->verticalHeader()->setDefaultSectionSize(table_->fontMetrics().height() + 6);
  table_->horizontalHeader()->setSectionResizeMode(QHeaderView::ResizeToContents);
  table_->horizontalHeader()->setSectionResizeMode(0, QHeaderView::Stretch);
  table_->setAccessibleName(tr("Results of both"));
  auto* side = new QWidget;
  auto* column = new QVBoxLayout(side);
  column->setContentsMargins(0, 0, 0, 0);
  column->addWidget(table_, 1);
  column->addWidget(plot_, 1);
  plot_->hide();  // nothing to plot yet
  return side;
}

void ComparePanel::set_scenario(const std::filesystem::path& scenario, std::uint64_t seed) {
  scenario_ = scenario;
  seed_ = seed;
  start_->setEnabled(!scenario.empty());
}

void ComparePanel::keep() {
  if (!edited_) return;
  kept_.push_back(edited_());
  for (QComboBox* choice : choices_) choice->addItem(tr("Kept set %1").arg(kept_.size()));
}

ComparePanel::Set ComparePanel::set_of(const QComboBox& choice) const {
  const int index = choice.currentIndex();
  if (index >= kFirstKept) return kept_.at(static_cast<std::size_t>(index - kFirstKept));
  return index == kEdited && edited_ ? edited_() : Set([](simulation::Scenario&) {});
}

void ComparePanel::start() {
  const std::uint64_t request = ++request_;
  const QPointer<ComparePanel> self(this);
  const std::array<Set, kRuns> sets{set_of(*choices_[0]), set_of(*choices_[1])};
  QThreadPool::globalInstance()->start([self, request, sets, file = scenario_, seed = seed_] {
    auto made = std::make_shared<std::unique_ptr<Comparison>>();
    QString error;
    try {
      std::array<simulation::Scenario, kRuns> scenarios;
      for (std::size_t run = 0; run < kRuns; ++run) {
        scenarios[run] = simulation::read_scenario(file);
        scenarios[run].seed = seed;
        sets[run](scenarios[run]);
      }
      *made = std::make_unique<Comparison>(std::move(scenarios));
    } catch (const std::exception& exception) {
      error = QString::fromUtf8(exception.what()).trimmed();
    }
    // The application outlives its thread pool; the panel may be gone.
    QMetaObject::invokeMethod(
        QCoreApplication::instance(),
        [self, request, made, error] {
          if (!self || request != self->request_) return;
          if (*made) {
            self->show_started(std::move(*made));
          } else {
            Q_EMIT self->failed(error);
          }
        },
        Qt::QueuedConnection);
  });
}

void ComparePanel::show_started(std::unique_ptr<Comparison> comparison) {
  plot_->set_comparison(*comparison);
  plot_->show();
  comparison_ = std::move(comparison);
  robots_->set_scenes(*comparison_, {QStringLiteral("A: ") + choices_[0]->currentText(),
                                     QStringLiteral("B: ") + choices_[1]->currentText()});
  comparison_->advance(10);
  play_->setEnabled(true);
  set_playing(true);
  Q_EMIT started();
}

void ComparePanel::set_playing(bool playing) {
  playing_ = playing && comparison_ && !comparison_->is_finished();
  play_->setText(playing_ ? tr("Pause") : tr("Go on"));
  wall_.start();
  results_age_.start();
  if (comparison_) timer_.start();
}

void ComparePanel::walk() {
  if (!comparison_) return;
  simulation::Command command;
  command.kind = simulation::Command::Kind::kWalk;
  command.velocity = {forward_->value(), left_->value(), turn_->value()};
  comparison_->give(command);
}

void ComparePanel::tick() {
  const bool was_busy = comparison_->is_busy();
  if (playing_ && !was_busy) {
    const double speed = speed_->currentData().toDouble();
    const double elapsed_ms = 1e-6 * static_cast<double>(wall_.nsecsElapsed());
    wall_.start();
    const double chunk_ms = speed > 0.0 ? std::min(speed * elapsed_ms, kMaxChunk_ms) : kMaxChunk_ms;
    comparison_->advance(static_cast<std::uint64_t>(std::max(1.0, chunk_ms)));
  }
  if (comparison_->take()) show_grown();
  const bool ends = !was_busy && (!playing_ || comparison_->is_finished());
  if (ends || (!was_busy && results_age_.elapsed() > kResults_ms)) show_results();
  if (!ends || comparison_->is_busy()) return;
  timer_.stop();
  if (comparison_->take()) show_grown();
  if (const std::string error = comparison_->error(); !error.empty())
    Q_EMIT failed(QString::fromStdString(error));
  if (playing_) set_playing(false);
}

// --- Display

void ComparePanel::show_grown() {
  plot_->grow();
  const std::size_t common = comparison_->common_samples();
  if (common > 0 && plot_->follows()) show_time(comparison_->recording(0).samples[common - 1].time_us);
}

void ComparePanel::show_time(std::uint64_t time_us) {
  if (!comparison_ || comparison_->common_samples() == 0) return;
  plot_->set_cursor(time_us);
  robots_->show_time(*comparison_, time_us);
}

void ComparePanel::show_results() {
  results_age_.start();
  const std::vector<ComparedResult> results = compare(comparison_->summary(0), comparison_->summary(1));
  table_->setRowCount(static_cast<int>(results.size()));
  for (int line = 0; line < table_->rowCount(); ++line) {
    const ComparedResult& result = results[static_cast<std::size_t>(line)];
    QString name = tr(result.name.c_str());
    if (!result.unit.empty()) name += QStringLiteral(" [%1]").arg(QString::fromStdString(result.unit));
    const auto text = [&](double value) {
      if (!std::isfinite(value)) return QStringLiteral("–");
      const double step = std::pow(10.0, -result.decimals);
      const bool is_zero = std::abs(value) < 0.5 * step;
      return QString::number(is_zero ? 0.0 : value, 'f', result.decimals);
    };
    const QString cells[]{name, text(result.values[0]), text(result.values[1]), text(result.difference())};
    for (int column = 0; column < 4; ++column) {
      auto* item = new QTableWidgetItem(cells[column]);
      if (column > 0) item->setTextAlignment(Qt::AlignRight | Qt::AlignVCenter);
      table_->setItem(line, column, item);
    }
  }
}

}  // namespace koboshi::studio
