#include "studio/motion_editor/step_delegate.h"

#include <QComboBox>
#include <QDoubleSpinBox>
#include <QSpinBox>

#include "studio/motion_editor/step_model.h"

namespace koboshi::studio {
namespace {

// The limits of the motion language (docs/reference/motion-language.md).
constexpr double kLongestTime_s = 3600.0;
constexpr double kFastest_deg_per_s = 92'160.0;
constexpr int kMostRounds = 65'535;

QDoubleSpinBox* spin_box(QWidget* parent, double max, double step, int decimals, const QString& unit) {
  auto* const box = new QDoubleSpinBox(parent);
  box->setDecimals(decimals);
  box->setRange(0.0, max);
  box->setSingleStep(step);
  box->setSuffix(unit);
  box->setFrame(false);
  box->setLocale(QLocale::c());
  return box;
}

QComboBox* pose_box(QWidget* parent, const MotionDocument& document) {
  auto* const box = new QComboBox(parent);
  if (const YamlNode* tree = document.tree()) {
    if (const YamlNode* poses = tree->find("poses")) {
      for (const YamlNode& pose : poses->items) box->addItem(QString::fromStdString(pose.key));
    }
  }
  return box;
}

// The labels of the section, or the routines.
QComboBox* label_box(QWidget* parent, const MotionRows& rows, const MotionRow& row) {
  auto* const box = new QComboBox(parent);
  if (row.kind == simulation::StepSource::Kind::kCall) {
    for (const MotionSection& section : rows.sections)
      if (!section.name.empty()) box->addItem(QString::fromStdString(section.name));
    return box;
  }
  for (const MotionRow& other : rows.rows) {
    if (other.kind == simulation::StepSource::Kind::kLabel && other.section == row.section)
      box->addItem(QString::fromStdString(other.label));
  }
  return box;
}

}  // namespace

QWidget* StepDelegate::createEditor(QWidget* parent, const QStyleOptionViewItem& option,
                                    const QModelIndex& index) const {
  const auto* const model = qobject_cast<const StepModel*>(index.model());
  if (model == nullptr) return QStyledItemDelegate::createEditor(parent, option, index);
  switch (index.column()) {
    case StepModel::kTime:
    case StepModel::kPause:
      return spin_box(parent, kLongestTime_s, 0.05, 3, tr(" s"));
    case StepModel::kSpeed:
      return spin_box(parent, kFastest_deg_per_s, 5.0, 2, tr(" °/s"));
    case StepModel::kInterpolation: {
      auto* const box = new QComboBox(parent);
      box->addItem(tr("default of the file"), -1);
      box->addItem(tr("linear"), 0);
      box->addItem(tr("minimum jerk"), 1);
      box->addItem(tr("cubic"), 2);
      box->addItem(tr("trapezoid"), 3);
      return box;
    }
    default:
      break;
  }
  const MotionRow& row = model->editor().rows().rows[static_cast<std::size_t>(index.row())];
  if (row.times) {
    auto* const box = new QSpinBox(parent);
    box->setRange(1, kMostRounds);
    box->setPrefix(tr("loop "));
    box->setSuffix(tr(" times"));
    return box;
  }
  using Kind = simulation::StepSource::Kind;
  if (row.kind == Kind::kMove) return pose_box(parent, model->editor().document());
  if (row.kind == Kind::kJump || row.kind == Kind::kCall)
    return label_box(parent, model->editor().rows(), row);
  return QStyledItemDelegate::createEditor(parent, option, index);
}

void StepDelegate::setEditorData(QWidget* editor, const QModelIndex& index) const {
  const QVariant value = index.data(Qt::EditRole);
  if (auto* const box = qobject_cast<QComboBox*>(editor)) {
    const bool is_pose = index.column() == StepModel::kStep;
    box->setCurrentIndex(is_pose ? box->findText(value.toString()) : box->findData(value));
  } else if (auto* const number = qobject_cast<QDoubleSpinBox*>(editor)) {
    number->setValue(value.toDouble());
  } else if (auto* const count = qobject_cast<QSpinBox*>(editor)) {
    count->setValue(value.toInt());
  } else {
    QStyledItemDelegate::setEditorData(editor, index);
  }
}

void StepDelegate::setModelData(QWidget* editor, QAbstractItemModel* model, const QModelIndex& index) const {
  if (auto* const box = qobject_cast<QComboBox*>(editor)) {
    const bool is_pose = index.column() == StepModel::kStep;
    model->setData(index, is_pose ? QVariant(box->currentText()) : box->currentData(), Qt::EditRole);
  } else if (auto* const number = qobject_cast<QDoubleSpinBox*>(editor)) {
    number->interpretText();
    model->setData(index, number->value(), Qt::EditRole);
  } else if (auto* const count = qobject_cast<QSpinBox*>(editor)) {
    count->interpretText();
    model->setData(index, count->value(), Qt::EditRole);
  } else {
    QStyledItemDelegate::setModelData(editor, model, index);
  }
}

}  // namespace koboshi::studio
