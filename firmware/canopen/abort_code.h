#pragma once

#include <cstdint>

namespace koboshi::canopen {

// Why an SDO transfer was refused or broken off (CiA 301, table 22). Two are ours: kNone, nothing went wrong;
// and kBusy, which never reaches the bus: not done yet, to be asked again in a millisecond.
enum class [[nodiscard]] AbortCode : std::uint32_t{
    kNone = 0,
    kBusy = 1,
    kToggleBitNotAlternated = 0x05030000,
    kTimedOut = 0x05040000,
    kCommandSpecifierUnknown = 0x05040001,
    kInvalidBlockSize = 0x05040002,
    kInvalidSequenceNumber = 0x05040003,
    kCrcError = 0x05040004,
    kOutOfMemory = 0x05040005,
    kUnsupportedAccess = 0x06010000,
    kReadOfWriteOnly = 0x06010001,
    kWriteOfReadOnly = 0x06010002,
    kObjectDoesNotExist = 0x06020000,
    kNotMappable = 0x06040041,
    kPdoLengthExceeded = 0x06040042,
    kParameterIncompatibility = 0x06040043,
    kInternalIncompatibility = 0x06040047,
    kHardwareError = 0x06060000,
    kLengthMismatch = 0x06070010,
    kLengthTooHigh = 0x06070012,
    kLengthTooLow = 0x06070013,
    kSubindexDoesNotExist = 0x06090011,
    kInvalidValue = 0x06090030,
    kValueTooHigh = 0x06090031,
    kValueTooLow = 0x06090032,
    kMaximumBelowMinimum = 0x06090036,
    kResourceNotAvailable = 0x060A0023,
    kGeneralError = 0x08000000,
    kCannotTransfer = 0x08000020,
    kLocalControl = 0x08000021,
    kDeviceState = 0x08000022,
    kNoDictionary = 0x08000023,
    kNoData = 0x08000024,
};

}  // namespace koboshi::canopen
