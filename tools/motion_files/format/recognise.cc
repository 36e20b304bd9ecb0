#include <string>

#include "base/text/error.h"
#include "base/text/text.h"
#include "tools/motion_files/format/csv_table.h"
#include "tools/motion_files/format/encoding.h"
#include "tools/motion_files/format/lines.h"
#include "tools/motion_files/format/readers.h"
#include "tools/motion_files/format/roboplus_page.h"

namespace koboshi::tools {
namespace {

bool is_json(std::string_view text) { return trimmed(text.substr(0, text.find('\n'))).starts_with('{'); }

bool has(std::string_view text, std::string_view part) { return text.find(part) != std::string_view::npos; }

// The first line that is neither empty nor a comment.
std::string_view first_line(std::string_view text) {
  std::string_view line;
  while (take_line(text, line)) {
    line = trimmed(line);
    if (!line.empty() && !line.starts_with("//")) return line;
  }
  return {};
}

std::optional<MotionFormat> recognise_text(std::string_view text) {
  const std::string_view first = first_line(text);
  if (first.starts_with("#WEBOTS_MOTION")) return MotionFormat::kWebots;
  if (has(text, "page_begin") && has(text, "step=")) return MotionFormat::kRoboplusText;
  if (first.starts_with('<')) {
    if (has(text, "<PageRoot") && has(text, "frame=")) return MotionFormat::kRoboplusXml;
    // No public description gives the names of its elements: any of the program or of its controller will do.
    for (const char* word : {"HeartToHeart", "Heart To Heart", "Heart2Heart", "RCB-4", "RCB4", "CodeText"}) {
      if (has(text, word)) return MotionFormat::kKondo;
    }
    return std::nullopt;
  }
  if (is_json(first)) {
    if (has(text, "\"keyframes\"") && has(text, "\"goals\"")) return MotionFormat::kBitBots;
    if (has(text, "\"stages\"") && has(text, "\"keyFrames\"")) return MotionFormat::kBold;
    return std::nullopt;
  }
  if (has(text, "PoseSeq") && has(text, "refs:")) return MotionFormat::kPoseSeq;
  if (find_csv_header(text)) return MotionFormat::kCsv;
  return std::nullopt;
}

// What a file of no known format is, for messages.
std::string kind_of(std::string_view bytes, std::string_view text) {
  if (bytes.starts_with("KMOT") && bytes.find('\0') != std::string_view::npos)
    return "the image of a motion of Koboshi, which koboshi motion decompile reads";
  if (has("\n" + std::string(text), "\nversion:") && has(text, "\nrobot:") && has(text, "\nsteps:"))
    return "a motion file of Koboshi, which needs no import";
  return "a file of no known format";
}

std::vector<ForeignMotion> read_text_of(MotionFormat format, const std::filesystem::path& file,
                                        const std::string& text) {
  switch (format) {
    case MotionFormat::kWebots:
      return {read_webots(file, text)};
    case MotionFormat::kCsv:
      return {read_csv_motion(file, text)};
    case MotionFormat::kBitBots:
      return {read_bit_bots(file, text)};
    case MotionFormat::kBold:
      return {read_bold(file, text)};
    case MotionFormat::kPoseSeq:
      return {read_pose_seq(file, text)};
    case MotionFormat::kRoboplusXml:
      return read_roboplus_xml(file, text);
    case MotionFormat::kKondo:
      return {read_kondo(file, text)};
    default:
      return read_roboplus_text(file, text);
  }
}

}  // namespace

std::string name_of(MotionFormat format) {
  switch (format) {
    case MotionFormat::kWebots:
      return "a motion of Webots";
    case MotionFormat::kCsv:
      return "a table of joint angles";
    case MotionFormat::kBitBots:
      return "an animation of the Bit-Bots";
    case MotionFormat::kBold:
      return "a motion script of bold-humanoid";
    case MotionFormat::kPoseSeq:
      return "a pose sequence of Choreonoid";
    case MotionFormat::kRoboplusText:
      return "a motion file of ROBOTIS RoboPlus";
    case MotionFormat::kRoboplusPages:
      return "motion pages of ROBOTIS";
    case MotionFormat::kRoboplusXml:
      return "a motion file of ROBOTIS R+";
    case MotionFormat::kKondo:
      return "a motion of KONDO HeartToHeart4";
  }
  return "a motion";
}

std::optional<MotionFormat> recognise(std::string_view bytes) {
  if (is_roboplus_pages(bytes)) return MotionFormat::kRoboplusPages;
  return recognise_text(decode_text(bytes).text);
}

std::vector<ForeignMotion> read_foreign_motions(const std::filesystem::path& file, std::string_view bytes) {
  if (is_roboplus_pages(bytes)) return read_roboplus_pages(file, bytes);
  const DecodedText decoded = decode_text(bytes);
  const auto format = recognise_text(decoded.text);
  if (!format)
    throw InputError(
        file, 0, kind_of(bytes, decoded.text),
        "a motion of Webots, ROBOTIS (.mtn, .bin, .mtnx), KONDO (.h4p), Choreonoid (.pseq), Bit-Bots or "
        "bold-humanoid (JSON), or a table (CSV)");
  std::vector<ForeignMotion> motions = read_text_of(*format, file, decoded.text);
  if (!decoded.encoding.empty()) {
    for (ForeignMotion& motion : motions) motion.notes.push_back({"text", "is read as " + decoded.encoding});
  }
  return motions;
}

}  // namespace koboshi::tools
