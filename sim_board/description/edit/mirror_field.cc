// The value on the other side of a robot.

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

#include "base/text/error.h"
#include "base/text/text.h"
#include "sim_board/description/edit/robot_text.h"

namespace koboshi::sim_board {
namespace {

// The effect of a mirror image in the plane y = 0 on a value.
enum class Image {
  kSame,
  kVector,    // x, -y, z
  kAxis,      // of a joint, or a rotation: -x, y, -z; a joint may turn the other way
  kPose,      // position, then rotation
  kNegative,  // products of inertia with y
  kLimit,     // of a joint: that of the other end if it turns the other way
  kZero,      // angle of a drive's shaft
  kSign,      // direction of a drive's shaft
  kName,      // of a link, joint or frame
  kNone       // each has its own
};

struct ImageOf {
  std::string_view last_word;
  Image image;
};
constexpr std::array kImages = {
    ImageOf{"pose", Image::kPose},          ImageOf{"position", Image::kVector},
    ImageOf{"rotation", Image::kAxis},      ImageOf{"fdir1", Image::kVector},
    ImageOf{"xyz", Image::kAxis},           ImageOf{"ixy", Image::kNegative},
    ImageOf{"iyz", Image::kNegative},       ImageOf{"lower", Image::kLimit},
    ImageOf{"upper", Image::kLimit},        ImageOf{"zero_rad", Image::kZero},
    ImageOf{"sign", Image::kSign},          ImageOf{"parent", Image::kName},
    ImageOf{"child", Image::kName},         ImageOf{"relative_to", Image::kName},
    ImageOf{"expressed_in", Image::kName},  ImageOf{"node_id", Image::kNone},
    ImageOf{"serial_number", Image::kNone}, ImageOf{"offset_rad", Image::kNone},
    ImageOf{"frame", Image::kName},         ImageOf{"attached_to", Image::kName},
};

Image image_of(const ModelField& field) {
  const auto found = std::ranges::find(kImages, field.last_word(), &ImageOf::last_word);
  return found == kImages.end() ? Image::kSame : found->image;
}

// The name of the other side, equal if the name has no side.
std::string other_name(const std::string& name) {
  constexpr std::string_view kLeft = "left_";
  constexpr std::string_view kRight = "right_";
  if (name.starts_with(kLeft)) return std::string(kRight) + name.substr(kLeft.size());
  if (name.starts_with(kRight)) return std::string(kLeft) + name.substr(kRight.size());
  return name;
}

// A key, with the names of the other side.
std::string other_key(const ModelField& field) {
  std::string key;
  for (const std::string& word : field.words) key += (key.empty() ? "" : ".") + other_name(word);
  return key;
}

std::optional<ModelField> field_with_key(const XmlDocument& document, const std::string& name,
                                         const std::string& key) {
  for (const ModelElement& element : model_elements(document)) {
    if (element.name != name) continue;
    for (ModelField& field : model_fields(document, element))
      if (field.key() == key) return std::move(field);
  }
  return std::nullopt;
}

std::string negative(const std::string& number) {
  if (koboshi::parse_number(number) == 0.0) return number;
  if (number.starts_with('-')) return number.substr(1);
  return "-" + (number.starts_with('+') ? number.substr(1) : number);
}

// Negates the numbers with a '-' in this pattern, which repeats.
std::string with_signs(const std::string& numbers, std::string_view pattern) {
  std::istringstream words(numbers);
  std::string text;
  std::size_t at = 0;
  for (std::string word; words >> word; ++at)
    text += (text.empty() ? "" : " ") + (pattern[at % pattern.size()] == '-' ? negative(word) : word);
  return text;
}

std::array<double, 3> three_numbers(const std::string& text) {
  std::istringstream words(text);
  std::array<double, 3> values{};
  for (double& value : values) {
    std::string word;
    words >> word;
    value = koboshi::parse_number(word).value_or(0.0);
  }
  return values;
}

// Pairs of joints: whether positive angles of both make mirror images (1) or not (-1).
class JointPair {
 public:
  JointPair(const XmlDocument& document, const std::string& joint) : document_(document), joint_(joint) {}

  int joint_sign() const {
    const auto one = three_numbers(value(joint_, "axis.xyz"));
    const auto other = three_numbers(value(other_name(joint_), "axis.xyz"));
    return -one[0] * other[0] + one[1] * other[1] - one[2] * other[2] < 0.0 ? -1 : 1;
  }

  // The same for the angles of the shafts.
  int shaft_sign() const { return drive_signs() * joint_sign(); }

  // Product of the directions of both drives.
  int drive_signs() const {
    const auto sign = [&](const std::string& joint) {
      return value(joint, "drive.sign").starts_with('-') ? -1 : 1;
    };
    return sign(joint_) * sign(other_name(joint_));
  }

 private:
  std::string value(const std::string& joint, const std::string& within) const {
    const auto field = field_with_key(document_, joint, "joint." + joint + "." + within);
    return field ? field->value.value_or("") : "";
  }

  const XmlDocument& document_;
  const std::string joint_;
};

}  // namespace

bool has_other_side(const XmlDocument& document, const ModelField& field) {
  if (image_of(field) == Image::kNone || other_key(field) == field.key()) return false;
  return field_with_key(document, other_name(field.steps.front().name), other_key(field)).has_value();
}

MirroredValue mirrored_value(const XmlDocument& document, const ModelField& field, const std::string& value) {
  const auto fail = [&](const std::string& found, const std::string& expected) {
    const auto path = field.element_path(document);
    return InputError(document.source(), path ? document.find(*path)->line : 0, found, expected);
  };
  if (image_of(field) == Image::kNone)
    throw fail(field.path + " for both sides", "a value that both sides may share");
  std::string key = other_key(field);
  if (key == field.key()) throw fail(field.path + " for both sides", "an element named left_ or right_");
  const JointPair pair(document, field.steps.front().name);
  const bool turns_over = image_of(field) == Image::kLimit && pair.joint_sign() < 0;
  if (turns_over) {
    const bool is_lower = field.last_word() == "lower";
    key.replace(key.rfind('.') + 1, std::string::npos, is_lower ? "upper" : "lower");
  }
  auto other = field_with_key(document, other_name(field.steps.front().name), key);
  if (!other) throw fail(field.path + " for both sides", "the other side to have it, too");

  const auto image = [&]() -> std::string {
    switch (image_of(field)) {
      case Image::kVector:
        return with_signs(value, "+-+");
      case Image::kAxis:
        return with_signs(value, field.last_word() == "xyz" && pair.joint_sign() < 0 ? "+-+" : "-+-");
      case Image::kPose:
        return with_signs(value, "+-+-+-");
      case Image::kNegative:
        return with_signs(value, "-");
      case Image::kLimit:
        return turns_over ? with_signs(value, "-") : value;
      case Image::kZero:
        return pair.shaft_sign() < 0 ? with_signs(value, "-") : value;
      case Image::kSign:
        return pair.drive_signs() < 0 ? with_signs(value, "-") : value;
      case Image::kName:
        return other_name(value);
      case Image::kSame:
      case Image::kNone:
        break;
    }
    return value;
  };
  std::string text = image();
  return {std::move(*other), std::move(text)};
}

}  // namespace koboshi::sim_board
