#pragma once

#include "sim_board/description/description.h"
#include "sim_board/world/free_body.h"
#include "sim_board/world/ground.h"
#include "view/recording/recording.h"

namespace koboshi::view {

// The shapes of a robot and its ground, ready to be drawn. Visuals are the robot file's boxes and meshes; a
// link with a mesh that read_stl() cannot read shows its collision boxes instead. Shapes without a
// colour in the file get one by their kind. Free bodies are links without mass and parent, after those of the
// robot.
Scene make_scene(const sim_board::RobotDescription& robot, const sim_board::GroundDescription& ground,
                 const std::vector<sim_board::FreeBodyDescription>& free_bodies = {});

}  // namespace koboshi::view
