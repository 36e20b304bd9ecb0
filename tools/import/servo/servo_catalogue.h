#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "sim_board/description/description.h"

namespace koboshi::tools {

// The servo types of all libraries in a folder, such as robots/servos/.
class ServoCatalogue {
 public:
  // Throws InputError for a library that is malformed.
  explicit ServoCatalogue(const std::filesystem::path& folder);

  struct Entry {
    sim_board::ServoDescription servo{};
    std::filesystem::path library{};
    std::string text{};  // of a type that the import has made; empty: the library has it
  };
  // Adds a type that the import has made. Returns false for a name that another type has.
  bool add(const std::string& type, const sim_board::ServoDescription& servo, const std::string& text);
  // Throws InputError, naming `source`, for a type that no library has.
  const Entry& find(const std::string& type, const std::filesystem::path& source) const;
  std::vector<std::string> names() const;

  // Returns the XML text of a type, as its library has it, with the comment before it: its source.
  std::string text(const std::string& type) const;

 private:
  std::map<std::string, Entry> entries_;
};

// Torque with the full supply at rest, and speed without load, in the servo's own friction.
[[nodiscard]] double stall_torque_Nm(const sim_board::ServoDescription& servo);
[[nodiscard]] double no_load_speed_rad_per_s(const sim_board::ServoDescription& servo);

}  // namespace koboshi::tools
