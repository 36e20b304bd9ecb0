#pragma once

#include <span>
#include <string>

#include "bus/dictionary/network.h"
#include "bus/dictionary/object_dictionary.h"
#include "firmware/app/dictionary.h"
#include "sim_board/description/description.h"

namespace koboshi::bus {

// The texts of the generated files, one function for each format.

// The electronic data sheet of a kind of node, CiA 306-1. Its dates are fixed: the same table gives the
// same bytes.
std::string eds_text(const NodeKind& kind);

// A network in the format of Vector's CANdb++, which most programs for CAN read.
std::string dbc_text(const Network& network);

// The configuration of a CANopen master that takes the controller's place, in the format of dcfgen (the tools
// of lely-core): the master's own cycle and heartbeat, and for each drive and sensor its data sheet,
// identity, supervision, PDOs and the SDO requests of its start-up. It configures a drive as the firmware
// does. Throws InputError as make_network does.
std::string bus_text(const sim_board::RobotDescription& robot);

// The page docs/reference/object-dictionary.md: the objects of all kinds of nodes and the PDOs of a network.
std::string page_text(std::span<const NodeKind> kinds, const Network& network);

// The page docs/reference/parameters.md: every parameter of the controller with its range, its default, its
// value on the named robot if it differs from the default, and its meaning.
std::string parameters_page_text(const NodeKind& controller, const std::string& robot,
                                 const app::ControllerValues& robot_values);

}  // namespace koboshi::bus
