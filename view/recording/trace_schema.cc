#include "view/recording/trace_schema.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>

#include <google/protobuf/descriptor.pb.h>
#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/wire_format_lite.h>
#include <nlohmann/json.hpp>

namespace koboshi::view {
namespace {

namespace pb = google::protobuf;
using WireFormat = pb::internal::WireFormatLite;

// Names of values are words, in Protobuf identifiers.
std::string identifier(const std::string& name) {
  std::string text;
  for (const char c : name) text += std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
  if (text.empty() || std::isdigit(static_cast<unsigned char>(text[0])) != 0) text = "_" + text;
  return text;
}

// The names of Protobuf's values are unique within the message around their enumeration, so each has a
// message of its own.
void add_enumeration(const Signal& signal, pb::DescriptorProto& message) {
  pb::DescriptorProto& scope = *message.add_nested_type();
  scope.set_name(field_name(signal) + "_of");
  pb::EnumDescriptorProto& enumeration = *scope.add_enum_type();
  enumeration.set_name("Value");
  const auto add = [&](const std::string& name, std::int64_t number) {
    pb::EnumValueDescriptorProto& value = *enumeration.add_value();
    value.set_name(name);
    value.set_number(static_cast<std::int32_t>(number));
  };
  // The first value of an enumeration must be zero.
  const auto zero = std::ranges::find(signal.names, 0, &std::pair<std::int64_t, std::string>::first);
  add(zero == signal.names.end() ? "_0" : identifier(zero->second), 0);
  for (const auto& [number, name] : signal.names)
    if (number != 0) add(identifier(name), number);
}

std::uint32_t tag_of(std::size_t signal, WireFormat::WireType type) {
  return WireFormat::MakeTag(static_cast<int>(signal) + 1, type);
}

}  // namespace

std::string field_name(const Signal& signal) {
  return signal.unit.empty() ? signal.name : signal.name + "_" + signal.unit;
}

std::string trace_schema(std::span<const Signal> signals) {
  pb::FileDescriptorSet set;
  pb::FileDescriptorProto& file = *set.add_file();
  file.set_name("koboshi/trace.proto");
  file.set_package("koboshi");
  file.set_syntax("proto3");
  pb::DescriptorProto& message = *file.add_message_type();
  message.set_name("Trace");
  int number = 0;
  for (const Signal& signal : signals) {
    pb::FieldDescriptorProto& field = *message.add_field();
    field.set_name(field_name(signal));
    field.set_number(++number);
    field.set_label(pb::FieldDescriptorProto::LABEL_OPTIONAL);
    if (signal.names.empty()) {
      field.set_type(pb::FieldDescriptorProto::TYPE_FLOAT);
      continue;
    }
    add_enumeration(signal, message);
    field.set_type(pb::FieldDescriptorProto::TYPE_ENUM);
    field.set_type_name("." + std::string(kTraceMessage) + "." + field_name(signal) + "_of.Value");
  }
  return set.SerializeAsString();
}

void append_trace(std::span<const Signal> signals, std::span<const float> values, std::string& data) {
  constexpr std::size_t kMaxField_bytes = 5 + 10;
  const std::size_t before = data.size();
  data.resize(before + kMaxField_bytes * signals.size());
  auto* const start = reinterpret_cast<std::uint8_t*>(data.data());
  std::uint8_t* end = start + before;
  for (std::size_t i = 0; i < signals.size(); ++i) {
    const float value = values[i];
    if (signals[i].names.empty()) {
      end = pb::io::CodedOutputStream::WriteTagToArray(tag_of(i, WireFormat::WIRETYPE_FIXED32), end);
      end = WireFormat::WriteFloatNoTagToArray(value, end);
    } else if (!std::isnan(value)) {
      end = pb::io::CodedOutputStream::WriteTagToArray(tag_of(i, WireFormat::WIRETYPE_VARINT), end);
      end = WireFormat::WriteInt32NoTagToArray(static_cast<std::int32_t>(value), end);
    }
  }
  data.resize(static_cast<std::size_t>(end - start));
}

std::vector<float> read_trace(std::span<const Signal> signals, std::string_view data) {
  std::vector<float> values(signals.size(), std::numeric_limits<float>::quiet_NaN());
  pb::io::CodedInputStream stream(reinterpret_cast<const std::uint8_t*>(data.data()),
                                  static_cast<int>(data.size()));
  while (const std::uint32_t tag = stream.ReadTag()) {
    const auto index = static_cast<std::size_t>(WireFormat::GetTagFieldNumber(tag)) - 1;
    float value = 0.0F;
    std::int32_t number = 0;
    if (index >= values.size()) {
      if (!WireFormat::SkipField(&stream, tag)) return {};
    } else if (tag == tag_of(index, WireFormat::WIRETYPE_FIXED32)) {
      if (!WireFormat::ReadPrimitive<float, WireFormat::TYPE_FLOAT>(&stream, &value)) return {};
      values[index] = value;
    } else if (tag == tag_of(index, WireFormat::WIRETYPE_VARINT)) {
      if (!WireFormat::ReadPrimitive<std::int32_t, WireFormat::TYPE_INT32>(&stream, &number)) return {};
      values[index] = static_cast<float>(number);
    } else {
      return {};
    }
  }
  if (!stream.ConsumedEntireMessage()) return {};
  return values;
}

std::string signals_json(std::span<const Signal> signals) {
  auto list = nlohmann::ordered_json::array();
  for (const Signal& signal : signals) {
    nlohmann::ordered_json entry{{"name", signal.name}};
    if (!signal.unit.empty()) entry["unit"] = signal.unit;
    if (!signal.names.empty()) entry["names"] = signal.names;
    list.push_back(std::move(entry));
  }
  return list.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

std::vector<Signal> signals_of_json(const std::string& text) {
  std::vector<Signal> signals;
  for (const nlohmann::json& entry : nlohmann::json::parse(text)) {
    Signal signal{.name = entry.at("name")};
    signal.unit = entry.value("unit", "");
    if (entry.contains("names")) entry.at("names").get_to(signal.names);
    signals.push_back(std::move(signal));
  }
  return signals;
}

}  // namespace koboshi::view
