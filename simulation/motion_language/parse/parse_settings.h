#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "simulation/motion_language/parse/joints.h"
#include "simulation/motion_language/parse/reader.h"
#include "simulation/motion_language/parse/source.h"

namespace koboshi::simulation {

// Names of the sources of `mix`, by motion::MixSource.
inline constexpr std::array<std::string_view, 5> kMixSources{"roll_rate", "pitch_rate", "yaw_rate", "roll",
                                                             "pitch"};

// Parses the settings `stiffness`, `torque_off`, `gain`, `mix` and `lean`, which are steps of their own or
// keys of a move. Each function returns whether the value is free of errors, which it reports.
class SettingParser {
 public:
  // `allowed`: mask of the joints that the motion may move.
  SettingParser(const JointNames& joints, std::uint32_t allowed, Reader& reader)
      : joints_(joints), allowed_(allowed), reader_(reader) {}

  // motion::Stiffness or motion::Gain. `name`: that of the key.
  template <typename Share>
  bool shares(const YamlNode& value, const std::string& name, std::vector<Share>& settings);
  bool torque_off(const YamlNode& value, std::vector<motion::Stiffness>& settings);
  // The key `during` of a move that takes `time_us`.
  bool windows(const YamlNode& value, std::uint32_t time_us, std::vector<motion::Window>& windows);
  bool mix(const YamlNode& value, std::vector<motion::Mix>& settings);
  bool lean(const YamlNode& value, std::optional<motion::LeanDeclaration>& lean);

 private:
  std::optional<std::uint32_t> joints(const YamlNode& node, const std::string& name);
  std::optional<double> mix_limit_deg(const YamlNode& node);

  const JointNames& joints_;
  const std::uint32_t allowed_;
  Reader& reader_;
};

}  // namespace koboshi::simulation
