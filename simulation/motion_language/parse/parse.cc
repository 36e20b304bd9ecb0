#include "simulation/motion_language/parse/parse.h"

#include <algorithm>
#include <array>
#include <limits>

#include "base/text/text.h"
#include "firmware/motion/motion.h"
#include "simulation/motion_language/parse/codes.h"
#include "simulation/motion_language/parse/expression.h"
#include "simulation/motion_language/parse/parse_steps.h"
#include "simulation/motion_language/parse/poses.h"

namespace koboshi::simulation {
namespace {

constexpr std::size_t kMaxMotionText = 1u << 20;
constexpr std::size_t kMaxVariables = 16;

class MotionParser {
 public:
  MotionParser(const std::filesystem::path& file, const YamlNode& tree, const NamedModel& robot,
               Diagnostics& diagnostics)
      : root_(tree), joints_(robot), reader_(diagnostics) {
    motion_.file = file;
  }

  MotionSource parse() {
    if (!read_version()) return std::move(motion_);
    reader_.check_keys(root_,
                       motion_.version < 2
                           ? std::vector<std::string>{"version", "robot", "name", "poses", "steps"}
                           : std::vector<std::string>{"version", "robot", "name", "interpolation", "joints",
                                                      "variables", "exit", "poses", "routines", "steps"});
    read_robot();
    read_name();
    read_joints();
    read_variables();
    read_steps();
    return std::move(motion_);
  }

 private:
  const YamlNode* find(const std::string& key) const {
    return motion_.version < 2 ? nullptr : root_.find(key);
  }

  bool read_version() {
    const YamlNode* node = reader_.require(root_, "version", "version 1 or 2");
    const auto version = node ? reader_.integer(*node) : std::nullopt;
    if (!version) return false;
    if (*version != 1 && *version != 2) {
      reader_.error(code::kBadVersion, Reader::value_place(*node), "version = " + std::to_string(*version),
                    "version 1 or 2");
      return false;
    }
    motion_.version = static_cast<int>(*version);
    return true;
  }

  void read_robot() {
    const YamlNode* node = reader_.require(root_, "robot", "a text");
    const auto name = node ? reader_.text(*node) : std::nullopt;
    if (!name || *name == joints_.robot().robot) return;
    reader_.error(code::kOtherRobot, Reader::value_place(*node), "the robot '" + one_line(*name) + "'",
                  "a motion for " + joints_.robot().robot);
  }

  void read_name() {
    const YamlNode* node = reader_.require(root_, "name", "a text");
    const auto name = node ? reader_.text(*node) : std::nullopt;
    if (!name) return;
    motion_.name = *name;
    const bool printable =
        std::all_of(name->begin(), name->end(), [](char letter) { return letter >= ' ' && letter <= '~'; });
    if (printable && name->size() <= motion::kNameSize) return;
    reader_.error(code::kBadName, Reader::value_place(*node), "the name '" + one_line(*name) + "'",
                  "at most " + std::to_string(motion::kNameSize) + " printable ASCII letters");
  }

  void read_joints() {
    const std::uint32_t all = (std::uint32_t{1} << joints_.count()) - 1;
    allowed_ = all;
    const YamlNode* list = find("joints");
    if (list == nullptr || !reader_.is_list(*list)) return;
    allowed_ = 0;
    for (const YamlNode& item : list->items) {
      const auto name = reader_.text(item);
      if (!name) continue;
      const std::uint32_t mask = joints_.mask(*name);
      allowed_ |= mask;
      if (mask != 0) continue;
      allowed_ = all;  // no error for each joint of the group that was meant
      reader_.error(code::kUnknownJoint, Reader::value_place(item), "the joint '" + one_line(*name) + "'",
                    "a joint or group of " + joints_.robot().robot, did_you_mean(*name, joints_.all(true)));
    }
  }

  void read_variables() {
    const YamlNode* map = find("variables");
    if (map == nullptr || !reader_.is_map(*map)) return;
    for (const YamlNode& item : map->items) {
      const auto initial = reader_.integer(item, {.min = std::numeric_limits<std::int32_t>::min(),
                                                  .max = std::numeric_limits<std::int32_t>::max()});
      if (!is_identifier(item.key) || is_reserved(item.key)) {
        reader_.error(code::kBadName, Reader::key_place(item), "the variable '" + one_line(item.key) + "'",
                      "letters, digits and _, and no name of a sensor or function");
      } else if (motion_.variables.size() == kMaxVariables) {
        reader_.error(code::kTooManyVariables, Reader::key_place(item), "more than 16 variables", "fewer");
        return;
      }
      motion_.variables.push_back(
          {item.key, Reader::key_place(item), static_cast<std::int32_t>(initial.value_or(0))});
    }
  }

  void read_steps() {
    PoseBuilder poses(joints_, allowed_, motion_.version, reader_);
    if (const YamlNode* node = root_.find("poses")) poses.read(*node);
    StepContext context{
        .version = motion_.version, .variables = motion_.variables, .routines = {}, .allowed = allowed_};
    if (const YamlNode* node = find("interpolation")) {
      if (const auto interpolation = parse_interpolation(*node, reader_))
        context.interpolation = *interpolation;
    }
    const YamlNode* routines = find("routines");
    if (routines != nullptr && !reader_.is_map(*routines)) routines = nullptr;
    if (routines != nullptr) {
      for (const YamlNode& item : routines->items) context.routines.push_back(item.key);
    }
    StepParser parser(joints_, context, poses, reader_);
    if (routines != nullptr) {
      for (const YamlNode& item : routines->items) {
        motion_.routines.push_back({item.key, Reader::key_place(item), parser.parse(item)});
      }
    }
    if (const YamlNode* node = reader_.require(root_, "steps", "a list")) motion_.steps = parser.parse(*node);
    if (const YamlNode* node = find("exit")) {
      motion_.exit = reader_.text(*node).value_or(std::string());
      motion_.exit_place = Reader::value_place(*node);
    }
    motion_.poses = poses.take();
  }

  const YamlNode& root_;
  const JointNames joints_;
  Reader reader_;
  MotionSource motion_;
  std::uint32_t allowed_ = 0;
};

}  // namespace

bool is_motion_image(std::string_view bytes) {
  constexpr std::uint32_t kMagic = motion::kMotionMagic;
  constexpr std::array<char, 4> kBytes{static_cast<char>(kMagic), static_cast<char>(kMagic >> 8),
                                       static_cast<char>(kMagic >> 16), static_cast<char>(kMagic >> 24)};
  // The version of the format follows, a byte that no text has.
  return bytes.size() > 4 && bytes.starts_with(std::string_view(kBytes.data(), kBytes.size())) &&
         bytes[4] < ' ';
}

MotionFile read_motion_text(const std::filesystem::path& path, std::string text,
                            std::span<const Override> overrides) {
  Diagnostics diagnostics(path, text);
  if (text.size() > kMaxMotionText) {
    diagnostics.add({.code = code::kYaml,
                     .found = "a file of " + std::to_string(text.size()) + " bytes",
                     .expected = "a motion of at most 1 MiB"});
    diagnostics.throw_errors();
  }
  if (is_motion_image(text)) {
    diagnostics.add({.code = code::kYaml,
                     .found = "the image of a motion",
                     .expected = "a motion file (YAML), which koboshi motion decompile makes of it"});
    diagnostics.throw_errors();
  }
  MotionFile file{.path = path, .text = std::move(text), .tree = {}};
  try {
    file.tree = parse_yaml(file.text, path);
  } catch (const InputError& error) {
    diagnostics.add({.code = code::kYaml,
                     .place = {.line = error.line()},
                     .found = error.found(),
                     .expected = error.expected()});
    diagnostics.throw_errors();
  }
  for (const Override& override_value : overrides) apply_override(file.tree, override_value);
  return file;
}

MotionFile read_motion_file(const std::filesystem::path& file, std::span<const Override> overrides) {
  return read_motion_text(file, read_text_file(file, "a YAML file"), overrides);
}

MotionSource parse_motion(const MotionFile& file, const NamedModel& robot, Diagnostics& diagnostics) {
  return parse_motion(file.path, file.tree, robot, diagnostics);
}

MotionSource parse_motion(const std::filesystem::path& file, const YamlNode& tree, const NamedModel& robot,
                          Diagnostics& diagnostics) {
  return MotionParser(file, tree, robot, diagnostics).parse();
}

MotionSource parse_motion(const std::filesystem::path& file, const NamedModel& robot,
                          std::span<const Override> overrides) {
  const MotionFile read = read_motion_file(file, overrides);
  Diagnostics diagnostics(read.path, read.text);
  MotionSource motion = parse_motion(read, robot, diagnostics);
  diagnostics.throw_errors();
  return motion;
}

}  // namespace koboshi::simulation
