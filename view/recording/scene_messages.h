#pragma once

#include <foxglove.pb.h>
#include <recording.pb.h>

#include "view/recording/recording.h"

namespace koboshi::view {

// A scene as messages of a recording.

// Everything in the scene.
koboshi::Scene message_of(const Scene& scene);
// Throws std::invalid_argument, with the part that is wrong, for a message that is no scene.
Scene scene_of(const koboshi::Scene& message);

// The scene for a viewer: an entity for each link in the link's frame, and one for the ground in the frame
// `world`. A plane is a square of some metres.
foxglove::SceneUpdate scene_update(const Scene& scene, const char* world);

}  // namespace koboshi::view
