#pragma once

#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <limits>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "lab/experiment/experiment.h"
#include "lab/experiment/statistics.h"

namespace koboshi::lab {

// A table of fields describes the struct of an experiment's trials once: which members it has, and how they
// are reported. From it the engine gets the metrics and the record of a trial, and conclusions get the struct
// back. A trial is default constructible and has a `std::string error`, which says what ended it.

template <typename V>
struct IsOptional : std::false_type {};
template <typename V>
struct IsOptional<std::optional<V>> : std::true_type {};

// A member as a number: an event is 0 or 1. Nothing if it is empty or not finite.
template <typename V>
std::optional<double> number_of(const V& value) {
  if constexpr (IsOptional<V>::value) {
    return value ? number_of(*value) : std::nullopt;
  } else {
    const double number = static_cast<double>(value);
    return std::isfinite(number) ? std::optional(number) : std::nullopt;
  }
}

// The reverse. A quantity without a number becomes NaN unless it is optional; everything else becomes 0.
template <typename V>
void assign_number(V& value, std::optional<double> number) {
  if constexpr (IsOptional<V>::value) {
    value.reset();
    if (number) assign_number(value.emplace(), number);
  } else if constexpr (std::floating_point<V>) {
    value = number.value_or(std::numeric_limits<double>::quiet_NaN());
  } else {
    value = static_cast<V>(number.value_or(0.0));
  }
}

// A metric and the member of a trial that it reports.
template <typename T>
struct Field {
  Metric metric;
  std::function<std::optional<double>(const T&)> get;
  std::function<void(T&, std::optional<double>)> set;

  // `path` leads from the trial to the member: a pointer to it, or pointers through members that are structs.
  // A bool is an event, anything else a quantity.
  template <typename... Path>
  requires(std::is_member_object_pointer_v<Path>&&...) Field(Metric reported, Path... path)
      : metric(std::move(reported)),
        get([path...](const T& trial) { return number_of((trial.*....*path)); }),
        set([path...](T& trial, std::optional<double> number) {
          assign_number((trial.*....*path), number);
        }) {
    using Member = std::remove_cvref_t<decltype((std::declval<T&>().*....*path))>;
    metric.is_event = std::same_as<Member, bool> || std::same_as<Member, std::optional<bool>>;
  }
  // A member that no pointer leads to.
  Field(Metric reported, decltype(get) getter, decltype(set) setter)
      : metric(std::move(reported)), get(std::move(getter)), set(std::move(setter)) {}
};

template <typename T>
using Fields = std::vector<Field<T>>;

template <typename T>
class FieldTable {
 public:
  // The fields of all groups, in their order. Throws std::logic_error if two have the same name.
  FieldTable(std::initializer_list<Fields<T>> groups) {
    std::set<std::string> names{"seed"};
    for (const Fields<T>& group : groups) {
      for (const Field<T>& field : group) {
        if (!names.insert(field.metric.name).second)
          throw std::logic_error("two fields of a trial are called " + field.metric.name);
        fields_.push_back(field);
      }
    }
  }

  std::vector<Metric> metrics() const {
    std::vector<Metric> metrics;
    for (const Field<T>& field : fields_) metrics.push_back(field.metric);
    return metrics;
  }

  Record record(const T& trial) const {
    Record record{.error = trial.error};
    for (const Field<T>& field : fields_) record.values.push_back(field.get(trial));
    return record;
  }

  T trial(const Record& record) const {
    T trial{};
    trial.error = record.error;
    for (std::size_t i = 0; i < fields_.size(); ++i) fields_[i].set(trial, record.values.at(i));
    return trial;
  }

  // The trials of a cell, in the order of seeds.
  std::vector<T> trials(const CellResult& cell) const {
    std::vector<T> trials;
    for (const Trial& played : cell.played) trials.push_back(trial(played.record));
    return trials;
  }

 private:
  Fields<T> fields_;
};

// Makes an experiment play and record trials of a type. `play` takes a cell, by number, and a seed.
template <typename T, typename Play>
void set_trials(Experiment& experiment, const FieldTable<T>& fields, Play play) {
  experiment.metrics = fields.metrics();
  experiment.play = [fields, play = std::move(play)](std::size_t cell, std::uint64_t seed) {
    return fields.record(play(cell, seed));
  };
}

// The values of a member in the trials that have one.
template <typename T, typename Member>
std::vector<double> values_of(const std::vector<T>& trials, Member member) {
  std::vector<double> values;
  for (const T& trial : trials) {
    if (const auto value = number_of(std::invoke(member, trial))) values.push_back(*value);
  }
  return values;
}

template <typename T, typename Member>
ShareEstimate share_of(const std::vector<T>& trials, Member event) {
  return estimate_share(values_of(trials, event));
}

template <typename T, typename Member>
MeanEstimate mean_of(const std::vector<T>& trials, Member quantity) {
  return estimate_mean(values_of(trials, quantity));
}

}  // namespace koboshi::lab
