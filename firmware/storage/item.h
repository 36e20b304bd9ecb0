#pragma once

#include <cstddef>
#include <cstdint>

namespace koboshi::storage {

// The kind of an item. Kind and number identify it; both are stored in flash, so new kinds are appended.
enum class ItemKind : std::uint16_t {
  kRobotModel = 1,
  kMotion = 2,             // numbers 0 to kMaxMotions - 1
  kParameters = 3,         // what was saved; only in the ItemStore
  kFactoryParameters = 4,  // what the robot leaves the factory with; only in the catalogue
  kNodeId = 5,             // of a drive or sensor: one byte
  kPolicy = 6,             // of the walk: a learned controller; number 0
};

inline constexpr std::size_t kMaxMotions = 200;

// Readers that can pin an item, so that it keeps its place while they read it. Each pins at most one.
enum class Holder : std::uint8_t { kPlayer = 0, kSecondPlayer = 1, kTransfer = 2 };
inline constexpr std::size_t kHolders = 3;

// The result of a function that may write flash. canopen/stored_parameters.h maps it to SDO abort codes.
enum class [[nodiscard]] Status : std::uint8_t{
    kOk,
    kBusy,        // the flash is not ready: nothing was done, call again a millisecond later
    kInUse,       // another item is being written, or one that is being read occupies the space
    kNotAllowed,  // the caller does not permit flash to be written now
    kFull,        // the item does not fit beside those that are stored, or there is no storage at all
    kTooLong,     // more bytes than announced, or than any item may have
    kFailed,      // the flash failed; the next attempt uses another place
};

}  // namespace koboshi::storage
