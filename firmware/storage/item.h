#pragma once

#include <cstddef>
#include <cstdint>

namespace koboshi::storage {

// What an item is. Kind and number together identify it; both are stored in flash, so new kinds are appended.
enum class ItemKind : std::uint16_t {
  kRobotModel = 1,
  kMotion = 2,             // numbers 0 to kMaxMotions - 1
  kParameters = 3,         // what was saved; only in the ItemStore
  kFactoryParameters = 4,  // what the robot leaves the factory with; only in the catalogue
  kNodeId = 5,             // of a drive or sensor: one byte
};

inline constexpr std::size_t kMaxMotions = 32;

// The result of a function that may write flash. canopen/stored_parameters.h maps it to SDO abort codes.
enum class [[nodiscard]] Status : std::uint8_t{
    kOk,
    kBusy,        // the flash is not ready: nothing was done, call again a millisecond later
    kInUse,       // another item is being written
    kNotAllowed,  // the caller does not permit flash to be written now
    kFull,        // no free slot, or no storage at all
    kTooLong,     // the item does not fit into a slot
    kFailed,      // the flash failed; the next attempt takes another slot
};

}  // namespace koboshi::storage
