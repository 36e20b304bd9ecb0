#include "studio/plot/plot_rows.h"

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace koboshi::studio {
namespace {

constexpr std::size_t kFirstSignals = 3;

// The signals with which a commanded or planned signal may share its colour, the best first.
std::vector<std::string> counterparts(const std::string& name) {
  constexpr std::string_view kTarget = "_target";
  constexpr std::string_view kPlanned = "planned_";
  if (name.ends_with(kTarget)) {
    const std::string stem = name.substr(0, name.size() - kTarget.size());
    return {stem + "_true", stem + "_encoder"};
  }
  if (name.starts_with(kPlanned)) {
    const std::string stem = name.substr(kPlanned.size());
    return {"true_" + stem, stem};
  }
  return {};
}

// Places in trace_colours().
enum Place { kBlue, kOrange, kGreen, kPurple, kGrey = 7 };

std::optional<int> colour_of_role(std::string_view name) {
  constexpr std::pair<std::string_view, Place> kRoles[] = {
      {"planned_zmp_", kOrange}, {"true_zmp_", kGrey}, {"zmp_", kBlue}};
  if (!name.ends_with("_x") && !name.ends_with("_y")) return std::nullopt;
  for (const auto& [role, place] : kRoles)
    if (name.substr(0, name.size() - 1) == role) return place;
  return std::nullopt;
}

// Whether one name is that of the other side's quantity.
bool is_mirrored(const std::string& left, const std::string& right) {
  const std::size_t at = left.find("left_");
  return at != std::string::npos && std::string(left).replace(at, 5, "right_") == right;
}

// Colours of quantities by name, in their order.
std::map<std::string, int> colours_of(const std::vector<std::string>& names) {
  std::map<std::string, int> colours;
  if (names.size() == 2) {
    const bool left_first = is_mirrored(names[0], names[1]);
    if (left_first || is_mirrored(names[1], names[0]))
      return {{names[0], left_first ? kGreen : kPurple}, {names[1], left_first ? kPurple : kGreen}};
  }
  int next = 0;
  for (const std::string& name : names) colours[name] = colour_of_role(name).value_or(next++);
  return colours;
}

}  // namespace

PlotRows default_rows(const RunSamples& samples) {
  const PlotRows wanted{
      {QStringLiteral("left_hip_pitch_target"), QStringLiteral("left_hip_pitch_true"),
       QStringLiteral("left_knee_target"), QStringLiteral("left_knee_true"),
       QStringLiteral("left_ankle_pitch_target"), QStringLiteral("left_ankle_pitch_true")},
      {QStringLiteral("true_pitch"), QStringLiteral("true_roll")},
      {QStringLiteral("planned_zmp_y"), QStringLiteral("true_zmp_y"), QStringLiteral("zmp_y")},
  };
  PlotRows rows;
  for (const QStringList& row : wanted) {
    QStringList known;
    for (const QString& name : row)
      if (samples.has(name)) known << name;
    if (!known.isEmpty()) rows.push_back(known);
  }
  if (!rows.empty()) return rows;
  for (const view::Signal& signal :
       samples.signals().first(std::min(kFirstSignals, samples.signals().size())))
    rows.push_back({QString::fromStdString(signal.name)});
  return rows;
}

std::vector<Trace> traces_of(const RunSamples& samples, const QStringList& names) {
  std::vector<Trace> traces;
  for (const QString& name : names) {
    const auto index = samples.index_of(name.toStdString());
    if (!index) continue;
    traces.push_back(
        {.signal = samples.signals()[*index], .times = samples.times(), .values = samples.values(*index)});
  }
  std::vector<std::string> quantities;  // by trace
  for (Trace& trace : traces) {
    const std::vector<std::string> others = counterparts(trace.signal.name);
    trace.dashed = !others.empty();
    const auto shared = std::ranges::find_if(others, [&](const std::string& other) {
      return !colour_of_role(trace.signal.name) &&
             std::ranges::any_of(traces, [&](const Trace& one) { return one.signal.name == other; });
    });
    quantities.push_back(shared == others.end() ? trace.signal.name : *shared);
  }
  std::vector<std::string> distinct;
  for (const std::string& quantity : quantities)
    if (std::ranges::find(distinct, quantity) == distinct.end()) distinct.push_back(quantity);
  const std::map<std::string, int> colours = colours_of(distinct);
  for (std::size_t i = 0; i < traces.size(); ++i) traces[i].colour = colours.at(quantities[i]);
  return traces;
}

QVariant rows_to_variant(const PlotRows& rows) {
  QVariantList list;
  for (const QStringList& row : rows) list << QVariant(row);
  return list;
}

PlotRows rows_of_variant(const QVariant& variant) {
  PlotRows rows;
  const QVariantList list = variant.toList();
  for (const QVariant& row : list)
    if (const QStringList names = row.toStringList(); !names.isEmpty()) rows.push_back(names);
  return rows;
}

}  // namespace koboshi::studio
