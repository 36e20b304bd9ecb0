#include "studio/window/documents.h"

#include <QAbstractSpinBox>
#include <QApplication>
#include <QDockWidget>
#include <QLineEdit>
#include <QMainWindow>
#include <QMessageBox>
#include <QPointer>
#include <QPushButton>
#include <algorithm>
#include <memory>
#include <utility>

#include "studio/model/model_panel.h"
#include "studio/motion_editor/motion_panel.h"
#include "studio/plant/plant_panel.h"
#include "studio/tuning/parameter_panel.h"
#include "studio/window/panels.h"
#include "studio/window/tuning_panels.h"

namespace koboshi::studio {
namespace {

using Question = std::unique_ptr<QMessageBox>;

Question make_question(QWidget& window, const QString& title, const QString& list, bool several) {
  auto box =
      std::make_unique<QMessageBox>(QMessageBox::Warning, QApplication::applicationDisplayName(), title,
                                    QMessageBox::Save | QMessageBox::Discard | QMessageBox::Cancel, &window);
  box->setObjectName(QStringLiteral("unsaved"));
  box->setTextFormat(Qt::PlainText);
  box->setInformativeText(list);
  box->setDefaultButton(QMessageBox::Save);
  box->setEscapeButton(QMessageBox::Cancel);
  box->button(QMessageBox::Save)->setText(several ? Documents::tr("&Save all") : Documents::tr("&Save"));
  box->button(QMessageBox::Discard)->setText(Documents::tr("&Discard"));
  box->button(QMessageBox::Cancel)->setText(Documents::tr("&Cancel"));
  return box;
}

}  // namespace

Documents::Documents(QMainWindow& window, Panels& panels)
    : QObject(&window), panels_(panels), window_(window) {
  watch_panels(window);
  ParameterEditor& parameters = panels_.tuning().parameters().editor();
  const auto activate_shown = [this, &parameters] {
    activate(parameters.shown() == ParameterEditor::kGait ? kGait : kParameters);
  };
  connect(&panels_.motion(), &MotionPanel::edited, this, [this] { activate(kMotion); });
  connect(&panels_.model(), &ModelPanel::edited, this, [this] { activate(kRobot); });
  connect(&panels_.plant(), &PlantPanel::edited, this, [this] { activate(kScenario); });
  connect(&parameters, &ParameterEditor::edited, this, activate_shown);
  connect(&parameters, &ParameterEditor::opened, this, [this, activate_shown] {
    if (active_ == kParameters || active_ == kGait) activate_shown();
    Q_EMIT changed();
  });
  connect(&panels_.motion(), &MotionPanel::edited, this, &Documents::edited);
  connect(&panels_.model(), &ModelPanel::edited, this, &Documents::edited);
  connect(&panels_.plant(), &PlantPanel::edited, this, &Documents::edited);
  connect(&parameters, &ParameterEditor::edited, this, &Documents::edited);
  connect(&panels_.motion(), &MotionPanel::title_changed, this, &Documents::changed);
  connect(&panels_.model(), &ModelPanel::title_changed, this, &Documents::changed);
  connect(&panels_.plant(), &PlantPanel::title_changed, this, &Documents::changed);
  connect(&parameters, &ParameterEditor::changed, this, &Documents::changed);
  panels_.motion().set_keys_everywhere(true);
}

void Documents::watch_panels(QMainWindow& window) {
  const auto activate_in = [this](const QWidget* of) {
    const auto is_in = [of](const QWidget& panel) { return &panel == of || panel.isAncestorOf(of); };
    if (is_in(panels_.motion())) activate(kMotion);
    if (is_in(panels_.model())) activate(kRobot);
    if (is_in(panels_.plant())) activate(kScenario);
    if (is_in(panels_.tuning().parameters()))
      activate(panels_.tuning().parameters().editor().shown() == ParameterEditor::kGait ? kGait
                                                                                        : kParameters);
  };
  connect(qApp, &QApplication::focusChanged, this, [activate_in](QWidget* /*before*/, QWidget* now) {
    if (now != nullptr) activate_in(now);
  });
  connect(&window, &QMainWindow::tabifiedDockWidgetActivated, this,
          [activate_in](const QDockWidget* dock) { activate_in(dock->widget()); });
  connect(&panels_, &Panels::shown, this, activate_in);
}

void Documents::activate(Kind kind) {
  if (kind == active_) return;
  active_ = kind;
  panels_.motion().set_keys_everywhere(kind == kMotion);
  Q_EMIT changed();
}

// --- Open documents

const TextDocument* Documents::document(Kind kind) const {
  const MotionEditor& motion = panels_.motion().editor();
  const ParameterEditor& parameters = panels_.tuning().parameters().editor();
  switch (kind) {
    case kMotion:
      return motion.is_open() ? &motion.document() : nullptr;
    case kRobot:
      return panels_.model().document();
    case kParameters:
      return parameters.document(ParameterEditor::kRobot);
    case kGait:
      return parameters.document(ParameterEditor::kGait);
    case kScenario:
      return panels_.plant().document();
    case kKinds:
      break;
  }
  return nullptr;
}

bool Documents::is_modified(Kind kind) const {
  const TextDocument* one = document(kind);
  return one != nullptr && one->is_modified();
}

QString Documents::kind_name(Kind kind) const {
  switch (kind) {
    case kMotion:
      return tr("Motion");
    case kRobot:
      return tr("Robot");
    case kParameters:
      return tr("Parameters");
    case kGait:
      return tr("Gait");
    case kScenario:
      return tr("Scenario");
    case kKinds:
      break;
  }
  return {};
}

QString Documents::file_name(Kind kind) const {
  const TextDocument* one = document(kind);
  if (one == nullptr) return {};
  return one->file().empty() ? tr("untitled") : QString::fromStdString(one->file().filename().string());
}

QString Documents::dock(Kind kind) const {
  if (kind == kMotion) return QStringLiteral("motion");
  if (kind == kScenario) return QStringLiteral("plant");
  return kind == kRobot ? QStringLiteral("model") : QStringLiteral("parameters");
}

std::vector<Documents::Kind> Documents::unsaved() const {
  std::vector<Kind> found;
  for (int kind = kMotion; kind < kKinds; ++kind)
    if (is_modified(static_cast<Kind>(kind))) found.push_back(static_cast<Kind>(kind));
  return found;
}

// --- Keys of the active document

void Documents::undo() { travel(tr("Nothing to undo in %1"), tr("Undone in %1: %2"), true); }

void Documents::redo() { travel(tr("Nothing to redo in %1"), tr("Redone in %1: %2"), false); }

void Documents::travel(const QString& nothing, const QString& done, bool back) {
  const TextDocument* one = document(active_);
  if (one == nullptr) return Q_EMIT told(tr("No %1 is open").arg(kind_name(active_).toLower()));
  const auto label = back ? one->history().undo_label() : one->history().redo_label();
  const QString edit = QString::fromUtf8(label.data(), static_cast<qsizetype>(label.size()));
  if (edit.isEmpty()) return Q_EMIT told(nothing.arg(file_name(active_)));
  if (active_ == kMotion) {
    back ? panels_.motion().undo() : panels_.motion().redo();
  } else if (active_ == kRobot) {
    back ? panels_.model().undo() : panels_.model().redo();
  } else if (active_ == kScenario) {
    back ? panels_.plant().undo() : panels_.plant().redo();
  } else {
    ParameterEditor& editor = panels_.tuning().parameters().editor();
    back ? editor.undo() : editor.redo();
  }
  Q_EMIT told(done.arg(file_name(active_), edit));
}

// Takes over what is being typed: the field loses the keyboard for a moment.
void Documents::take_typed() {
  const QPointer<QWidget> field = QApplication::focusWidget();
  const bool is_field =
      qobject_cast<QLineEdit*>(field) != nullptr || qobject_cast<QAbstractSpinBox*>(field) != nullptr;
  if (!is_field || !window_.isAncestorOf(field)) return;
  field->clearFocus();
  if (field != nullptr && field->isVisible()) field->setFocus(Qt::OtherFocusReason);
}

void Documents::save() {
  take_typed();
  if (document(active_) == nullptr) return Q_EMIT told(tr("No %1 is open").arg(kind_name(active_).toLower()));
  if (save(active_)) Q_EMIT told(tr("Saved %1").arg(file_name(active_)));
}

bool Documents::save(Kind kind) {
  if (kind == kMotion) return panels_.motion().save();
  if (kind == kRobot) return panels_.model().save();
  if (kind == kScenario) return panels_.plant().save();
  ParameterPanel& parameters = panels_.tuning().parameters();
  parameters.editor().show(kind == kGait ? ParameterEditor::kGait : ParameterEditor::kRobot);
  return parameters.save();
}

bool Documents::save_all(const std::vector<Kind>& kinds) {
  return std::ranges::all_of(kinds, [this](Kind kind) {
    if (save(kind)) return true;
    panels_.raise(dock(kind));
    return false;
  });
}

// A document that is replaced or closed takes its recovery away; parameters keep theirs but for this.
void Documents::discard(const std::vector<Kind>& kinds) {
  ParameterEditor& editor = panels_.tuning().parameters().editor();
  for (const Kind kind : kinds) {
    if (kind == kParameters) editor.discard(ParameterEditor::kRobot);
    if (kind == kGait) editor.discard(ParameterEditor::kGait);
    if (kind == kScenario) panels_.plant().discard();
  }
}

// --- Before changes get lost

QString Documents::names(const std::vector<Kind>& kinds) const {
  QStringList lines;
  for (const Kind kind : kinds) lines << QStringLiteral("%1: %2").arg(kind_name(kind), file_name(kind));
  return lines.join(u'\n');
}

void Documents::settle(const std::vector<Kind>& kinds, const QString& title, std::function<void()> go_on) {
  take_typed();
  std::vector<Kind> lost;
  for (const Kind kind : kinds)
    if (is_modified(kind)) lost.push_back(kind);
  if (lost.empty()) return go_on();
  if (asking_) return;
  asking_ = true;
  QMessageBox* box = make_question(window_, title, names(lost), lost.size() > 1).release();
  box->setAttribute(Qt::WA_DeleteOnClose);
  connect(box, &QMessageBox::finished, this, [this, lost, go_on = std::move(go_on)](int answer) {
    asking_ = false;
    if (answer == QMessageBox::Discard) discard(lost);
    if (answer == QMessageBox::Discard || (answer == QMessageBox::Save && save_all(lost))) go_on();
  });
  box->open();
}

bool Documents::settle_now(const QString& title) {
  take_typed();
  const std::vector<Kind> lost = unsaved();
  if (lost.empty()) return true;
  const Question box = make_question(window_, title, names(lost), lost.size() > 1);
  const int answer = box->exec();
  return answer == QMessageBox::Discard || (answer == QMessageBox::Save && save_all(lost));
}

void Documents::keep_recoveries() {
  panels_.motion().keep_recovery();
  panels_.model().keep_recovery();
  panels_.plant().keep_recovery();
  panels_.tuning().parameters().editor().keep_recoveries();
}

}  // namespace koboshi::studio
