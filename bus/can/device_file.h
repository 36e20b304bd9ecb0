#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "firmware/canopen/dictionary.h"

namespace koboshi::bus {

// An object in a device file, with its value as it is on the bus.
struct FileObject {
  canopen::ObjectAddress address{};
  std::string name{};
  bool readable = true;
  bool writable = false;
  bool is_domain = false;
  bool is_text = false;
  bool is_parameter = false;  // the value is a ParameterValue, not a DefaultValue
  std::optional<std::vector<std::uint8_t>> value{};
};

// An electronic data sheet (EDS) or a device configuration file (DCF), CiA 306-1.
struct DeviceFile {
  bool is_dcf = false;  // it has ParameterValues or the section DeviceComissioning
  std::optional<std::uint32_t> vendor_id{};
  std::optional<std::uint32_t> product_code{};
  std::optional<std::uint8_t> node_id{};  // of DeviceComissioning
  std::vector<FileObject> objects{};      // ascending
};

// Reads a file for the node with this id, which $NODEID stands for. Throws InputError with the line.
DeviceFile read_device_file(const std::filesystem::path& file, std::uint8_t node_id);

}  // namespace koboshi::bus
