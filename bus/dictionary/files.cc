#include "bus/dictionary/files.h"

#include "bus/dictionary/formats.h"
#include "bus/dictionary/network.h"
#include "bus/dictionary/node_kinds.h"
#include "simulation/model/robot_model.h"

namespace koboshi::bus {

std::vector<GeneratedFile> dictionary_files(const sim_board::RobotDescription& robot,
                                            const app::ControllerValues& values) {
  const robot::RobotModel model = simulation::load_named_model(robot).model;
  // The pages describe the program; the data sheets are of this robot's nodes, which tools configure.
  const std::vector<NodeKind> kinds = documented_kinds(model);
  const Network network = make_network(robot);
  std::vector<GeneratedFile> files;
  for (const NodeKind& kind : documented_kinds(model, values))
    files.push_back({kind.name + ".eds", eds_text(kind)});
  files.push_back({"bus.yml", bus_text(robot)});
  files.push_back({"koboshi.dbc", dbc_text(network)});
  files.push_back({"object-dictionary.md", page_text(kinds, network)});
  files.push_back({"parameters.md", parameters_page_text(kinds.front(), robot.name, values)});
  return files;
}

}  // namespace koboshi::bus
