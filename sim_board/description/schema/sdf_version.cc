#include "sim_board/description/schema/sdf_version.h"

#include <array>

#include "base/text/text.h"

namespace koboshi::sim_board {
namespace {

// A key that a later version of SDF has replaced by an attribute.
struct OlderKey {
  const char* owner;  // the element that has the older key
  const char* key;
  bool is_attribute;
  int last_minor;           // of the last version with the older key, 1.last_minor
  const char* newer_owner;  // `owner` itself, or its child that has the newer attribute
  const char* newer;
};

// The conversions between SDF 1.5 and 1.9, as far as they concern keys that a robot may use.
constexpr OlderKey kPoseFrame{"pose", "frame", true, 6, "pose", "relative_to"};
constexpr OlderKey kAxisFrame{"axis", "use_parent_model_frame", false, 6, "xyz", "expressed_in"};
constexpr std::array kOlderKeys{kPoseFrame, kAxisFrame};

constexpr int kLatestMinor = 9;

// The minor number of the file's version; the latest one if the root does not state it as it should.
int minor_of(const XmlNode& node) {
  XmlNode root = node;
  while (const auto above = root.parent()) root = *above;
  const std::string version = root.find_attribute("version").value_or("");
  if (!version.starts_with("1.")) return kLatestMinor;
  return static_cast<int>(parse_integer(version.substr(2)).value_or(kLatestMinor));
}

bool has_newer(const XmlNode& owner, const OlderKey& key) {
  if (owner.name() == key.newer_owner) return owner.find_attribute(key.newer).has_value();
  const auto child = owner.find(key.newer_owner);
  return child && child->find_attribute(key.newer);
}

bool is_true(const std::string& text) {
  return text == "true" || text == "True" || text == "TRUE" || text == "1";
}

std::string attribute_of(const std::string& attribute, const std::string& element) {
  return attribute + " of <" + element + ">";
}

}  // namespace

std::vector<OlderKeyFault> find_older_key_faults(const XmlNode& owner) {
  std::vector<OlderKeyFault> faults;
  for (const OlderKey& key : kOlderKeys) {
    if (owner.name() != key.owner) continue;
    const auto child = key.is_attribute ? std::nullopt : owner.find(key.key);
    if (key.is_attribute ? !owner.find_attribute(key.key) : !child) continue;
    const XmlNode node = child.value_or(owner);
    const std::string attribute = key.is_attribute ? key.key : "";
    const std::string older =
        key.is_attribute ? attribute_of(key.key, key.owner) : "<" + std::string(key.key) + ">";
    const std::string newer = attribute_of(key.newer, key.newer_owner);
    if (const int minor = minor_of(owner); minor > key.last_minor) {
      faults.push_back({node, attribute, older + " in SDF 1." + std::to_string(minor), newer});
    } else if (has_newer(owner, key)) {
      faults.push_back({node, attribute, older + " beside " + newer, "one of the two"});
    }
  }
  return faults;
}

std::optional<FrameReference> find_pose_frame(const XmlNode& pose) {
  for (const char* key : {kPoseFrame.newer, kPoseFrame.key})
    if (const auto frame = pose.find_attribute(key)) return FrameReference{pose, key, *frame};
  return std::nullopt;
}

std::optional<FrameReference> find_axis_frame(const XmlNode& axis) {
  const XmlNode xyz = axis.child(kAxisFrame.newer_owner);
  if (const auto frame = xyz.find_attribute(kAxisFrame.newer))
    return FrameReference{xyz, kAxisFrame.newer, *frame};
  const auto older = axis.find(kAxisFrame.key);
  if (!older || !is_true(older->text())) return std::nullopt;
  return FrameReference{*older, "", kModelFrame};
}

}  // namespace koboshi::sim_board
