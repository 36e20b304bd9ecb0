#include "tools/import/servo/servo_catalogue.h"

#include <tinyxml2.h>

#include <algorithm>

#include "base/text/error.h"
#include "base/text/text.h"
#include "base/xml/xml_reader.h"
#include "sim_board/description/schema/sdf_schema.h"
#include "sim_board/description/servo_types.h"

namespace koboshi::tools {

ServoCatalogue::ServoCatalogue(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored))
    if (entry.path().extension() == ".xml") files.push_back(entry.path());
  std::ranges::sort(files);
  for (const std::filesystem::path& file : files)
    for (const auto& [name, servo] : sim_board::read_servo_types(file))
      entries_.try_emplace(name, Entry{servo, file, {}});
}

const ServoCatalogue::Entry& ServoCatalogue::find(const std::string& type,
                                                  const std::filesystem::path& source) const {
  const auto found = entries_.find(type);
  if (found == entries_.end())
    throw InputError(source, 0, "the servo type " + one_line(type), expected_names(type, names()));
  return found->second;
}

std::vector<std::string> ServoCatalogue::names() const {
  std::vector<std::string> names;
  for (const auto& [name, entry] : entries_) names.push_back(name);
  return names;
}

bool ServoCatalogue::add(const std::string& type, const sim_board::ServoDescription& servo,
                         const std::string& text) {
  const auto [entry, is_new] = entries_.try_emplace(type, Entry{servo, {}, text});
  return is_new || entry->second.text == text;
}

std::string ServoCatalogue::text(const std::string& type) const {
  if (const Entry& entry = entries_.at(type); !entry.text.empty()) return entry.text;
  const XmlFile file(entries_.at(type).library, sim_board::servo_library_rule());
  for (const XmlNode& node : file.root().children("koboshi:servo_type")) {
    if (node.attribute("name") != type) continue;
    tinyxml2::XMLPrinter printer(nullptr, false, 2);
    const tinyxml2::XMLNode* const before = node.element().PreviousSibling();
    const tinyxml2::XMLComment* const comment = before != nullptr ? before->ToComment() : nullptr;
    node.element().Accept(&printer);
    return (comment != nullptr ? "<!--" + std::string(comment->Value()) + "-->\n" : std::string()) +
           printer.CStr();
  }
  return {};
}

double stall_torque_Nm(const sim_board::ServoDescription& servo) {
  const double current_A =
      std::min(servo.max_duty * servo.supply_V / servo.resistance_ohm, servo.current_limit_A);
  return servo.torque_constant_Nm_per_A * current_A - servo.coulomb_friction_Nm;
}

double no_load_speed_rad_per_s(const sim_board::ServoDescription& servo) {
  // kt (V - kt w) / R = Kc + Kv w
  const double kt = servo.torque_constant_Nm_per_A;
  const double driving_Nm =
      kt * servo.max_duty * servo.supply_V / servo.resistance_ohm - servo.coulomb_friction_Nm;
  return driving_Nm / (kt * kt / servo.resistance_ohm + servo.viscous_friction_Nm_s);
}

}  // namespace koboshi::tools
