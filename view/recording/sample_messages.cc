#include "view/recording/sample_messages.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>
#include <cstring>

#include <foxglove.pb.h>
#include <google/protobuf/wire_format_lite.h>
#include <recording.pb.h>

namespace koboshi::view {
namespace {

namespace pb = google::protobuf;
using WireFormat = pb::internal::WireFormatLite;
using Transform = foxglove::FrameTransform;
using Byte = std::uint8_t;

// The tags of all fields below take one byte, and so do the lengths of the messages with fixed sizes.
constexpr std::size_t kDouble_bytes = 1 + sizeof(double);
constexpr std::size_t kFloat_bytes = 1 + sizeof(float);
constexpr std::size_t kVector_bytes = 3 * kDouble_bytes;
constexpr std::size_t kRotation_bytes = 4 * kDouble_bytes;
constexpr std::size_t kMaxVarint_bytes = 10;
constexpr std::size_t kMaxTime_bytes = 2 + 2 * (1 + kMaxVarint_bytes);
constexpr std::size_t kMaxContact_bytes = 2 + 2 * (1 + kMaxVarint_bytes) + 6 * kFloat_bytes;

Byte* put_head(int field, std::size_t size, Byte* out) {
  out = WireFormat::WriteTagToArray(field, WireFormat::WIRETYPE_LENGTH_DELIMITED, out);
  return WireFormat::WriteUInt32NoTagToArray(static_cast<std::uint32_t>(size), out);
}

// A message whose fields, numbered from 1, are doubles.
template <typename Values>
Byte* put_doubles(int field, const Values& values, Byte* out) {
  out = put_head(field, static_cast<std::size_t>(values.size()) * kDouble_bytes, out);
  int number = 0;
  for (const float value : values)
    out = WireFormat::WriteDoubleToArray(++number, static_cast<double>(value), out);
  return out;
}

Byte* put_text(const std::string& text, Byte* out) {
  std::memcpy(out, text.data(), text.size());
  return out + text.size();
}

// FrameTransform::timestamp.
std::string time_field(std::uint64_t time_us) {
  pb::Timestamp time;
  time.set_seconds(static_cast<std::int64_t>(time_us / 1'000'000));
  time.set_nanos(static_cast<std::int32_t>(time_us % 1'000'000 * 1000));
  const std::string content = time.SerializeAsString();
  std::array<Byte, kMaxTime_bytes> head;
  Byte* const end = put_head(Transform::kTimestampFieldNumber, content.size(), head.data());
  return std::string(head.data(), end) + content;
}

Byte* put_contact(const ContactForce& contact, Byte* out) {
  out = WireFormat::WriteSInt32ToArray(koboshi::Contact::kLinkFieldNumber, contact.link, out);
  out = WireFormat::WriteSInt32ToArray(koboshi::Contact::kOtherLinkFieldNumber, contact.other_link, out);
  int number = koboshi::Contact::kXMFieldNumber;
  for (const float value : contact.p_W_m) out = WireFormat::WriteFloatToArray(number++, value, out);
  for (const float value : contact.f_W_N) out = WireFormat::WriteFloatToArray(number++, value, out);
  return out;
}

Byte* bytes_of(std::string& text) { return reinterpret_cast<Byte*>(text.data()); }

}  // namespace

PoseMessages::PoseMessages(const std::string& parent_frame, std::span<const Link> links) {
  for (const Link& link : links) {
    Transform frames;
    frames.set_parent_frame_id(parent_frame);
    frames.set_child_frame_id(link.name);
    frames_.push_back(frames.SerializeAsString());
  }
}

void PoseMessages::append(std::uint64_t time_us, std::span<const Pose> links, std::string& data) const {
  assert(links.size() == frames_.size());
  const std::string time = time_field(time_us);
  const std::size_t fixed_bytes = time.size() + 2 + kVector_bytes + 2 + kRotation_bytes;
  const std::size_t before = data.size();
  std::size_t most_bytes = 0;
  for (const std::string& frames : frames_) most_bytes += 1 + kMaxVarint_bytes + fixed_bytes + frames.size();
  data.resize(before + most_bytes);
  Byte* out = bytes_of(data) + before;
  for (std::size_t i = 0; i < links.size(); ++i) {
    out = put_head(foxglove::FrameTransforms::kTransformsFieldNumber, fixed_bytes + frames_[i].size(), out);
    out = put_text(time, out);
    out = put_text(frames_[i], out);
    out = put_doubles(Transform::kTranslationFieldNumber, links[i].p_WL_m, out);
    out = put_doubles(Transform::kRotationFieldNumber, links[i].q_WL.coeffs(), out);
  }
  data.resize(static_cast<std::size_t>(out - bytes_of(data)));
}

void append_contacts(std::span<const ContactForce> contacts, std::string& data) {
  const std::size_t before = data.size();
  data.resize(before + contacts.size() * kMaxContact_bytes);
  Byte* out = bytes_of(data) + before;
  for (const ContactForce& contact : contacts) {
    std::array<Byte, kMaxContact_bytes> fields;
    Byte* const end = put_contact(contact, fields.data());
    out =
        put_head(koboshi::Contacts::kContactsFieldNumber, static_cast<std::size_t>(end - fields.data()), out);
    out = std::copy(fields.data(), end, out);
  }
  data.resize(static_cast<std::size_t>(out - bytes_of(data)));
}

}  // namespace koboshi::view
