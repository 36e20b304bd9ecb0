#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "view/recording/recording.h"

namespace koboshi::view {

// The Protobuf schema of /trace, made for the signals of a recording: a message with one field for each
// signal, numbered from 1 in their order. A signal with names is an enumeration, any other a float. The
// message is called koboshi.Trace.

inline constexpr const char* kTraceMessage = "koboshi.Trace";

// Name of a signal's field, as the column's title in trace.csv: left_knee_true_rad.
std::string field_name(const Signal& signal);

// A serialised FileDescriptorSet.
std::string trace_schema(std::span<const Signal> signals);

// Appends the message with one value per signal to `data`. NaN: a float without value, or an enumeration's
// field that is absent.
void append_trace(std::span<const Signal> signals, std::span<const float> values, std::string& data);
// Reads a message; NaN for absent fields. Returns an empty vector for data that are no message.
std::vector<float> read_trace(std::span<const Signal> signals, std::string_view data);

// The signals as JSON, kept as the channel's metadata under "signals": what a Protobuf schema cannot say.
std::string signals_json(std::span<const Signal> signals);
// Throws nlohmann::json::exception.
std::vector<Signal> signals_of_json(const std::string& text);

}  // namespace koboshi::view
