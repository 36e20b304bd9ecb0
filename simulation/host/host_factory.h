#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>

#include "sim_board/board/controller_host.h"

namespace koboshi::simulation {

// Creates the host of the firmware for a board with these storage contents.
using HostFactory =
    std::function<std::unique_ptr<sim_board::ControllerHost>(std::span<const std::byte> storage_contents)>;

// Runs the firmware in this process. Its storage is in a file if one is named (FlashMemory).
[[nodiscard]] HostFactory in_process(const std::filesystem::path& storage_file = {});

}  // namespace koboshi::simulation
