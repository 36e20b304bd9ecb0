#include "studio/tuning/study_panel.h"

#include <QComboBox>
#include <QCoreApplication>
#include <QFormLayout>
#include <QHBoxLayout>
#include <QHeaderView>
#include <QLabel>
#include <QLineEdit>
#include <QProgressBar>
#include <QPushButton>
#include <QScrollArea>
#include <QScrollBar>
#include <QSpinBox>
#include <QSplitter>
#include <QTableWidget>
#include <QVBoxLayout>
#include <algorithm>

#include "base/text/error.h"
#include "sim_board/world/options.h"
#include "studio/tuning/score_plot.h"

namespace koboshi::studio {
namespace {

constexpr int kPoll_ms = 500;
constexpr int kPatience_ms = 3000;  // for a process that ends
constexpr std::size_t kListed = 12;

QSpinBox* count_box(int low, int high, int value, const QString& tip) {
  auto* box = new QSpinBox;
  box->setRange(low, high);
  box->setValue(value);
  box->setToolTip(tip);
  box->setAccessibleName(tip);
  return box;
}

}  // namespace

StudyPanel::StudyPanel(QWidget* parent)
    : QWidget(parent),
      program_(QCoreApplication::applicationDirPath().toStdString() + "/koboshi"),
      study_(new QComboBox),
      evaluations_(count_box(16, 1'000'000, 200, tr("Sets of parameters that are tried"))),
      seeds_(count_box(1, 1000, 3, tr("Worlds in which each set is tried"))),
      first_seed_(count_box(0, 1'000'000'000, 9000, tr("Seed of the first world"))),
      stepper_(new QComboBox),
      jobs_(count_box(0, 1024, 0, tr("Trials at a time"))),
      out_(new QLineEdit),
      start_(new QPushButton(tr("Start search"))),
      stop_(new QPushButton(tr("Stop search"))),
      adopt_(new QPushButton(tr("Adopt"))),
      progress_(new QProgressBar),
      state_(new QLabel),
      plot_(new ScorePlot),
      table_(new QTableWidget) {
  auto* left = new QWidget;
  auto* form = new QFormLayout(left);
  form->setContentsMargins(0, 0, 4, 0);
  add_settings(*form);
  auto* right = new QWidget;
  auto* column = new QVBoxLayout(right);
  column->setContentsMargins(0, 0, 0, 0);
  state_->setWordWrap(true);
  state_->setObjectName(QStringLiteral("study_state"));
  progress_->setFormat(QStringLiteral("%v / %m"));
  column->addWidget(progress_);
  column->addWidget(state_);
  column->addWidget(plot_, 2);
  column->addWidget(table_, 3);
  table_->setEditTriggers(QAbstractItemView::NoEditTriggers);
  table_->setSelectionBehavior(QAbstractItemView::SelectRows);
  table_->setSelectionMode(QAbstractItemView::SingleSelection);
  table_->verticalHeader()->hide();
  table_->verticalHeader()->setDefaultSectionSize(table_->fontMetrics().height() + 6);
  table_->setAccessibleName(tr("Best sets"));
  auto* splitter = new QSplitter(Qt::Horizontal);
  auto* scrolled = new QScrollArea;
  scrolled->setWidget(left);
  scrolled->setWidgetResizable(true);
  scrolled->setFrameShape(QFrame::NoFrame);
  scrolled->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
  scrolled->setMinimumWidth(left->minimumSizeHint().width() +
                            scrolled->verticalScrollBar()->sizeHint().width());
  splitter->addWidget(scrolled);
  splitter->addWidget(right);
  splitter->setStretchFactor(1, 1);
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(4, 4, 4, 4);
  layout->addWidget(splitter);

  process_.setProcessChannelMode(QProcess::MergedChannels);
  connect(&process_, &QProcess::finished, this, &StudyPanel::end);
  connect(&process_, &QProcess::errorOccurred, this, [this](QProcess::ProcessError error) {
    if (error == QProcess::FailedToStart)
      Q_EMIT failed(
          tr("Cannot start %1: %2").arg(QString::fromStdString(program_.string()), process_.errorString()));
    show_run();
  });
  timer_.setInterval(kPoll_ms);
  connect(&timer_, &QTimer::timeout, this, [this] {
    if (isVisible() || is_running()) poll();
  });
  timer_.start();
  show_run();
}

StudyPanel::~StudyPanel() {
  process_.disconnect(this);
  if (!is_running()) return;
  process_.terminate();
  if (!process_.waitForFinished(kPatience_ms)) process_.kill();
}

void StudyPanel::add_settings(QFormLayout& form) {
  study_->setAccessibleName(tr("Study"));
  study_->setProperty("verbatim", true);  // names of files, and of steppers
  stepper_->setProperty("verbatim", true);
  study_->setToolTip(tr("File that names the parameters, their ranges and the trials"));
  stepper_->addItem(tr("of the scenario"), QString());
  for (const std::string& name : sim_board::stepper_names())
    stepper_->addItem(QString::fromStdString(name), QString::fromStdString(name));
  stepper_->setToolTip(tr("Method by which the physics engine computes a step"));
  jobs_->setSpecialValueText(tr("all cores"));
  out_->setToolTip(tr("Folder of the results; a search that it holds is resumed"));
  out_->setAccessibleName(tr("Folder of the results"));
  start_->setObjectName(QStringLiteral("start_study"));
  start_->setToolTip(tr("Runs koboshi tune with these settings, or resumes it"));
  stop_->setToolTip(tr("Ends the search; it goes on from there when it is started again"));
  adopt_->setObjectName(QStringLiteral("adopt"));
  adopt_->setToolTip(
      tr("Gives the parameters the values of the selected set, or of the best one, as one change"));
  form.addRow(tr("Study"), study_);
  form.addRow(tr("Evaluations"), evaluations_);
  form.addRow(tr("Worlds"), seeds_);
  form.addRow(tr("First seed"), first_seed_);
  form.addRow(tr("Stepper"), stepper_);
  form.addRow(tr("Jobs"), jobs_);
  form.addRow(tr("Results"), out_);
  auto* buttons = new QHBoxLayout;
  for (QPushButton* button : {start_, stop_, adopt_}) buttons->addWidget(button);
  form.addRow(buttons);
  connect(study_, qOverload<int>(&QComboBox::currentIndexChanged), this, &StudyPanel::choose_study);
  connect(out_, &QLineEdit::editingFinished, this, &StudyPanel::open_folder);
  connect(start_, &QPushButton::clicked, this, &StudyPanel::start);
  connect(stop_, &QPushButton::clicked, this, &StudyPanel::stop);
  connect(adopt_, &QPushButton::clicked, this, &StudyPanel::adopt);
}

void StudyPanel::set_folder(const std::filesystem::path& studies) {
  if (is_running()) return;
  study_->clear();
  for (const std::filesystem::path& study : find_studies(studies))
    study_->addItem(QString::fromStdString(study.filename().string()),
                    QString::fromStdString(study.string()));
  show_run();
}

void StudyPanel::choose_study() {
  const std::filesystem::path study = study_->currentData().toString().toStdString();
  out_->setText(QString::fromStdString(
      std::filesystem::absolute(std::filesystem::path("runs/tune") / study.stem()).string()));
  open_folder();
}

// A search that is there is shown, and resumed, with its own settings.
void StudyPanel::open_folder() {
  poll();
  if (!run_) return;
  StudySettings there = run_->settings;
  there.study = study_->currentData().toString().toStdString();
  there.jobs = static_cast<std::size_t>(jobs_->value());
  show_settings(there);
}

StudySettings StudyPanel::settings() const {
  StudySettings settings = other_;
  settings.study = study_->currentData().toString().toStdString();
  settings.out = out_->text().toStdString();
  settings.evaluations = static_cast<std::size_t>(evaluations_->value());
  settings.seeds = static_cast<std::size_t>(seeds_->value());
  settings.first_seed = static_cast<std::uint64_t>(first_seed_->value());
  settings.stepper = stepper_->currentData().toString().toStdString();
  settings.jobs = static_cast<std::size_t>(jobs_->value());
  return settings;
}

void StudyPanel::set_settings(const StudySettings& settings) {
  const int known = study_->findData(QString::fromStdString(settings.study.string()));
  if (known < 0)
    study_->addItem(QString::fromStdString(settings.study.filename().string()),
                    QString::fromStdString(settings.study.string()));
  study_->setCurrentIndex(known < 0 ? study_->count() - 1 : known);
  out_->setText(QString::fromStdString(settings.out.string()));
  show_settings(settings);
  poll();
}

void StudyPanel::show_settings(const StudySettings& settings) {
  other_ = settings;
  evaluations_->setValue(static_cast<int>(settings.evaluations));
  seeds_->setValue(static_cast<int>(settings.seeds));
  first_seed_->setValue(static_cast<int>(settings.first_seed));
  stepper_->setCurrentIndex(std::max(0, stepper_->findData(QString::fromStdString(settings.stepper))));
  jobs_->setValue(static_cast<int>(settings.jobs));
}

// --- The process

void StudyPanel::start() {
  if (is_running() || study_->currentIndex() < 0) return;
  QStringList arguments;
  for (const std::string& argument : tune_arguments(settings()))
    arguments << QString::fromStdString(argument);
  stopping_ = false;
  process_.start(QString::fromStdString(program_.string()), arguments);
  poll();
}

void StudyPanel::stop() {
  if (!is_running()) return;
  stopping_ = true;
  process_.terminate();
}

void StudyPanel::end(int status, QProcess::ExitStatus how) {
  const QString output = QString::fromUtf8(process_.readAll()).trimmed();
  const bool failed_itself = how == QProcess::CrashExit || status != 0;
  poll();
  if (failed_itself && !stopping_)
    Q_EMIT failed(output.isEmpty() ? tr("koboshi tune ended") : output.section(QLatin1Char('\n'), -1));
  Q_EMIT finished();
}

void StudyPanel::poll() {
  try {
    run_ = out_->text().isEmpty() ? std::nullopt : read_study_run(out_->text().toStdString());
  } catch (const std::exception& error) {
    run_.reset();
    state_->setText(QString::fromUtf8(error.what()));
    return;
  }
  show_run();
}

// --- Display

void StudyPanel::show_run() {
  const bool here = is_running();
  const bool elsewhere = !here && run_ && run_->is_running;
  const bool resumes = run_ && !run_->is_finished;
  start_->setEnabled(!here && !elsewhere && study_->currentIndex() >= 0);
  start_->setText(resumes ? tr("Resume search") : tr("Start search"));
  stop_->setEnabled(here);
  adopt_->setEnabled(run_ && run_->best() != nullptr);
  std::vector<std::optional<double>> scores;
  if (run_)
    for (const StudyEvaluation& evaluation : run_->evaluations) scores.push_back(evaluation.score);
  const std::size_t total = run_ ? run_->settings.evaluations : settings().evaluations;
  progress_->setRange(0, static_cast<int>(total));
  progress_->setValue(static_cast<int>(scores.size()));
  plot_->set_scores(std::move(scores), total);
  QString text = here ? tr("running") : elsewhere ? tr("running in another program") : tr("not started");
  if (!here && !elsewhere && run_) text = run_->is_finished ? tr("finished") : tr("interrupted");
  if (const StudyEvaluation* best = run_ ? run_->best() : nullptr)
    text += tr(", best score %1 in evaluation %2 (on the seeds of the search)")
                .arg(*best->score, 0, 'f', 4)
                .arg(best->number);
  state_->setText(text);
  show_table();
}

void StudyPanel::show_table() {
  std::vector<std::size_t> listed;
  if (run_)
    for (const StudyEvaluation* evaluation : run_->best(kListed)) listed.push_back(evaluation->number);
  if (listed == listed_) return;
  listed_ = std::move(listed);
  table_->clear();
  table_->setRowCount(static_cast<int>(listed_.size()));
  QStringList head{tr("Evaluation"), tr("Score")};
  if (run_) {
    for (const std::string& trial : run_->trials) head << QString::fromStdString(trial);
    for (const std::string& path : run_->paths)
      head << QString::fromStdString(path).section(QLatin1Char('.'), -1);
  }
  table_->setColumnCount(static_cast<int>(head.size()));
  table_->setHorizontalHeaderLabels(head);
  for (int line = 0; line < table_->rowCount(); ++line) {
    const StudyEvaluation& evaluation = run_->evaluations[listed_[static_cast<std::size_t>(line)] - 1];
    QStringList cells{QString::number(evaluation.number), QString::number(*evaluation.score, 'f', 4)};
    for (const auto& score : evaluation.trial_scores)
      cells << (score ? QString::number(*score, 'f', 3) : QString());
    for (const double value : evaluation.values) cells << QString::number(value, 'g', 6);
    for (int column = 0; column < cells.size(); ++column) {
      auto* item = new QTableWidgetItem(cells[column]);
      item->setTextAlignment(Qt::AlignRight | Qt::AlignVCenter);
      table_->setItem(line, column, item);
    }
  }
  table_->resizeColumnsToContents();
}

void StudyPanel::adopt() {
  if (!run_) return;
  const int line = table_->selectionModel() != nullptr && table_->selectionModel()->hasSelection()
                       ? table_->currentRow()
                       : -1;
  if (line >= 0 && static_cast<std::size_t>(line) < listed_.size()) {
    Q_EMIT adopted(*run_, run_->evaluations[listed_[static_cast<std::size_t>(line)] - 1]);
  } else if (const StudyEvaluation* best = run_->best()) {
    Q_EMIT adopted(*run_, *best);
  }
}

}  // namespace koboshi::studio
