#include "view/gltf/gltf.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <map>
#include <optional>
#include <span>
#include <tuple>
#include <type_traits>

#include <nlohmann/json.hpp>

#include "base/file/output_file.h"
#include "base/text/error.h"
#include "base/text/foreign_text.h"
#include "base/text/text.h"
#include "mechanics/axes.h"

namespace koboshi::view {
namespace {

using Json = nlohmann::ordered_json;

// Constants of the specification.
constexpr int kFloat = 5126;
constexpr int kUnsignedInt = 5125;
constexpr int kArrayBuffer = 34962;
constexpr int kElementArrayBuffer = 34963;

constexpr double kPlaneMargin_m = 3.0;  // of the plane's square around the robot's path
constexpr Colour kPlaneColour{0.62F, 0.64F, 0.66F};
constexpr double kRoughness = 0.7;

// sRGB to linear, IEC 61966-2-1.
double linear(float part) {
  const auto value = static_cast<double>(part);
  return value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
}

Mesh unit_box() {
  Mesh mesh;
  for (const float z : {-0.5F, 0.5F})
    for (const auto& [x, y] : {std::pair{-0.5F, -0.5F}, {0.5F, -0.5F}, {0.5F, 0.5F}, {-0.5F, 0.5F}})
      mesh.vertices_m.emplace_back(x, y, z);
  for (const auto& [a, b, c, d] : {std::tuple{0U, 3U, 2U, 1U},
                                   {4U, 5U, 6U, 7U},
                                   {0U, 1U, 5U, 4U},
                                   {1U, 2U, 6U, 5U},
                                   {2U, 3U, 7U, 6U},
                                   {3U, 0U, 4U, 7U}}) {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a, c, d});
  }
  return mesh;
}

Json vector_json(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

Json rotation_json(const Eigen::Quaterniond& q) { return {q.x(), q.y(), q.z(), q.w()}; }

class Document {
 public:
  explicit Document(const Recording& recording) : recording_(recording) {}

  std::string glb() {
    json_["asset"] = {{"version", "2.0"},
                      {"generator", "koboshi " + recording_.version},
                      {"extras",
                       {{"title", recording_.title},
                        {"robot", recording_.scene.robot},
                        {"scenario", recording_.scenario},
                        {"seed", recording_.seed},
                        {"stepper", recording_.stepper},
                        {"version", recording_.version}}}};
    json_["scene"] = 0;
    json_["scenes"] = {{{"name", recording_.title}, {"nodes", {0}}}};
    // A quarter turn about x brings z up to y up.
    nodes_.push_back({{"name", "world"}, {"rotation", {-std::sqrt(0.5), 0.0, 0.0, std::sqrt(0.5)}}});
    add_ground();
    for (std::size_t i = 0; i < recording_.scene.links.size(); ++i) add_link(i);
    Json& children = nodes_[0]["children"];
    for (int node = 1; node < static_cast<int>(nodes_.size()); ++node)
      if (!is_shape(node)) children.push_back(node);
    json_["nodes"] = nodes_;
    if (!meshes_.empty()) json_["meshes"] = meshes_;
    if (!materials_.empty()) json_["materials"] = materials_;
    add_animation();
    if (!accessors_.empty()) {
      json_["accessors"] = accessors_;
      json_["bufferViews"] = views_;
      json_["buffers"] = {{{"byteLength", binary_.size()}}};
    }
    return container();
  }

 private:
  bool is_shape(int node) const { return std::ranges::binary_search(shape_nodes_, node); }

  // Header and the two chunks, each padded to four bytes.
  std::string container() {
    // Texts of the run may hold bytes that are no UTF-8.
    std::string text = json_.dump(-1, ' ', false, Json::error_handler_t::replace);
    text.resize((text.size() + 3) / 4 * 4, ' ');
    binary_.resize((binary_.size() + 3) / 4 * 4, '\0');
    const std::size_t binary_chunk = binary_.empty() ? 0 : 8 + binary_.size();
    std::string bytes;
    const auto word = [&bytes](std::size_t value) {
      const auto part = std::bit_cast<std::array<char, 4>>(static_cast<std::uint32_t>(value));
      bytes.append(part.data(), part.size());
    };
    bytes += "glTF";
    word(2);
    word(12 + 8 + text.size() + binary_chunk);
    word(text.size());
    bytes += "JSON";
    bytes += text;
    if (binary_.empty()) return bytes;
    word(binary_.size());
    bytes += std::string_view("BIN\0", 4);
    return bytes += binary_;
  }

  // Adds an accessor of `count` elements to values in the buffer; returns its index.
  template <typename Value>
  int add_accessor(std::span<const Value> values, const char* type, std::size_t count,
                   std::optional<int> target = {}) {
    Json view{{"buffer", 0}, {"byteOffset", binary_.size()}, {"byteLength", values.size_bytes()}};
    if (target) view["target"] = *target;
    views_.push_back(std::move(view));
    const auto bytes = std::as_bytes(values);
    binary_.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    accessors_.push_back({{"bufferView", views_.size() - 1},
                          {"componentType", std::is_same_v<Value, float> ? kFloat : kUnsignedInt},
                          {"count", count},
                          {"type", type}});
    return static_cast<int>(accessors_.size()) - 1;
  }

  int material_of(const Colour& colour) {
    const auto [place, is_new] =
        materials_by_colour_.try_emplace({colour.red, colour.green, colour.blue}, materials_.size());
    if (is_new) {
      materials_.push_back(
          {{"pbrMetallicRoughness",
            {{"baseColorFactor", {linear(colour.red), linear(colour.green), linear(colour.blue), 1.0}},
             {"metallicFactor", 0.0},
             {"roughnessFactor", kRoughness}}}});
    }
    return static_cast<int>(place->second);
  }

  int add_mesh(const std::string& name, const Mesh& mesh, const Colour& colour) {
    std::vector<float> points;
    Eigen::Array3f low = mesh.vertices_m.front();
    Eigen::Array3f high = low;
    for (const Eigen::Vector3f& vertex : mesh.vertices_m) {
      points.insert(points.end(), vertex.begin(), vertex.end());
      low = low.min(vertex.array());
      high = high.max(vertex.array());
    }
    std::vector<std::uint32_t> indices;
    for (const auto& triangle : mesh.triangles)
      indices.insert(indices.end(), triangle.begin(), triangle.end());
    const int position = add_accessor<float>(points, "VEC3", mesh.vertices_m.size(), kArrayBuffer);
    accessors_[static_cast<std::size_t>(position)]["min"] = {low.x(), low.y(), low.z()};
    accessors_[static_cast<std::size_t>(position)]["max"] = {high.x(), high.y(), high.z()};
    const int index = add_accessor<std::uint32_t>(indices, "SCALAR", indices.size(), kElementArrayBuffer);
    meshes_.push_back({{"name", name},
                       {"primitives",
                        {{{"attributes", {{"POSITION", position}}},
                          {"indices", index},
                          {"material", material_of(colour)}}}}});
    return static_cast<int>(meshes_.size()) - 1;
  }

  // All boxes of a colour share a mesh.
  int box_mesh(const Colour& colour) {
    const auto key = std::tuple{colour.red, colour.green, colour.blue};
    const auto found = box_meshes_.find(key);
    if (found != box_meshes_.end()) return found->second;
    return box_meshes_[key] = add_mesh("box", unit_box(), colour);
  }

  // Returns the node's index; nothing for a mesh without triangles, which glTF does not know.
  std::optional<int> add_shape(const Shape& shape) {
    const auto* mesh = std::get_if<Mesh>(&shape.geometry);
    if (mesh != nullptr && mesh->triangles.empty()) return {};
    if (mesh != nullptr && !std::ranges::all_of(mesh->vertices_m, [](const Eigen::Vector3f& vertex) {
          return vertex.allFinite();
        }))
      throw InputError(recording_.title, 0,
                       "the mesh " + one_line(shape.name) + " with a vertex that is no finite number",
                       "finite numbers, as glTF permits no others");
    Json node{{"name", shape.name},
              {"translation", vector_json(shape.X_LG.translation())},
              {"rotation", rotation_json(Eigen::Quaterniond(shape.X_LG.linear()).normalized())}};
    if (mesh != nullptr) {
      node["mesh"] = add_mesh(shape.name, *mesh, shape.colour);
    } else {
      node["scale"] = vector_json(std::get<Box>(shape.geometry).size_m);
      node["mesh"] = box_mesh(shape.colour);
    }
    nodes_.push_back(std::move(node));
    shape_nodes_.push_back(static_cast<int>(nodes_.size()) - 1);
    return shape_nodes_.back();
  }

  // Adds a node with these shapes as its children; returns its index.
  int add_group(const std::string& name, std::span<const Shape> shapes) {
    const std::size_t group = nodes_.size();
    nodes_.push_back({{"name", name}});
    for (const Shape& shape : shapes)
      if (const auto node = add_shape(shape)) nodes_[group]["children"].push_back(*node);
    return static_cast<int>(group);
  }

  void add_ground() {
    std::vector<Shape> shapes = recording_.scene.ground;
    for (const Plane& plane : recording_.scene.planes) shapes.push_back(square(plane));
    add_group("ground", shapes);
  }

  // A square of the plane around the trunk's path, seen from its upper side.
  Shape square(const Plane& plane) const {
    Eigen::AlignedBox3d path;
    for (const Sample& sample : recording_.samples)
      if (!sample.links.empty()) path.extend(sample.links[0].p_WL_m.cast<double>());
    if (path.isEmpty()) path.extend(Eigen::Vector3d(Eigen::Vector3d::Zero()));
    const double side_m = path.sizes().maxCoeff() + 2.0 * kPlaneMargin_m;
    Shape shape{.name = "plane", .colour = kPlaneColour};
    shape.X_LG.linear() = mechanics::rotation_to_normal(plane.normal_W);
    const Eigen::Vector3d centre = path.center();
    shape.X_LG.translation() = centre - plane.normal_W * (plane.normal_W.dot(centre) - plane.offset_m);
    const auto half_m = static_cast<float>(0.5 * side_m);
    shape.geometry = Mesh{
        {{-half_m, -half_m, 0.0F}, {half_m, -half_m, 0.0F}, {half_m, half_m, 0.0F}, {-half_m, half_m, 0.0F}},
        {{0, 1, 2}, {0, 2, 3}}};
    return shape;
  }

  void add_link(std::size_t index) {
    const Link& link = recording_.scene.links[index];
    const int node = add_group(link.name, link.visuals.empty() ? link.collisions : link.visuals);
    link_nodes_.push_back(node);
    if (recording_.samples.empty()) return;
    const Pose& pose = recording_.samples.front().links[index];
    nodes_[static_cast<std::size_t>(node)]["translation"] = vector_json(pose.p_WL_m.cast<double>());
    nodes_[static_cast<std::size_t>(node)]["rotation"] = rotation_json(pose.q_WL.cast<double>().normalized());
  }

  void add_animation() {
    if (recording_.samples.empty() || link_nodes_.empty()) return;
    std::vector<float> times_s;
    for (const Sample& sample : recording_.samples)
      times_s.push_back(static_cast<float>(1e-6 * static_cast<double>(sample.time_us)));
    const int input = add_accessor<float>(times_s, "SCALAR", times_s.size());
    accessors_[static_cast<std::size_t>(input)]["min"] = {times_s.front()};
    accessors_[static_cast<std::size_t>(input)]["max"] = {times_s.back()};
    Json channels;
    Json samplers;
    const auto add_channel = [&](int output, int node, const char* path) {
      samplers.push_back({{"input", input}, {"interpolation", "LINEAR"}, {"output", output}});
      channels.push_back({{"sampler", samplers.size() - 1}, {"target", {{"node", node}, {"path", path}}}});
    };
    for (std::size_t link = 0; link < link_nodes_.size(); ++link) {
      add_channel(add_translations(link), link_nodes_[link], "translation");
      add_channel(add_rotations(link), link_nodes_[link], "rotation");
    }
    json_["animations"] = {{{"name", recording_.title}, {"channels", channels}, {"samplers", samplers}}};
  }

  int add_translations(std::size_t link) {
    std::vector<float> values;
    for (const Sample& sample : recording_.samples)
      values.insert(values.end(), sample.links[link].p_WL_m.begin(), sample.links[link].p_WL_m.end());
    return add_accessor<float>(values, "VEC3", recording_.samples.size());
  }

  // Chooses, of a rotation's two quaternions, the one next to its predecessor: the interpolation then takes
  // the short way.
  int add_rotations(std::size_t link) {
    std::vector<float> values;
    Eigen::Vector4f last = recording_.samples.front().links[link].q_WL.coeffs();
    for (const Sample& sample : recording_.samples) {
      Eigen::Vector4f q = sample.links[link].q_WL.normalized().coeffs();
      if (q.dot(last) < 0.0F) q = -q;
      values.insert(values.end(), q.begin(), q.end());
      last = q;
    }
    return add_accessor<float>(values, "VEC4", recording_.samples.size());
  }

  const Recording& recording_;
  Json json_;
  std::vector<Json> nodes_;
  std::vector<int> shape_nodes_;  // ascending
  std::vector<int> link_nodes_;   // by link
  std::vector<Json> meshes_;
  std::vector<Json> materials_;
  std::vector<Json> accessors_;
  std::vector<Json> views_;
  std::map<std::tuple<float, float, float>, std::size_t> materials_by_colour_;
  std::map<std::tuple<float, float, float>, int> box_meshes_;
  std::string binary_;
};

}  // namespace

std::string gltf_of(const Recording& recording) { return Document(recording).glb(); }

void write_gltf(const Recording& recording, const std::filesystem::path& file) {
  if (extension_of(file) != ".glb")
    throw InputError("--gltf", 0, file.string(), "a file whose name ends in .glb");
  write_whole_file(file, gltf_of(recording));
}

}  // namespace koboshi::view
