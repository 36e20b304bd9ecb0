#include "bus/can/configuration.h"

#include <fmt/core.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <span>

#include "firmware/canopen/frame.h"

namespace koboshi::bus {
namespace {

using Data = std::vector<std::uint8_t>;

constexpr std::uint16_t kStore = 0x1010;
constexpr std::uint16_t kRestore = 0x1011;

// A number with all its digits, a text in quotes, or bytes.
std::string value_text(const FileObject& object, const Data& data) {
  if (object.is_text) return "'" + std::string(data.begin(), std::ranges::find(data, 0)) + "'";
  std::string text = data.size() <= 8 ? "0x" : "";
  const auto append = [&text](std::uint8_t byte) { text += fmt::format("{:02X}", byte); };
  if (data.size() <= 8) {
    std::for_each(data.rbegin(), data.rend(), append);
  } else {
    std::ranges::for_each(data, append);
  }
  return data.empty() ? "empty" : text;
}

std::string place_text(const FileObject& object) {
  return fmt::format("{:04X}:{:02X} {}", object.address.index, object.address.subindex, object.name);
}

constexpr canopen::ObjectAddress kSyncPeriod{0x1006, 0};
constexpr std::uint16_t kSyncCounterOverflow = 0x1019;
constexpr std::uint16_t kVerification = 0x1020;
constexpr std::uint32_t kAllBits = 0xFFFF'FFFF;
constexpr std::uint32_t kCobIdProduced = 1u << 30;  // SYNC and TIME: the node sends the message

// A PDO has its communication parameters 0x200 below its mapping.
bool is_pdo(std::uint16_t index) { return index >= 0x1400 && index <= 0x1BFF; }
std::uint16_t pdo_of(std::uint16_t index) { return static_cast<std::uint16_t>(index & ~0x200u); }
bool is_mapping(std::uint16_t index) { return is_pdo(index) && (index & 0x200) != 0; }

// Objects that lock others, or their own identifier, while they are in use (CiA 301): the present value with
// these bits kept and set releases what they lock.
struct Lock {
  std::uint16_t first_index;
  std::uint16_t last_index;
  std::uint8_t first_subindex;
  std::uint8_t last_subindex;
  std::uint32_t kept;
  std::uint32_t set;
};
constexpr Lock kLocks[] = {
    {0x1005, 0x1005, 0, 0, ~kCobIdProduced, 0},                             // COB-ID SYNC, 7.5.2.5
    {0x1006, 0x1006, 0, 0, 0, 0},                                           // locks 1019, 7.5.2.22
    {0x1012, 0x1012, 0, 0, ~(canopen::kCobIdInvalid | kCobIdProduced), 0},  // COB-ID TIME, 7.5.2.15
    {0x1014, 0x1014, 0, 0, kAllBits, canopen::kCobIdInvalid},               // COB-ID EMCY, 7.5.2.17
    {0x1016, 0x1016, 1, 0x7F, 0, 0},  // heartbeat consumers: no two monitor the same node, 7.5.2.19
    {0x1028, 0x1028, 1, 0x7F, kAllBits, canopen::kCobIdInvalid},  // emergency consumers, 7.5.2.31
    {0x1200, 0x12FF, 1, 2, kAllBits, canopen::kCobIdInvalid},     // SDO servers and clients, 7.5.2.33, 34
    {0x1400, 0x15FF, 1, 1, kAllBits, canopen::kCobIdInvalid},     // RPDOs, 7.5.2.35
    {0x1600, 0x17FF, 0, 0, 0, 0},                                 // their mapping, 7.5.2.36
    {0x1800, 0x19FF, 1, 1, kAllBits, canopen::kCobIdInvalid},     // TPDOs, 7.5.2.37
    {0x1A00, 0x1BFF, 0, 0, 0, 0},                                 // their mapping, 7.5.2.38
};

const Lock* lock_at(canopen::ObjectAddress address) {
  const auto* found = std::ranges::find_if(kLocks, [&](const Lock& lock) {
    return lock.first_index <= address.index && address.index <= lock.last_index &&
           lock.first_subindex <= address.subindex && address.subindex <= lock.last_subindex;
  });
  return found == std::end(kLocks) ? nullptr : found;
}

// Returns the objects that lock this one.
std::vector<canopen::ObjectAddress> locks_of(canopen::ObjectAddress address) {
  if (is_mapping(address.index)) return {{pdo_of(address.index), 1}, {address.index, 0}};
  if (is_pdo(address.index)) return {{address.index, 1}};
  if (address.index == kSyncCounterOverflow) return {kSyncPeriod};
  if (address != kSyncPeriod && lock_at(address) != nullptr) return {address};
  return {};
}

bool is_compared(const DeviceFile& file, const FileObject& object) {
  return object.readable && object.value && (object.is_parameter || !file.is_dcf);
}

// A node may end a text with zeros.
bool equal(const FileObject& object, const Data& read) {
  if (!object.is_text) return read == *object.value;
  return std::ranges::equal(std::span(read.begin(), std::ranges::find(read, 0)), *object.value);
}

class Configurator {
 public:
  Configurator(SdoTransfer& sdo, const DeviceFile& file) : sdo_(sdo), file_(file) {}

  void compare() {
    for (const FileObject& object : file_.objects) {
      if (!is_compared(file_, object)) {
        ++report_.left_out;
        continue;
      }
      ++report_.compared;
      try {
        const Data read = sdo_.read(object.address);
        if (!equal(object, read))
          add(object, fmt::format("{} in the file, {} in the node", value_text(object, *object.value),
                                  value_text(object, read)));
      } catch (const SdoAborted& aborted) {
        add(object, aborted.what());
      }
    }
  }

  // Writes in the order that CiA 301 demands: releases all locks of what changes, by ascending address;
  // writes the values; sets the locks again in the reverse order; and at last the record 1020, which each
  // write of another object resets.
  void write() {
    const Changes changes = find_changes();
    const std::map<canopen::ObjectAddress, Data> former = release(changes);
    for (const auto& [address, object] : changes) {
      if (!former.contains(address)) set(*object);
    }
    for (auto lock = former.rbegin(); lock != former.rend(); ++lock) set_again(lock->first, lock->second);
    for (const FileObject& object : file_.objects) {
      if (object.address.index == kVerification && is_written(object) &&
          (report_.written > 0 || !has(object)))
        set(object);
    }
  }

  ConfigurationReport report() const { return report_; }

 private:
  void add(const FileObject& object, const std::string& text) {
    report_.differences.push_back(place_text(object) + ": " + text);
  }

  // Whether the node has the value of the file already.
  bool has(const FileObject& object) {
    if (!object.readable) return false;
    try {
      return equal(object, sdo_.read(object.address));
    } catch (const SdoAborted&) {
      return false;
    }
  }

  // Writes the value of the file; false if the node refuses it.
  bool set(const FileObject& object) {
    try {
      sdo_.write(object.address, *object.value);
      ++report_.written;
      return true;
    } catch (const SdoAborted& aborted) {
      add(object, fmt::format("writing {}: {}", value_text(object, *object.value), aborted.what()));
      return false;
    }
  }

  using Changes = std::map<canopen::ObjectAddress, const FileObject*>;

  bool is_written(const FileObject& object) const {
    const bool stores = object.address.index == kStore || object.address.index == kRestore;
    return object.writable && object.is_parameter && object.value && !stores;
  }

  // The objects whose values the node has not yet, without 1020. A mapping changes as a whole: a node may
  // clear its entries with their number.
  Changes find_changes() {
    Changes changes;
    std::set<std::uint16_t> mappings;
    for (const FileObject& object : file_.objects) {
      if (!is_written(object) || object.address.index == kVerification || has(object)) continue;
      if (is_own_channel(object.address)) {
        add(object, "not written, it is of the SDO channel in use: use --first or --second");
        continue;
      }
      changes[object.address] = &object;
      if (is_mapping(object.address.index)) mappings.insert(object.address.index);
    }
    for (const FileObject& object : file_.objects) {
      if (is_written(object) && mappings.contains(object.address.index)) changes[object.address] = &object;
    }
    return changes;
  }

  // Whether this belongs to the SDO server that answers. Without it nothing more could be written.
  bool is_own_channel(canopen::ObjectAddress address) {
    if (address.index < 0x1200 || address.index > 0x127F) return false;
    const std::optional<Data> request = number_at({address.index, 1});
    return request && (canopen::load_u32(request->data()) & canopen::kCobIdMask) == sdo_.request_identifier();
  }

  // Releases the locks of these objects and returns their values before. A lock that cannot be read or
  // written is none, such as a fixed COB-ID.
  std::map<canopen::ObjectAddress, Data> release(const Changes& changes) {
    std::set<canopen::ObjectAddress> locks;
    for (const auto& [address, object] : changes) {
      for (const canopen::ObjectAddress lock : locks_of(address)) locks.insert(lock);
    }
    std::map<canopen::ObjectAddress, Data> former;
    for (const canopen::ObjectAddress address : locks) {
      const Lock& lock = *lock_at(address);
      const std::optional<Data> present = read(address);
      if (!present || present->size() > 4) continue;
      Data value = *present;
      value.resize(4);
      canopen::store_u32(value.data(), (canopen::load_u32(value.data()) & lock.kept) | lock.set);
      value.resize(present->size());
      if (value == *present || try_write(address, value)) former[address] = *present;
    }
    return former;
  }

  // Gives a lock its value of the file, or else the former one. If the node refuses that of the file, a PDO
  // stays disabled, as its mapping may be another one now; other objects get the former value again.
  void set_again(canopen::ObjectAddress address, const Data& former) {
    const FileObject* object = find(address);
    const bool changes = object != nullptr && *object->value != former;
    if (changes && (set(*object) || is_pdo(address.index))) return;
    try {
      sdo_.write(address, former);
    } catch (const SdoAborted& aborted) {
      add({.address = address, .name = "as before"},
          fmt::format("writing {}: {}", value_text({}, former), aborted.what()));
    }
  }

  // Returns the object of the file that is written at this address, or nullptr.
  const FileObject* find(canopen::ObjectAddress address) const {
    const auto found = std::ranges::find(file_.objects, address, &FileObject::address);
    return found != file_.objects.end() && is_written(*found) ? &*found : nullptr;
  }

  std::optional<Data> read(canopen::ObjectAddress address) {
    try {
      return sdo_.read(address);
    } catch (const SdoAborted&) {
      return std::nullopt;
    }
  }
  std::optional<Data> number_at(canopen::ObjectAddress address) {
    std::optional<Data> data = read(address);
    return data && data->size() == 4 ? data : std::nullopt;
  }
  bool try_write(canopen::ObjectAddress address, const Data& data) {
    try {
      sdo_.write(address, data);
      return true;
    } catch (const SdoAborted&) {
      return false;
    }
  }

  SdoTransfer& sdo_;
  const DeviceFile& file_;
  ConfigurationReport report_;
};

}  // namespace

ConfigurationReport compare_configuration(SdoTransfer& sdo, const DeviceFile& file) {
  Configurator configurator(sdo, file);
  configurator.compare();
  return configurator.report();
}

ConfigurationReport write_configuration(SdoTransfer& sdo, const DeviceFile& file) {
  Configurator configurator(sdo, file);
  configurator.write();
  configurator.compare();
  return configurator.report();
}

}  // namespace koboshi::bus
