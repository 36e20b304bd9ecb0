#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "firmware/app/dictionary.h"
#include "sim_board/description/description.h"

namespace koboshi::bus {

struct GeneratedFile {
  std::string name;
  std::string text;
};

// The files in docs/reference that are generated from the object dictionaries: the data sheets of all kinds
// of nodes, koboshi.dbc and bus.yml of the robot's network, and the pages. `values` are the robot's
// parameters. Throws InputError as make_network does.
std::vector<GeneratedFile> dictionary_files(const sim_board::RobotDescription& robot,
                                            const app::ControllerValues& values);

}  // namespace koboshi::bus
