#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "firmware/canopen/dictionary.h"

namespace koboshi::app {

// The parameters that a robot leaves the factory with: gait, gains, limits. They are an item of the
// catalogue, an image of its own (storage/image.h). Its body is the id u32 of the robot model that they were
// found for, and one storage::ParameterRecord for each parameter, its value sign-extended.
// docs/decision/0014-factory-parameters.md gives the reasons.
inline constexpr std::uint32_t kFactoryParametersMagic = 0x5046524Bu;  // "KRFP"
inline constexpr std::uint16_t kFactoryParametersVersion = 1;

enum class [[nodiscard]] FactoryStatus : std::uint8_t{
    kLoaded = 0,
    kNone = 1,        // the storage holds none
    kDamaged = 2,     // no valid image, or one that ends within a record
    kOtherModel = 3,  // for another robot model than the one in storage
    kRefused = 4,     // the dictionary has no such parameter, or not that value of it
};

// Writes the parameters of `item` into the dictionary, each within the limits that hold for an SDO client,
// too. All or none of them: unless it returns kLoaded, the dictionary is as before. Objects that are no
// parameters, and the communication area below 0x2000, are refused.
FactoryStatus load_factory_parameters(std::span<const std::byte> item, std::uint32_t model_id,
                                      canopen::Dictionary dictionary);

}  // namespace koboshi::app
