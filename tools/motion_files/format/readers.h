#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "tools/motion_files/format/foreign_motion.h"

namespace koboshi::tools {

// Readers of the formats. Each returns the motions of a file, at least one: one for each page that is not
// empty, where a format has pages, else a single one. They read as much as they can; the notes say
// what was wrong, ignored or guessed. All throw InputError, with file and line or offset, if nothing can be
// read. `file` is for messages only; `text` is decoded (encoding.h).
[[nodiscard]] ForeignMotion read_webots(const std::filesystem::path& file, std::string_view text);
[[nodiscard]] ForeignMotion read_csv_motion(const std::filesystem::path& file, std::string_view text);
[[nodiscard]] ForeignMotion read_bit_bots(const std::filesystem::path& file, std::string_view text);
[[nodiscard]] ForeignMotion read_bold(const std::filesystem::path& file, std::string_view text);
[[nodiscard]] ForeignMotion read_pose_seq(const std::filesystem::path& file, std::string_view text);
[[nodiscard]] std::vector<ForeignMotion> read_roboplus_text(const std::filesystem::path& file,
                                                            std::string_view text);
[[nodiscard]] std::vector<ForeignMotion> read_roboplus_pages(const std::filesystem::path& file,
                                                             std::string_view bytes);
[[nodiscard]] std::vector<ForeignMotion> read_roboplus_xml(const std::filesystem::path& file,
                                                           std::string_view text);
[[nodiscard]] ForeignMotion read_kondo(const std::filesystem::path& file, std::string_view text);

// Reads a file of any of the formats. Throws InputError also for a file that is none of them.
[[nodiscard]] std::vector<ForeignMotion> read_foreign_motions(const std::filesystem::path& file,
                                                              std::string_view bytes);

}  // namespace koboshi::tools
