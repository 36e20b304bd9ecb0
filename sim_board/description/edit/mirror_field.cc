// The value on the other side of a robot.

#include <algorithm>
#include <array>
#include <map>
#include <sstream>
#include <vector>

#include "base/text/error.h"
#include "base/text/text.h"
#include "sim_board/description/edit/robot_text.h"
#include "sim_board/description/schema/roles.h"

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
  kRole,      // of a joint
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
    ImageOf{"role", Image::kRole},          ImageOf{"mirror", Image::kNone},
    ImageOf{"servo_id", Image::kNone},      ImageOf{"zero_ticks", Image::kNone},
};

Image image_of(const ModelField& field) {
  const auto found = std::ranges::find(kImages, field.last_word(), &ImageOf::last_word);
  return found == kImages.end() ? Image::kSame : found->image;
}

const XmlPart* find_part(const XmlPart& parent, std::string_view tag, const std::string& name = {}) {
  for (const XmlPart* part : parent.elements()) {
    const std::string* const found = part->attribute("name");
    if (part->name == tag && (name.empty() || (found != nullptr && *found == name))) return part;
  }
  return nullptr;
}

std::string text_of(const XmlPart& parent, std::string_view tag) {
  const XmlPart* const part = find_part(parent, tag);
  return part != nullptr ? std::string(trimmed_name(part->content())) : std::string();
}

// Names of joints and links by side: those of a pair of joints are mirror images by koboshi:mirror, by their
// roles or by their names, and so are the links that they carry.
class SideNames {
 public:
  explicit SideNames(const XmlDocument& document) {
    const XmlPart* const model = find_part(document.root(), "model");
    if (model == nullptr) return;
    for (const XmlPart* part : model->elements()) {
      const std::string* const name = part->attribute("name");
      if (part->name != "joint" || name == nullptr) continue;
      const std::string role = text_of(*part, "koboshi:role");
      joints_.push_back(
          {*name, role.empty() ? *name : role, text_of(*part, "koboshi:mirror"), text_of(*part, "child")});
    }
    for (const Joint& joint : joints_) {
      const Joint* const other = mirror_of(joint);
      if (other == nullptr || other == &joint) continue;
      others_[joint.name] = other->name;
      others_.try_emplace(joint.link, other->link);
    }
  }

  // Returns the name of the other side, equal if the name has no side.
  std::string other(const std::string& name) const {
    const auto found = others_.find(name);
    return found == others_.end() ? other_side(name) : found->second;
  }

 private:
  struct Joint {
    std::string name;
    std::string role;
    std::string stated_mirror;
    std::string link;
  };

  const Joint* mirror_of(const Joint& joint) const {
    const std::string wanted = joint.stated_mirror.empty() ? other_side(joint.role) : joint.stated_mirror;
    const auto named = std::ranges::find(joints_, wanted, &Joint::name);
    if (named != joints_.end()) return &*named;
    const auto found = std::ranges::find(joints_, wanted, &Joint::role);
    return found == joints_.end() ? nullptr : &*found;
  }

  std::vector<Joint> joints_;
  std::map<std::string, std::string> others_;
};

// A key, with the names of the other side.
std::string other_key(const SideNames& names, const ModelField& field) {
  std::string key;
  for (const std::string& word : field.words) key += (key.empty() ? "" : ".") + names.other(word);
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

// Whether two fields of an element and its mirror image have the same place there, whatever their names are.
bool same_place(const ModelField& one, const ModelField& other) {
  return one.part == other.part && one.attribute == other.attribute &&
         std::ranges::equal(one.steps.begin() + 1, one.steps.end(), other.steps.begin() + 1,
                            other.steps.end(), [](const ModelField::Step& a, const ModelField::Step& b) {
                              return a.rule == b.rule && (a.name.empty() || a.number == b.number);
                            });
}

// The field of the other side: that with the name of the other side, or that in the same place of an element
// with another name. `last_word` may differ from that of the field.
std::optional<ModelField> other_field(const XmlDocument& document, const SideNames& names,
                                      const ModelField& field, const std::string& last_word) {
  const std::string element = names.other(field.steps.front().name);
  std::string key = other_key(names, field);
  const bool is_same_element = element == field.steps.front().name;
  if (is_same_element && key == field.key()) return std::nullopt;
  key.replace(key.rfind('.') + 1, std::string::npos, last_word);
  auto found = field_with_key(document, element, key);
  if (found || is_same_element || last_word != field.last_word()) return found;
  for (const ModelElement& candidate : model_elements(document)) {
    if (candidate.name != element) continue;
    for (ModelField& other : model_fields(document, candidate))
      if (same_place(field, other)) return std::move(other);
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

// A pair of joints: whether positive angles of both make mirror images (1) or not (-1).
class JointPair {
 public:
  JointPair(const XmlDocument& document, const SideNames& names, const std::string& joint)
      : document_(document), joint_(joint), other_(names.other(joint)) {}

  int joint_sign() const {
    const auto one = three_numbers(value(joint_, "axis.xyz"));
    const auto other = three_numbers(value(other_, "axis.xyz"));
    return -one[0] * other[0] + one[1] * other[1] - one[2] * other[2] < 0.0 ? -1 : 1;
  }

  // The same for the angles of the shafts.
  int shaft_sign() const { return sign_product("drive") * joint_sign(); }

  // Product of the directions of both: of their drives ("drive"), or as their maker counts ("maker").
  int sign_product(const std::string& of) const {
    const auto sign = [&](const std::string& joint) {
      return value(joint, of + ".sign").starts_with('-') ? -1 : 1;
    };
    return sign(joint_) * sign(other_);
  }

 private:
  std::string value(const std::string& joint, const std::string& within) const {
    const auto field = field_with_key(document_, joint, "joint." + joint + "." + within);
    return field ? field->value.value_or("") : "";
  }

  const XmlDocument& document_;
  const std::string joint_;
  const std::string other_;
};

}  // namespace

bool has_other_side(const XmlDocument& document, const ModelField& field) {
  if (image_of(field) == Image::kNone) return false;
  return other_field(document, SideNames(document), field, field.last_word()).has_value();
}

MirroredValue mirrored_value(const XmlDocument& document, const ModelField& field, const std::string& value) {
  const auto fail = [&](const std::string& found, const std::string& expected) {
    const auto path = field.element_path(document);
    return InputError(document.source(), path ? document.find(*path)->line : 0, found, expected);
  };
  if (image_of(field) == Image::kNone)
    throw fail(field.path + " for both sides", "a value that both sides may share");
  const SideNames names(document);
  if (other_key(names, field) == field.key())
    throw fail(field.path + " for both sides", "an element with a side, by koboshi:mirror, role or name");
  const JointPair pair(document, names, field.steps.front().name);
  const bool turns_over = image_of(field) == Image::kLimit && pair.joint_sign() < 0;
  std::string last_word = field.last_word();
  if (turns_over) last_word = last_word == "lower" ? "upper" : "lower";
  auto other = other_field(document, names, field, last_word);
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
        return pair.sign_product(field.words[field.words.size() - 2]) < 0 ? with_signs(value, "-") : value;
      case Image::kName:
        return names.other(value);
      case Image::kRole:
        return other_side(value);
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
