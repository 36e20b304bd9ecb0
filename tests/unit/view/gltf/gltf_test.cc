#include "view/gltf/gltf.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>

#include "base/text/error.h"
#include "tests/support/sample_recording.h"
#include "tests/support/temporary_folder.h"

namespace koboshi::view {
namespace {

using Json = nlohmann::json;

std::uint32_t word(const std::string& bytes, std::size_t at) {
  std::uint32_t value = 0;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

// A GLB file, taken apart by the specification's rules for the container (chapter 4).
struct Parts {
  explicit Parts(const std::string& bytes) {
    EXPECT_EQ(bytes.substr(0, 4), "glTF");
    EXPECT_EQ(word(bytes, 4), 2u);
    EXPECT_EQ(word(bytes, 8), bytes.size());
    const std::size_t length = word(bytes, 12);
    EXPECT_EQ(length % 4, 0u);
    EXPECT_EQ(bytes.substr(16, 4), "JSON");
    json = Json::parse(bytes.substr(20, length));
    EXPECT_EQ(word(bytes, 20 + length) % 4, 0u);
    EXPECT_EQ(bytes.substr(24 + length, 4), std::string("BIN\0", 4));
    binary = bytes.substr(28 + length);
    EXPECT_EQ(binary.size(), word(bytes, 20 + length));
  }

  template <typename Value>
  std::vector<Value> values(std::size_t accessor) const {
    const Json& it = json.at("accessors").at(accessor);
    const Json& view = json.at("bufferViews").at(it.at("bufferView").get<std::size_t>());
    std::vector<Value> values(view.at("byteLength").get<std::size_t>() / sizeof(Value));
    std::memcpy(values.data(), binary.data() + view.at("byteOffset").get<std::size_t>(),
                values.size() * sizeof(Value));
    return values;
  }
  const Json& node(const std::string& name) const {
    for (const Json& node : json.at("nodes"))
      if (node.at("name") == name) return node;
    throw std::out_of_range(name);
  }

  Json json;
  std::string binary;
};

const Parts& sample() {
  static const Parts parts(gltf_of(test::sample_recording(50)));
  return parts;
}

TEST(Gltf, HasAccessorsThatFitTheirBuffer) {
  const Json& json = sample().json;
  const std::size_t length = json.at("buffers").at(0).at("byteLength");
  EXPECT_LE(length, sample().binary.size());
  EXPECT_LT(sample().binary.size() - length, 4u);
  const std::map<std::string, std::size_t> components{{"SCALAR", 1}, {"VEC3", 3}, {"VEC4", 4}};
  for (const Json& accessor : json.at("accessors")) {
    const Json& view = json.at("bufferViews").at(accessor.at("bufferView").get<std::size_t>());
    EXPECT_EQ(view.at("byteOffset").get<std::size_t>() % 4, 0u);
    EXPECT_LE(view.at("byteOffset").get<std::size_t>() + view.at("byteLength").get<std::size_t>(), length);
    EXPECT_EQ(accessor.at("count").get<std::size_t>() * components.at(accessor.at("type")) * 4,
              view.at("byteLength"));
    EXPECT_GT(accessor.at("count"), 0);
  }
}

TEST(Gltf, HasEachNodeInOnePlaceOfTheTree) {
  const Json& nodes = sample().json.at("nodes");
  std::vector<int> parents(nodes.size(), 0);
  for (const Json& node : nodes)
    for (const int child : node.value("children", std::vector<int>{}))
      ++parents.at(static_cast<std::size_t>(child));
  EXPECT_EQ(parents[0], 0);
  for (std::size_t i = 1; i < parents.size(); ++i) EXPECT_EQ(parents[i], 1) << nodes[i];
  EXPECT_EQ(sample().json.at("scenes").at(0).at("nodes"), Json({0}));
}

TEST(Gltf, HasTrianglesWithinTheirVertices) {
  for (const Json& mesh : sample().json.at("meshes")) {
    const Json& part = mesh.at("primitives").at(0);
    const Json& position =
        sample().json.at("accessors").at(part.at("attributes").at("POSITION").get<std::size_t>());
    const auto points = sample().values<float>(part.at("attributes").at("POSITION"));
    for (std::size_t axis = 0; axis < 3; ++axis) {
      float low = points[axis];
      float high = points[axis];
      for (std::size_t i = axis; i < points.size(); i += 3) {
        low = std::min(low, points[i]);
        high = std::max(high, points[i]);
      }
      EXPECT_EQ(position.at("min").at(axis).get<float>(), low);
      EXPECT_EQ(position.at("max").at(axis).get<float>(), high);
    }
    const auto indices = sample().values<std::uint32_t>(part.at("indices"));
    EXPECT_EQ(indices.size() % 3, 0u);
    for (const std::uint32_t index : indices) EXPECT_LT(index, points.size() / 3);
    EXPECT_LT(part.at("material").get<std::size_t>(), sample().json.at("materials").size());
  }
}

// The triangles of a convex body around the origin turn counter-clockwise as seen from outside.
TEST(Gltf, HasBoxesWithTheirFacesOutside) {
  const Json& node = sample().node("body");
  const Json& part = sample().json.at("meshes").at(node.at("mesh").get<std::size_t>()).at("primitives").at(0);
  const auto points = sample().values<float>(part.at("attributes").at("POSITION"));
  const auto indices = sample().values<std::uint32_t>(part.at("indices"));
  EXPECT_EQ(indices.size(), 36u);
  const auto point = [&](std::size_t i) { return Eigen::Vector3f(&points[3 * indices[i]]); };
  for (std::size_t i = 0; i < indices.size(); i += 3) {
    const Eigen::Vector3f normal = (point(i + 1) - point(i)).cross(point(i + 2) - point(i));
    EXPECT_GT(normal.dot(point(i)), 0.0F) << i;
  }
  EXPECT_EQ(node.at("scale"), Json({0.1, 0.08, 0.2}));
}

TEST(Gltf, MovesEveryLinkAtEverySample) {
  const Recording recording = test::sample_recording(50);
  const Json& animation = sample().json.at("animations").at(0);
  std::map<std::pair<std::string, std::string>, const Json*> samplers;
  for (const Json& channel : animation.at("channels")) {
    const Json& target = channel.at("target");
    const std::string name = sample().json.at("nodes").at(target.at("node").get<std::size_t>()).at("name");
    samplers[{name, target.at("path")}] =
        &animation.at("samplers").at(channel.at("sampler").get<std::size_t>());
  }
  ASSERT_EQ(samplers.size(), 4u);
  const Json& foot = *samplers.at({"left_foot", "translation"});
  EXPECT_EQ(foot.at("interpolation"), "LINEAR");
  const auto times_s = sample().values<float>(foot.at("input"));
  ASSERT_EQ(times_s.size(), 50u);
  EXPECT_FLOAT_EQ(times_s[0], 0.01F);
  EXPECT_FLOAT_EQ(times_s[49], 0.5F);
  const auto places = sample().values<float>(foot.at("output"));
  for (std::size_t i = 0; i < 50; ++i)
    EXPECT_EQ(Eigen::Vector3f(&places[3 * i]), recording.samples[i].links[1].p_WL_m);
  EXPECT_EQ(samplers.at({"trunk", "rotation"})->at("input"), foot.at("input"));
}

// glTF 2.0, 3.11: a rotation is x, y, z, w.
TEST(Gltf, WritesRotationsInTheOrderOfGltf) {
  Recording recording = test::sample_recording(3);
  const Eigen::Quaternionf turned(0.8F, 0.1F, 0.3F, std::sqrt(1.0F - 0.64F - 0.01F - 0.09F));
  recording.samples[1].links[1].q_WL = turned;
  const Parts parts(gltf_of(recording));
  const Json& animation = parts.json.at("animations").at(0);
  std::vector<std::vector<float>> second;  // rotations of the links in the second sample
  for (const Json& channel : animation.at("channels")) {
    if (channel.at("target").at("path") != "rotation") continue;
    const Json& sampler = animation.at("samplers").at(channel.at("sampler").get<std::size_t>());
    const auto values = parts.values<float>(sampler.at("output"));
    second.emplace_back(values.begin() + 4, values.begin() + 8);
  }
  EXPECT_TRUE(std::ranges::any_of(second, [&](const std::vector<float>& q) {
    return std::abs(turned.coeffs().dot(Eigen::Vector4f(q.data()))) > 0.999'999F;
  }));
}

// A quaternion and its negative are the same attitude, but the way between them is a full turn.
TEST(Gltf, TurnsTheShortWay) {
  Recording recording = test::sample_recording(3);
  recording.samples[1].links[0].q_WL.coeffs() *= -1.0F;
  const Parts parts(gltf_of(recording));
  for (const Json& channel : parts.json.at("animations").at(0).at("channels")) {
    if (channel.at("target").at("path") != "rotation") continue;
    const Json& sampler =
        parts.json.at("animations").at(0).at("samplers").at(channel.at("sampler").get<std::size_t>());
    const auto values = parts.values<float>(sampler.at("output"));
    for (std::size_t i = 4; i < values.size(); i += 4) {
      const Eigen::Vector4f q(&values[i]);
      EXPECT_GT(q.dot(Eigen::Vector4f(&values[i - 4])), 0.9F);
      EXPECT_NEAR(q.norm(), 1.0F, 1e-6F);
    }
  }
}

TEST(Gltf, TurnsTheWorldUpright) {
  const Json& world = sample().node("world");
  const auto q = world.at("rotation").get<std::vector<double>>();
  const Eigen::Vector3d up = Eigen::Quaterniond(q[3], q[0], q[1], q[2]) * Eigen::Vector3d::UnitZ();
  EXPECT_TRUE(up.isApprox(Eigen::Vector3d::UnitY()));
}

TEST(Gltf, TellsWhichRunItShows) {
  const Json& extras = sample().json.at("asset").at("extras");
  EXPECT_EQ(extras.at("title"), "sample");
  EXPECT_EQ(extras.at("seed"), 7);
  EXPECT_EQ(extras.at("stepper"), "lumped");
}

TEST(Gltf, ShowsAScene) {
  const Parts parts(gltf_of(test::sample_recording(0)));
  EXPECT_FALSE(parts.json.contains("animations"));
  EXPECT_NO_THROW(parts.node("trunk"));
}

TEST(Gltf, IsWrittenIntoGlbFilesOnly) {
  const test::TemporaryFolder folder;
  write_gltf(test::sample_recording(2), folder.path / "run.glb");
  EXPECT_EQ(test::read_file(folder.path / "run.glb"), gltf_of(test::sample_recording(2)));
  EXPECT_THROW(write_gltf(test::sample_recording(2), folder.path / "run.obj"), InputError);
}

}  // namespace
}  // namespace koboshi::view
