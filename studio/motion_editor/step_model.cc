#include "studio/motion_editor/step_model.h"

#include <QGuiApplication>
#include <QMimeData>
#include <algorithm>
#include <cctype>
#include <set>
#include <string_view>
#include <utility>

#include "base/text/text.h"
#include "studio/document/edit_support.h"
#include "studio/widgets/colours.h"
#include "studio/widgets/step_icons.h"

namespace koboshi::studio {
namespace {

using Kind = simulation::StepSource::Kind;

QString number(double value, int decimals) { return QString::number(value, 'f', decimals); }
// Whether a value needs no quotes in flow style.
bool is_plain(const std::string& text) {
  const auto fits = [](char letter) {
    return std::isalnum(static_cast<unsigned char>(letter)) != 0 ||
           std::string_view(" _.<>=+-*/()").find(letter) != std::string_view::npos;
  };
  return !text.empty() && std::isalnum(static_cast<unsigned char>(text.front())) != 0 && text.back() != ' ' &&
         std::ranges::all_of(text, fits);
}

// A value in flow style.
std::string flow_text(const YamlNode& node) {
  if (node.kind == YamlNode::Kind::kScalar) {
    return is_plain(node.scalar) || parse_number(node.scalar) ? node.scalar : yaml_scalar(node.scalar);
  }
  const bool is_map = node.kind == YamlNode::Kind::kMap;
  std::string text;
  for (const YamlNode& item : node.items)
    text += (text.empty() ? "" : ", ") + (is_map ? item.key + ": " : "") + flow_text(item);
  return is_map ? "{" + text + "}" : "[" + text + "]";
}

constexpr const char* kRowsType = "application/x-koboshi-steps";

// As in the file.
QString short_number(double value) { return QString::number(value, 'g', 7); }

}  // namespace

StepModel::StepModel(MotionEditor& editor, QObject* parent) : QAbstractTableModel(parent), editor_(editor) {
  set_palette(QGuiApplication::palette());
  connect(&editor, &MotionEditor::opened, this, &StepModel::reset);
  connect(&editor, &MotionEditor::changed, this, &StepModel::refresh);
  connect(&editor, &MotionEditor::findings_changed, this, &StepModel::refresh);
}

void StepModel::set_palette(const QPalette& palette) {
  for (std::size_t i = 0; i < kind_icons_.size(); ++i)
    kind_icons_[i] = kind_icon(static_cast<Kind>(i), palette);
  for (std::size_t i = 0; i < severity_icons_.size(); ++i)
    severity_icons_[i] = severity_icon(static_cast<simulation::Severity>(i), palette);
  dim_ = colours_of(palette).dim;
  if (!cells_.empty()) Q_EMIT dataChanged(index(0, 0), index(rowCount() - 1, kColumns - 1));
}

int StepModel::rowCount(const QModelIndex& parent) const {
  return parent.isValid() ? 0 : static_cast<int>(cells_.size());
}

int StepModel::columnCount(const QModelIndex& parent) const { return parent.isValid() ? 0 : kColumns; }

// --- Following the document

StepModel::Cells StepModel::cells_of(const MotionRow& row, std::size_t index) const {
  Cells cells;
  cells.depth = row.depth;
  cells.kind = row.kind;
  cells.text[kStep] = QString::fromStdString(row.text);
  if (row.in_else && row.list_index == 0) cells.text[kStep].prepend(tr("else: "));
  cells.text[kStart] = number(row.start_s, 2);
  if (row.time_s)
    cells.text[kTime] = (row.at_least ? QStringLiteral("≥ ") : QString()) + short_number(*row.time_s);
  if (row.kind == Kind::kMove) {
    if (row.speed_deg_per_s) {
      cells.text[kSpeed] = short_number(*row.speed_deg_per_s);
      cells.text[kTime].clear();
    }
    if (row.pause_s > 0.0) cells.text[kPause] = short_number(row.pause_s);
    const std::array names{tr("linear"), tr("minimum jerk"), tr("cubic"), tr("trapezoid")};
    cells.text[kInterpolation] = names.at(static_cast<std::size_t>(row.interpolation));
    cells.inherits_interpolation = !row.own_interpolation;
  }
  for (const RowFinding* finding : editor_.findings_of(index)) {
    const int severity = static_cast<int>(finding->severity);
    if (cells.severity < 0 || severity < cells.severity) {
      cells.severity = severity;
      cells.text[kFinding] = finding->code + u' ' + finding->text;
    }
    cells.findings +=
        (cells.findings.isEmpty() ? QString() : QStringLiteral("\n")) + finding->code + u' ' + finding->text;
    if (!finding->hint.isEmpty()) cells.findings += u'\n' + finding->hint;
  }
  return cells;
}

void StepModel::reset() {
  beginResetModel();
  cells_.clear();
  endResetModel();
}

void StepModel::refresh() {
  const std::vector<MotionRow>& rows = editor_.rows().rows;
  std::vector<Cells> wanted;
  wanted.reserve(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) wanted.push_back(cells_of(rows[i], i));
  if (wanted.size() != cells_.size()) {
    // The steps between the common beginning and the common end are others.
    const auto same = [](const Cells& one, const Cells& other) { return one.is_same_step(other); };
    const std::size_t shorter = std::min(wanted.size(), cells_.size());
    const auto length = static_cast<std::ptrdiff_t>(shorter);
    const auto head = std::mismatch(cells_.begin(), cells_.begin() + length, wanted.begin(), same);
    const auto first = static_cast<std::size_t>(head.first - cells_.begin());
    const auto rest = static_cast<std::ptrdiff_t>(shorter - first);
    const auto tail = std::mismatch(cells_.rbegin(), cells_.rbegin() + rest, wanted.rbegin(), same);
    const auto common = static_cast<std::size_t>(tail.first - cells_.rbegin());
    const auto begin = cells_.begin() + static_cast<std::ptrdiff_t>(first);
    if (const std::size_t old = cells_.size() - common; old > first) {
      beginRemoveRows({}, static_cast<int>(first), static_cast<int>(old) - 1);
      cells_.erase(begin, begin + static_cast<std::ptrdiff_t>(old - first));
      endRemoveRows();
    }
    if (const std::size_t end = wanted.size() - common; end > first) {
      beginInsertRows({}, static_cast<int>(first), static_cast<int>(end) - 1);
      cells_.insert(cells_.begin() + static_cast<std::ptrdiff_t>(first),
                    wanted.begin() + static_cast<std::ptrdiff_t>(first),
                    wanted.begin() + static_cast<std::ptrdiff_t>(end));
      endInsertRows();
    }
  }
  emit_changes(wanted);
}

// One signal for each run of rows in which the same columns change.
void StepModel::emit_changes(const std::vector<Cells>& wanted) {
  struct Run {
    int first_row, last_row, first_column, last_column;
  };
  std::vector<Run> runs;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    if (wanted[i] == cells_[i]) continue;
    int first = kColumns;
    int last = -1;
    for (int column = 0; column < kColumns; ++column) {
      const auto c = static_cast<std::size_t>(column);
      bool differs = wanted[i].text[c] != cells_[i].text[c];
      if (column == kStep) differs |= wanted[i].kind != cells_[i].kind || wanted[i].depth != cells_[i].depth;
      if (column == kInterpolation)
        differs |= wanted[i].inherits_interpolation != cells_[i].inherits_interpolation;
      if (column == kFinding)
        differs |= wanted[i].severity != cells_[i].severity || wanted[i].findings != cells_[i].findings;
      if (!differs) continue;
      first = std::min(first, column);
      last = column;
    }
    const int row = static_cast<int>(i);
    if (!runs.empty() && runs.back().last_row == row - 1 && runs.back().first_column == first &&
        runs.back().last_column == last) {
      runs.back().last_row = row;
    } else {
      runs.push_back({row, row, first, last});
    }
  }
  cells_ = wanted;
  for (const Run& run : runs)
    Q_EMIT dataChanged(index(run.first_row, run.first_column), index(run.last_row, run.last_column));
}

// --- Contents

QVariant StepModel::headerData(int section, Qt::Orientation orientation, int role) const {
  if (orientation == Qt::Vertical) return role == Qt::DisplayRole ? QVariant(section + 1) : QVariant();
  if (role == Qt::TextAlignmentRole)
    return section >= kStart && section <= kPause ? int(Qt::AlignRight | Qt::AlignVCenter)
                                                  : int(Qt::AlignLeft | Qt::AlignVCenter);
  const std::array titles{tr("Step"),    tr("Start s"),       tr("Time s"), tr("Speed °/s"),
                          tr("Pause s"), tr("Interpolation"), tr("Finding")};
  const std::array tips{tr("Step of the motion, with its body below it"),
                        tr("Start in s since the beginning of the program or routine"),
                        tr("Duration of the move or wait in s"),
                        tr("Peak speed of the fastest joint in degrees/s, instead of a time"),
                        tr("Pause after the move in s"),
                        tr("Shape of the move over time; grey: the default of the file"),
                        tr("Messages of the compiler and of the check")};
  if (role == Qt::DisplayRole) return titles.at(static_cast<std::size_t>(section));
  if (role == Qt::ToolTipRole) return tips.at(static_cast<std::size_t>(section));
  return {};
}

QVariant StepModel::data(const QModelIndex& index, int role) const {
  const auto row = static_cast<std::size_t>(index.row());
  if (!index.isValid() || row >= cells_.size() || row >= editor_.rows().rows.size()) return {};
  const Cells& cells = cells_[row];
  const int column = index.column();
  if (role == Qt::DisplayRole) {
    const QString& text = cells.text.at(static_cast<std::size_t>(column));
    return column == kStep ? QString(4 * cells.depth, u' ') + text : text;
  }
  if (role == Qt::EditRole) return edit_value(editor_.rows().rows[row], column);
  if (role == Qt::DecorationRole) return decoration(cells, column);
  if (role == Qt::ToolTipRole) return tooltip(row, column);
  if (role == Qt::TextAlignmentRole && column >= kStart && column <= kPause)
    return int(Qt::AlignRight | Qt::AlignVCenter);
  const bool is_dim = column == kStart || (column == kInterpolation && cells.inherits_interpolation);
  if (role == Qt::ForegroundRole && is_dim) return dim_;
  return {};
}

QVariant StepModel::decoration(const Cells& cells, int column) const {
  if (column == kStep) return kind_icons_.at(static_cast<std::size_t>(cells.kind));
  if (column == kFinding && cells.severity >= 0)
    return severity_icons_.at(static_cast<std::size_t>(cells.severity));
  return {};
}

QString StepModel::tooltip(std::size_t row, int column) const {
  const MotionRow& step = editor_.rows().rows[row];
  if (column == kFinding || (column == kStep && !cells_[row].findings.isEmpty())) return cells_[row].findings;
  if (column == kStep)
    return step.pose_uses > 1 ? tr("Line %1. The pose %2 is used %3 times.")
                                    .arg(step.line)
                                    .arg(QString::fromStdString(step.pose))
                                    .arg(step.pose_uses)
                              : tr("Line %1").arg(step.line);
  if (column == kStart)
    return tr("from %1 s to %2 s").arg(number(step.start_s, 3), number(step.start_s + step.duration_s, 3));
  return is_editable(row, static_cast<Column>(column))
             ? headerData(column, Qt::Horizontal, Qt::ToolTipRole).toString()
             : QString();
}

// --- Edits

bool StepModel::is_editable(std::size_t row, Column column) const {
  const MotionRow& step = editor_.rows().rows[row];
  const bool is_move = step.kind == Kind::kMove;
  switch (column) {
    case kStep:
      return !step_value(step).key.empty();
    case kTime:
      return is_move || step.time_s.has_value();
    case kSpeed:
    case kPause:
    case kInterpolation:
      return is_move;
    default:
      return false;
  }
}

Qt::ItemFlags StepModel::flags(const QModelIndex& index) const {
  if (!index.isValid()) return Qt::ItemIsDropEnabled;  // between the rows
  Qt::ItemFlags flags = Qt::ItemIsSelectable | Qt::ItemIsEnabled | Qt::ItemIsDragEnabled;
  const auto row = static_cast<std::size_t>(index.row());
  if (index.isValid() && row < editor_.rows().rows.size() &&
      is_editable(row, static_cast<Column>(index.column())))
    flags |= Qt::ItemIsEditable;
  return flags;
}

StepModel::StepValue StepModel::step_value(const MotionRow& row) const {
  const YamlNode* const tree = editor_.document().tree();
  const YamlNode* const step = tree != nullptr ? find_node(*tree, row.path) : nullptr;
  if (step == nullptr) return {};
  const YamlNode* const loop = step->find("loop");
  for (const char* const key : {"times", "until", "while"}) {
    const YamlNode* const value = loop != nullptr ? loop->find(key) : nullptr;
    if (value != nullptr && value->kind == YamlNode::Kind::kScalar)
      return {std::string("loop.") + key, value->scalar};
  }
  for (const char* const key : {"pose", "label", "jump", "call", "if"}) {
    const YamlNode* const value = step->find(key);
    if (value != nullptr && value->kind == YamlNode::Kind::kScalar) return {key, value->scalar};
  }
  for (const char* const key : {"expect", "mix", "set", "wait", "stiffness", "gain", "lean", "fail"}) {
    if (const YamlNode* const value = step->find(key))
      return {key, flow_text(*value), value->kind != YamlNode::Kind::kScalar};
  }
  return {};
}

QVariant StepModel::edit_value(const MotionRow& row, int column) const {
  switch (column) {
    case kStep:
      if (row.times) return *row.times;
      return QString::fromStdString(step_value(row).text);
    case kTime:
      return row.time_s ? *row.time_s : row.duration_s - row.pause_s;
    case kSpeed:
      return row.speed_deg_per_s.value_or(0.0);
    case kPause:
      return row.pause_s;
    case kInterpolation:
      return row.own_interpolation ? static_cast<int>(row.interpolation) : -1;
    default:
      return {};
  }
}

std::vector<std::size_t> StepModel::concerned(std::size_t row, Column column) const {
  std::vector<std::size_t> rows;
  if (selected_ && column != kStep) rows = selected_();
  if (std::ranges::find(rows, row) == rows.end()) return {row};
  std::erase_if(rows, [&](std::size_t other) { return !is_editable(other, column); });
  return rows;
}

void StepModel::apply(MotionDocument& document, const std::vector<std::size_t>& rows, int column,
                      const QVariant& value) const {
  const MotionRow& first = document.rows().rows[rows.front()];
  if (column == kTime) document.set_time(rows, value.toDouble());
  if (column == kSpeed) document.set_speed(rows, value.toDouble());
  if (column == kPause) document.set_pause(rows, value.toDouble());
  if (column == kInterpolation) {
    std::optional<motion::Interpolation> wanted;
    if (value.toInt() >= 0) wanted = static_cast<motion::Interpolation>(value.toInt());
    document.set_interpolation(rows, wanted);
  }
  if (column != kStep) return;
  const std::string text = value.toString().toStdString();
  const StepValue present = step_value(first);
  document.set_value(rows.front(), YamlPath(present.key.c_str()),
                     present.is_flow || text.starts_with('{') || is_plain(text) ? text : yaml_scalar(text));
}

QStringList StepModel::mimeTypes() const { return {QString::fromLatin1(kRowsType)}; }

QMimeData* StepModel::mimeData(const QModelIndexList& indexes) const {
  std::set<int> rows;
  for (const QModelIndex& index : indexes) rows.insert(index.row());
  QByteArray bytes;
  for (const int row : rows) bytes += QByteArray::number(row) + ' ';
  auto* const data = new QMimeData;
  data->setData(QString::fromLatin1(kRowsType), bytes.trimmed());
  return data;
}

bool StepModel::canDropMimeData(const QMimeData* data, Qt::DropAction action, int /*row*/, int /*column*/,
                                const QModelIndex& /*parent*/) const {
  return action == Qt::MoveAction && data->hasFormat(QString::fromLatin1(kRowsType));
}

bool StepModel::dropMimeData(const QMimeData* data, Qt::DropAction action, int row, int column,
                             const QModelIndex& parent) {
  if (!canDropMimeData(data, action, row, column, parent)) return false;
  std::vector<std::size_t> rows;
  for (const QByteArray& number : data->data(QString::fromLatin1(kRowsType)).split(' '))
    rows.push_back(number.toUInt());
  if (row < 0) row = parent.isValid() ? parent.row() : rowCount();
  const StepPlace place = row < rowCount()
                              ? StepPlace{StepPlace::Kind::kBefore, static_cast<std::size_t>(row)}
                              : StepPlace{StepPlace::Kind::kEndOf, editor_.rows().sections.size() - 1};
  std::size_t first = 0;
  if (!editor_.edit([&](MotionDocument& document) { first = document.move_rows(rows, place); })) return false;
  Q_EMIT rows_dropped(first, rows.size());
  return true;
}

bool StepModel::setData(const QModelIndex& index, const QVariant& value, int role) {
  const auto row = static_cast<std::size_t>(index.row());
  const auto column = static_cast<Column>(index.column());
  if (role != Qt::EditRole || row >= editor_.rows().rows.size() || !is_editable(row, column)) return false;
  if (value == edit_value(editor_.rows().rows[row], column)) return true;
  const auto rows = concerned(row, column);
  return editor_.edit([&](MotionDocument& document) { apply(document, rows, column, value); });
}

}  // namespace koboshi::studio
