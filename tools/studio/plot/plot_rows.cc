#include "tools/studio/plot/plot_rows.h"

#include <algorithm>
#include <map>
#include <string>

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
  std::map<std::string, int> colours;
  int next = 0;
  for (Trace& trace : traces) {
    const std::vector<std::string> others = counterparts(trace.signal.name);
    trace.dashed = !others.empty();
    const auto shared = std::ranges::find_if(others, [&](const std::string& other) {
      return std::ranges::any_of(traces, [&](const Trace& one) { return one.signal.name == other; });
    });
    const std::string key = shared == others.end() ? trace.signal.name : *shared;
    const auto [entry, is_new] = colours.try_emplace(key, next);
    if (is_new) ++next;
    trace.colour = entry->second;
  }
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
