#include "view/replay/replay_data.h"

#include <fmt/core.h>

#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <tuple>

#include "bus/can/describe.h"
#include "bus/can/sdo_blocks.h"
#include "bus/dictionary/object_names.h"
#include "view/replay/column_pack.h"
#include "view/replay/first_difference.h"

namespace koboshi::view {
namespace {

using nlohmann::ordered_json;

ordered_json json_of(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

ordered_json json_of(const Eigen::Quaterniond& q) { return {q.x(), q.y(), q.z(), q.w()}; }

// #RRGGBB, as CSS has it.
std::string colour_text(const Colour& colour) {
  const auto byte = [](float share) { return static_cast<int>(std::lround(255.0F * share)); };
  return fmt::format("#{:02x}{:02x}{:02x}", byte(colour.red), byte(colour.green), byte(colour.blue));
}

template <typename Range, typename Get>
ordered_json integer_column(ColumnPack& pack, const Range& range, Get get) {
  std::vector<std::int64_t> values;
  values.reserve(range.size());
  for (const auto& element : range) values.push_back(static_cast<std::int64_t>(get(element)));
  return pack.integers(values);
}

template <typename Range, typename Get>
ordered_json number_column(ColumnPack& pack, const Range& range, double quantum, Get get) {
  std::vector<float> values;
  values.reserve(range.size());
  for (const auto& element : range) values.push_back(get(element));
  return pack.numbers(values, quantum);
}

// Columns of the three coordinates of a vector.
template <typename Range, typename Get>
ordered_json vector_columns(ColumnPack& pack, const Range& range, double quantum, Get get) {
  ordered_json columns;
  for (int axis = 0; axis < 3; ++axis) {
    columns.push_back(
        number_column(pack, range, quantum, [&](const auto& element) { return get(element)[axis]; }));
  }
  return columns;
}

// The columns of a page, and the meshes among them: equal ones, such as those of twenty servos or of two
// runs, are stored once.
class PagePack : public ColumnPack {
 public:
  const ordered_json& mesh(const Mesh& mesh) {
    for (const auto& [known, json] : meshes_) {
      if (known->vertices_m == mesh.vertices_m && known->triangles == mesh.triangles) return json;
    }
    return meshes_.emplace_back(&mesh, mesh_json(mesh)).second;
  }

 private:
  ordered_json mesh_json(const Mesh& mesh) {
    ordered_json corners;
    for (std::size_t i = 0; i < 3; ++i) {
      corners.push_back(
          integer_column(*this, mesh.triangles, [i](const auto& triangle) { return triangle[i]; }));
    }
    return {
        {"vertices", vector_columns(*this, mesh.vertices_m, kPositionQuantum_m,
                                    [](const Eigen::Vector3f& v) -> const Eigen::Vector3f& { return v; })},
        {"triangles", corners}};
  }

  std::vector<std::pair<const Mesh*, ordered_json>> meshes_;
};

ordered_json json_of(PagePack& pack, const Shape& shape) {
  ordered_json json = {{"name", shape.name},
                       {"position", json_of(Eigen::Vector3d(shape.X_LG.translation()))},
                       {"quaternion", json_of(Eigen::Quaterniond(shape.X_LG.linear()))},
                       {"colour", colour_text(shape.colour)}};
  if (const Box* box = std::get_if<Box>(&shape.geometry)) {
    json["box"] = json_of(box->size_m);
  } else {
    json["mesh"] = pack.mesh(std::get<Mesh>(shape.geometry));
  }
  return json;
}

ordered_json json_of(PagePack& pack, const std::vector<Shape>& shapes) {
  ordered_json list = ordered_json::array();
  for (const Shape& shape : shapes) list.push_back(json_of(pack, shape));
  return list;
}

ordered_json json_of(PagePack& pack, const Scene& scene) {
  ordered_json links = ordered_json::array();
  for (const Link& link : scene.links) {
    links.push_back({{"name", link.name},
                     {"mass", link.mass_kg},
                     {"visuals", json_of(pack, link.visuals)},
                     {"collisions", json_of(pack, link.collisions)}});
  }
  ordered_json planes = ordered_json::array();
  for (const Plane& plane : scene.planes)
    planes.push_back({{"normal", json_of(plane.normal_W)}, {"offset", plane.offset_m}});
  ordered_json soles = ordered_json::array();
  for (std::size_t side = 0; side < scene.soles_L.size(); ++side) {
    ordered_json corners = ordered_json::array();
    for (const Eigen::Vector3d& corner : scene.soles_L[side]) corners.push_back(json_of(corner));
    soles.push_back({{"link", scene.sole_links[side]}, {"corners", corners}});
  }
  return {{"robot", scene.robot},
          {"links", links},
          {"planes", planes},
          {"ground", json_of(pack, scene.ground)},
          {"soles", soles}};
}

// Quaternions of a link, with the signs that make consecutive ones close.
std::vector<Eigen::Vector4f> quaternions(const std::vector<Sample>& samples, std::size_t link) {
  std::vector<Eigen::Vector4f> result;
  for (const Sample& sample : samples) {
    Eigen::Vector4f q = sample.links[link].q_WL.coeffs();
    if (!result.empty() && q.dot(result.back()) < 0.0F) q = -q;
    result.push_back(q);
  }
  return result;
}

ordered_json poses_json(ColumnPack& pack, const Recording& recording) {
  ordered_json poses = ordered_json::array();
  for (std::size_t link = 0; link < recording.scene.links.size(); ++link) {
    const auto qs = quaternions(recording.samples, link);
    ordered_json columns;
    for (int i = 0; i < 4; ++i) {
      columns.push_back(number_column(pack, qs, kQuaternionQuantum, [i](const auto& q) { return q[i]; }));
    }
    poses.push_back({{"position", vector_columns(pack, recording.samples, kPositionQuantum_m,
                                                 [link](const Sample& s) { return s.links[link].p_WL_m; })},
                     {"quaternion", columns}});
  }
  return poses;
}

ordered_json contacts_json(ColumnPack& pack, const std::vector<Sample>& samples) {
  std::vector<ContactForce> contacts;
  for (const Sample& sample : samples)
    contacts.insert(contacts.end(), sample.contacts.begin(), sample.contacts.end());
  return {{"counts", integer_column(pack, samples, [](const Sample& s) { return s.contacts.size(); })},
          {"link", integer_column(pack, contacts, [](const ContactForce& c) { return c.link; })},
          {"other_link", integer_column(pack, contacts, [](const ContactForce& c) { return c.other_link; })},
          {"position", vector_columns(pack, contacts, 10 * kPositionQuantum_m,
                                      [](const ContactForce& c) { return c.p_W_m; })},
          {"force",
           vector_columns(pack, contacts, kForceQuantum_N, [](const ContactForce& c) { return c.f_W_N; })}};
}

template <typename Names>
ordered_json names_json(const Names& names) {
  ordered_json list = ordered_json::array();
  for (const auto& [value, name] : names) list.push_back({value, name});
  return list;
}

ordered_json signals_json(ColumnPack& pack, const Recording& recording) {
  ordered_json signals = ordered_json::array();
  std::vector<float> values(recording.samples.size());
  for (std::size_t i = 0; i < recording.signals.size(); ++i) {
    const Signal& signal = recording.signals[i];
    std::ranges::transform(recording.samples, values.begin(), [i](const Sample& s) { return s.values[i]; });
    signals.push_back({{"name", signal.name},
                       {"unit", signal.unit},
                       {"names", names_json(signal.names)},
                       {"values", pack.numbers(values, plot_quantum(values))}});
  }
  return signals;
}

// Frames that share identifier, length and kind of request, in order of time.
struct FrameGroup {
  std::vector<const hal::CanFrame*> frames;
  std::size_t index = 0;
};
using FrameKey = std::tuple<std::uint16_t, std::uint8_t, bool>;

// Texts that many frames share, each stored once.
class Texts {
 public:
  std::size_t index_of(const std::string& text) {
    const auto [place, added] = indices_.try_emplace(text, list_.size());
    if (added) list_.push_back(text);
    return place->second;
  }
  const std::vector<std::string>& list() const { return list_; }

 private:
  std::map<std::string, std::size_t> indices_;
  std::vector<std::string> list_;
};

// `segments`: the frames that are segments of SDO blocks.
ordered_json group_json(ColumnPack& pack, const FrameGroup& group, const bus::ObjectNames& names,
                        const std::set<const hal::CanFrame*>& segments, Texts& texts) {
  const hal::CanFrame& first = *group.frames.front();
  const bus::FrameKind kind = bus::kind_of(first);
  ordered_json bytes = ordered_json::array();
  for (std::size_t i = 0; i < first.size && !first.remote; ++i) {
    bytes.push_back(integer_column(pack, group.frames, [i](const auto* frame) { return frame->data[i]; }));
  }
  ordered_json json = {{"identifier", first.identifier}, {"size", first.size},
                       {"remote", first.remote},         {"kind", kind_text(kind)},
                       {"node", bus::node_of(first)},    {"bytes", bytes}};
  if (kind != bus::FrameKind::kPdo) {
    json["texts"] = integer_column(pack, group.frames, [&](const auto* frame) {
      return texts.index_of(bus::describe(*frame, names, segments.contains(frame)));
    });
  }
  return json;
}

ordered_json frames_json(ColumnPack& pack, const std::vector<Frame>& frames) {
  std::map<FrameKey, FrameGroup> groups;
  std::set<const hal::CanFrame*> segments;
  bus::SdoBlocks blocks;
  for (const Frame& one : frames) {
    const hal::CanFrame& frame = one.frame;
    if (blocks.follow(frame)) segments.insert(&frame);
    groups[{frame.identifier, frame.size, frame.remote}].frames.push_back(&frame);
  }
  Texts texts;
  const bus::ObjectNames names = bus::object_names();
  ordered_json list = ordered_json::array();
  for (auto& [key, group] : groups) {
    group.index = list.size();
    list.push_back(group_json(pack, group, names, segments, texts));
  }
  return {{"times", integer_column(pack, frames, [](const Frame& frame) { return frame.end_us; })},
          {"group", integer_column(pack, frames,
                                   [&](const Frame& one) {
                                     const hal::CanFrame& frame = one.frame;
                                     return groups.at({frame.identifier, frame.size, frame.remote}).index;
                                   })},
          {"groups", list},
          {"texts", texts.list()}};
}

ordered_json json_of(const bus::Network& network) {
  ordered_json nodes = ordered_json::array();
  for (const bus::NetworkNode& node : network.nodes)
    nodes.push_back({{"id", node.node_id}, {"name", node.name}});
  ordered_json messages = ordered_json::array();
  for (const bus::Message& message : network.messages) {
    ordered_json signals = ordered_json::array();
    for (const bus::Signal& signal : message.signals) {
      ordered_json values = ordered_json::array();
      for (const canopen::ValueName& value : signal.values) values.push_back({value.value, value.name});
      signals.push_back({{"name", signal.name},
                         {"start", signal.start_bit},
                         {"size", signal.size_bits},
                         {"signed", signal.is_signed},
                         {"factor", signal.factor},
                         {"unit", signal.unit},
                         {"names", values}});
    }
    messages.push_back({{"identifier", message.identifier},
                        {"name", message.name},
                        {"sender", message.sender},
                        {"signals", signals}});
  }
  return {{"nodes", nodes}, {"messages", messages}};
}

ordered_json run_json(PagePack& pack, const Recording& recording) {
  ordered_json events = ordered_json::array();
  for (const Event& event : recording.events) events.push_back(event_json(event));
  ordered_json pushes = ordered_json::array();
  for (const Push& push : recording.pushes) pushes.push_back(push_json(push));
  return {{"title", recording.title},
          {"scenario", recording.scenario},
          {"seed", std::to_string(recording.seed)},  // JavaScript's numbers have 53 bits
          {"stepper", recording.stepper},
          {"version", recording.version},
          {"complete", recording.complete},
          {"scene", json_of(pack, recording.scene)},
          {"times", integer_column(pack, recording.samples, [](const Sample& s) { return s.time_us; })},
          {"poses", poses_json(pack, recording)},
          {"contacts", contacts_json(pack, recording.samples)},
          {"signals", signals_json(pack, recording)},
          {"events", events},
          {"pushes", pushes},
          {"frames", frames_json(pack, recording.frames)}};
}

}  // namespace

const char* kind_text(bus::FrameKind kind) {
  switch (kind) {
    case bus::FrameKind::kNmt:
      return "NMT";
    case bus::FrameKind::kSync:
      return "SYNC";
    case bus::FrameKind::kEmergency:
      return "EMCY";
    case bus::FrameKind::kTime:
      return "TIME";
    case bus::FrameKind::kPdo:
      return "PDO";
    case bus::FrameKind::kSdo:
      return "SDO";
    case bus::FrameKind::kHeartbeat:
      return "heartbeat";
    case bus::FrameKind::kLss:
      return "LSS";
    default:
      return "other";
  }
}

ordered_json event_json(const Event& event) {
  return {{"time", event.time_us}, {"kind", event.kind}, {"text", event.text}};
}

ordered_json push_json(const Push& push) {
  return {{"start", push.start_us},
          {"end", push.end_us},
          {"link", push.link},
          {"position", json_of(push.p_L_m)},
          {"force", json_of(push.f_W_N)}};
}

std::string replay_data(const Recording& recording, const Recording* other, const bus::Network& network) {
  PagePack pack;
  ordered_json header = {{"run", run_json(pack, recording)}, {"network", json_of(network)}};
  if (other != nullptr) {
    header["other"] = run_json(pack, *other);
    if (const auto difference = first_difference(recording, *other)) {
      header["first_difference"] = {{"time", difference->time_us}, {"text", difference->text}};
    }
  }
  const std::string json = header.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
  std::string data;
  for (int i = 0; i < 4; ++i) data += static_cast<char>(json.size() >> (8 * i) & 0xFF);
  return data + json + pack.bytes();
}

}  // namespace koboshi::view
