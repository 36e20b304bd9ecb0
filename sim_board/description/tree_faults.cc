#include <map>

#include "sim_board/description/fault_list.h"

namespace koboshi::sim_board {
namespace {

using Parents = std::map<std::string, std::string>;  // by child link

// The base is the only link that is not a joint's child. Returns its name; empty if there is a fault.
std::string find_base(const XmlNode& model, const Parents& parents, FaultList& faults) {
  std::string base;
  const std::vector<XmlNode> links = model.children("link");
  if (links.empty()) faults.add(RobotFaultKind::kTree, model, "a model without links", "one link or more");
  for (const XmlNode& link : links) {
    const std::string name = link.attribute("name");
    if (parents.contains(name)) continue;
    if (base.empty()) {
      base = name;
    } else {
      faults.add(RobotFaultKind::kTree, link, "link " + name + ", no joint's child",
                 "only " + base + " to be that");
    }
  }
  if (base.empty() && !links.empty()) {
    faults.add(RobotFaultKind::kTree, model, "no link that is no joint's child",
               "a base from which the joints make a tree");
  }
  return base;
}

// With one base and no link twice a child, links that the base does not reach form a loop.
void find_rings(const XmlNode& model, const Parents& parents, const std::string& base, FaultList& faults) {
  for (const XmlNode& link : model.children("link")) {
    const std::string name = link.attribute("name");
    std::string above = name;
    for (std::size_t steps = 0; steps <= parents.size() && parents.contains(above); ++steps)
      above = parents.at(above);
    if (!parents.contains(above)) continue;
    faults.add(RobotFaultKind::kTree, link, "link " + name + " in a ring of joints", "a tree from " + base);
  }
}

}  // namespace

void find_tree_faults(const XmlNode& model, const ModelFrames& frames, FaultList& faults) {
  Parents parents;
  for (const XmlNode& joint : model.children("joint")) {
    const std::string child = frames.link_of(joint.child("child").text());
    if (!parents.emplace(child, frames.link_of(joint.child("parent").text())).second)
      faults.add(RobotFaultKind::kTree, joint, "a second joint that moves link " + child, "one joint a link");
  }
  const std::string base = find_base(model, parents, faults);
  if (!base.empty()) find_rings(model, parents, base, faults);
}

}  // namespace koboshi::sim_board
