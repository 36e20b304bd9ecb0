// .h4p of KONDO HeartToHeart4: XML with commands of the RCB-4 in hexadecimal. Byte 0 of a command is its
// length, byte 1 its kind, the last one the low byte of the sum of the others. 0x10 moves servos: 5 bytes of
// mask, the frames that the move takes, and a position of 16 bits for each bit of the mask. 0x0F moves one
// servo.

#include <tinyxml2.h>

#include <cctype>
#include <map>
#include <string>
#include <utility>

#include "base/text/error.h"
#include "base/text/text.h"
#include "base/xml/xml_parse.h"
#include "tools/motion_files/format/lines.h"
#include "tools/motion_files/format/readers.h"

namespace koboshi::tools {
namespace {

constexpr int kMaskServos = 40;
constexpr int kOneServo = 0x0F;
constexpr int kManyServos = 0x10;
constexpr std::int64_t kFrame_us = 15'000;  // of an RCB-4 with its factory settings
constexpr int kFree = 0x8000;               // positions that mean something else
constexpr int kHold = 0x7FFF;
constexpr int kLowestPosition = 3'500;  // of the servos; 7,500 is the middle
constexpr int kHighestPosition = 11'500;
constexpr std::size_t kMostKondoFrames = 100'000;

// Bytes in hexadecimal, with or without separators. Nothing for other text.
std::optional<std::vector<int>> hex_bytes(std::string_view text) {
  std::vector<int> bytes;
  int high = -1;
  for (const char c : text) {
    const auto letter = static_cast<unsigned char>(c);
    if (std::isspace(letter) != 0 || c == ',' || c == '-') {
      if (high >= 0) return std::nullopt;
      continue;
    }
    if (std::isxdigit(letter) == 0) return std::nullopt;
    const int digit = std::isdigit(letter) != 0 ? c - '0' : std::tolower(letter) - 'a' + 10;
    if (high < 0) {
      high = digit;
    } else {
      bytes.push_back(high * 16 + digit);
      high = -1;
    }
  }
  if (high >= 0) return std::nullopt;
  return bytes;
}

class KondoReader {
 public:
  // Visits the elements in the order of the file, without recursion: a file decides how deep it is.
  void visit(const tinyxml2::XMLElement& root) {
    const tinyxml2::XMLElement* element = &root;
    while (element != nullptr) {
      read_element(*element);
      const tinyxml2::XMLElement* next = element->FirstChildElement();
      while (next == nullptr && element != nullptr && element != &root) {
        next = element->NextSiblingElement();
        if (next == nullptr)
          element = element->Parent() == nullptr ? nullptr : element->Parent()->ToElement();
      }
      element = next;
    }
  }

  ForeignMotion finish(const std::filesystem::path& file) {
    if (section_.frames.empty())
      throw InputError(file, 0, "no command that moves servos", "commands of an RCB-4 in hexadecimal");
    for (ForeignFrame& frame : section_.frames) frame.values.resize(motion_.joints.size());
    motion_.sections.push_back(std::move(section_));
    motion_.notes.push_back(
        {"commands", "are taken in the order of the file, and a frame as 15 ms; branches are not followed"});
    if (ignored_ > 0)
      motion_.notes.push_back(
          {"commands", count_text(ignored_, "command") + " that move no servo are ignored"});
    return std::move(motion_);
  }

 private:
  void read_element(const tinyxml2::XMLElement& element) {
    if (element.GetText() != nullptr) command(element.GetText(), element.GetLineNum());
    for (const auto* attribute = element.FirstAttribute(); attribute != nullptr;
         attribute = attribute->Next()) {
      command(attribute->Value(), attribute->GetLineNum());
      if (motion_.name.empty() && std::string_view(attribute->Name()) == "Name")
        motion_.name = one_line(attribute->Value());
    }
  }

  void command(std::string_view text, int line) {
    const auto bytes = hex_bytes(text);
    // A command begins with its own length; other numbers of the file hardly do.
    if (!bytes || bytes->size() < 4 || static_cast<std::size_t>(bytes->front()) != bytes->size()) return;
    const std::string place = line_place(static_cast<std::size_t>(line));
    const int kind = (*bytes)[1];
    if (kind != kManyServos && kind != kOneServo) {
      ++ignored_;
      return;
    }
    int sum = 0;
    for (std::size_t i = 0; i + 1 < bytes->size(); ++i) sum += (*bytes)[i];
    if ((sum & 0xFF) != bytes->back())
      motion_.notes.push_back({place, "its checksum is " + std::to_string(bytes->back()) + " instead of " +
                                          std::to_string(sum & 0xFF) + "; it is read all the same"});
    if (kind == kManyServos) {
      many_servos(*bytes, place);
    } else if (bytes->size() == 7) {
      add({{(*bytes)[2], (*bytes)[4] | (*bytes)[5] << 8}}, (*bytes)[3], place);
    } else {
      motion_.notes.push_back(
          {place, "ignored: a command for one servo has 7 bytes, not " + std::to_string(bytes->size())});
    }
  }

  void many_servos(const std::vector<int>& bytes, const std::string& place) {
    constexpr std::size_t kMaskAt = 2;
    constexpr std::size_t kFramesAt = 7;
    if (bytes.size() <= kFramesAt + 1) {
      motion_.notes.push_back({place, "ignored: it has no room for mask and frames"});
      return;
    }
    std::vector<std::pair<int, int>> positions;
    std::size_t at = kFramesAt + 1;
    for (int id = 0; id < kMaskServos; ++id) {
      if ((bytes[kMaskAt + static_cast<std::size_t>(id) / 8] >> (id % 8) & 1) == 0) continue;
      if (at + 2 >= bytes.size()) {
        motion_.notes.push_back(
            {place, "has no position for servo " + std::to_string(id) + " and those after it"});
        break;
      }
      positions.emplace_back(id, bytes[at] | bytes[at + 1] << 8);
      at += 2;
    }
    if (at + 1 < bytes.size())
      motion_.notes.push_back({place, "has more positions than servos; the others are ignored"});
    add(positions, bytes[kFramesAt], place);
  }

  void add(const std::vector<std::pair<int, int>>& positions, int frames, const std::string& place) {
    if (section_.frames.size() == kMostKondoFrames) return;
    ForeignFrame frame{.place = place, .move_us = frames * kFrame_us};
    for (const auto& [id, position] : positions) {
      const std::size_t joint = joint_of(id);
      frame.values.resize(motion_.joints.size());
      if (position == kFree) {
        limp_[joint] = true;
      } else if (position >= kLowestPosition && position <= kHighestPosition) {
        frame.values[joint] = position;
        limp_[joint] = false;
      } else if (position != kHold) {
        motion_.notes.push_back({place, "servo " + std::to_string(id) + " keeps its position: " +
                                            std::to_string(position) + " is not from 3500 to 11500"});
      }
    }
    for (const auto& [joint, is_limp] : limp_) {
      if (is_limp) frame.without_torque.push_back(joint);
    }
    section_.frames.push_back(std::move(frame));
  }

  std::size_t joint_of(int id) {
    const auto [found, is_new] = places_.try_emplace(id, motion_.joints.size());
    if (is_new) motion_.joints.push_back({.name = "servo " + std::to_string(id), .servo_id = id});
    return found->second;
  }

  ForeignMotion motion_{.format = MotionFormat::kKondo, .unit = ForeignMotion::Unit::kTicks};
  ForeignSection section_;
  std::map<int, std::size_t> places_;  // of the servos among the joints
  std::map<std::size_t, bool> limp_;   // joints whose torque is off, until they get a position
  std::uint64_t ignored_ = 0;
};

}  // namespace

ForeignMotion read_kondo(const std::filesystem::path& file, std::string_view text) {
  tinyxml2::XMLDocument document;
  parse_xml_text(document, text, file);
  KondoReader reader;
  if (document.RootElement() != nullptr) reader.visit(*document.RootElement());
  return reader.finish(file);
}

}  // namespace koboshi::tools
