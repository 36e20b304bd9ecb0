#include "bus/can/configuration.h"

#include <fmt/core.h>

#include <algorithm>
#include <map>
#include <optional>
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

// A PDO has its communication parameters 0x200 below its mapping.
bool is_pdo(std::uint16_t index) { return index >= 0x1400 && index <= 0x1BFF; }
std::uint16_t pdo_of(std::uint16_t index) { return static_cast<std::uint16_t>(index & ~0x200u); }
bool is_mapping(std::uint16_t index) { return is_pdo(index) && (index & 0x200) != 0; }

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

  void write() {
    std::map<std::uint16_t, std::vector<const FileObject*>> pdos;  // parameters, then mapping
    for (const FileObject& object : file_.objects) {
      const bool stores = object.address.index == kStore || object.address.index == kRestore;
      if (!object.writable || !object.is_parameter || !object.value || stores) continue;
      if (is_pdo(object.address.index)) {
        pdos[pdo_of(object.address.index)].push_back(&object);
      } else if (!has(object)) {
        set(object);
      }
    }
    for (const auto& [index, objects] : pdos) {
      if (!std::ranges::all_of(objects, [this](const FileObject* object) { return has(*object); }))
        write_pdo(index, objects);
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

  void set(const FileObject& object) { set(object, *object.value); }
  void set(const FileObject& object, const Data& data) {
    try {
      sdo_.write(object.address, data);
      ++report_.written;
    } catch (const SdoAborted& aborted) {
      add(object, fmt::format("writing {}: {}", value_text(object, data), aborted.what()));
    }
  }

  // Disables the PDO, writes its parameters and its mapping without and then with its number of objects, and
  // enables it if the file does.
  void write_pdo(std::uint16_t index, const std::vector<const FileObject*>& objects) {
    const FileObject* cob_id = nullptr;
    const FileObject* count = nullptr;
    for (const FileObject* object : objects) {
      if (object->address == canopen::ObjectAddress{index, 1}) cob_id = object;
      if (is_mapping(object->address.index) && object->address.subindex == 0) count = object;
    }
    const std::optional<Data> former = disable({index, 1});
    if (count != nullptr) set(*count, Data(count->value->size(), 0));
    for (const FileObject* object : objects) {
      if (object != cob_id && object != count) set(*object);
    }
    if (count != nullptr) set(*count);
    if (cob_id != nullptr) {
      set(*cob_id);
    } else if (former) {
      sdo_.write({index, 1}, *former);
    }
  }

  // Marks the COB-ID as invalid and returns what it was; nothing for a node with a fixed one.
  std::optional<Data> disable(canopen::ObjectAddress cob_id) {
    try {
      const Data former = sdo_.read(cob_id);
      if (former.size() != 4) return std::nullopt;
      Data disabled = former;
      canopen::store_u32(disabled.data(), canopen::load_u32(disabled.data()) | canopen::kCobIdInvalid);
      sdo_.write(cob_id, disabled);
      return former;
    } catch (const SdoAborted&) {
      return std::nullopt;
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
