#include "base/file/standard_streams.h"
#include "cli/commands.h"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>

#include "base/file/output_file.h"
#include "base/text/text.h"
#include "bus/can/frame_text.h"
#include "bus/can/sdo_transfer.h"
#include "cli/options.h"

namespace koboshi::cli {
namespace {

struct CanSdoArguments {
  std::string node;
  std::string object;
  std::string value;
  std::string type;
  std::filesystem::path file;
  bus::SdoChannel channel = bus::SdoChannel::kAutomatic;
  CanOptions can;
};

bus::SdoTransfer open_transfer(const CanSdoArguments& arguments, sim_board::Transport& transport) {
  return bus::open_sdo(transport, parse_node(arguments.node), arguments.channel);
}

// Parses 2101:1, 0x2101:0x1 or 1008, all hexadecimal.
canopen::ObjectAddress parse_object(const std::string& text) {
  const std::size_t colon = text.find(':');
  const std::string index = text.substr(0, colon);
  const std::string subindex = colon == std::string::npos ? "0" : text.substr(colon + 1);
  return {static_cast<std::uint16_t>(bus::parse_hexadecimal(index, "the object's index", 0xFFFF, 4)),
          static_cast<std::uint8_t>(bus::parse_hexadecimal(subindex, "the sub-index", 0xFF, 0))};
}

bool is_text(const std::vector<std::uint8_t>& data) {
  return data.size() > 4 &&
         std::ranges::all_of(data, [](std::uint8_t byte) { return std::isprint(byte) != 0; });
}

void print_value(const std::vector<std::uint8_t>& data) {
  if (is_text(data)) {
    fmt::print("{}\n", std::string(data.begin(), data.end()));
    return;
  }
  if (data.size() > 4) {
    for (const std::uint8_t byte : data) fmt::print("{:02X}", byte);
    fmt::print("\n");
    return;
  }
  std::uint32_t number = 0;
  for (std::size_t i = 0; i < data.size(); ++i) number |= static_cast<std::uint32_t>(data[i]) << (8 * i);
  const int bits = 8 * static_cast<int>(data.size());
  fmt::print("0x{:0{}X} = {}", number, 2 * data.size(), number);
  const std::int64_t negative = static_cast<std::int64_t>(number) - (std::int64_t{1} << bits);
  if (bits > 0 && (number >> (bits - 1)) != 0) fmt::print(" or {}", negative);
  fmt::print("\n");
}

// The little-endian bytes of a number, in two's complement.
std::vector<std::uint8_t> number_bytes(const std::string& text, std::size_t size) {
  const bool negative = text.starts_with('-');
  const std::uint64_t most =
      negative ? std::uint64_t{1} << (8 * size - 1) : (std::uint64_t{1} << (8 * size)) - 1;
  std::uint64_t value = bus::parse_number(negative ? text.substr(1) : text, "the value", most);
  if (negative) value = ~value + 1;
  std::vector<std::uint8_t> data(size);
  for (std::size_t i = 0; i < size; ++i) data[i] = static_cast<std::uint8_t>(value >> (8 * i));
  return data;
}

// The bytes of a value whose type is given; nothing without a type.
std::optional<std::vector<std::uint8_t>> typed_bytes(const CanSdoArguments& arguments) {
  if (arguments.type.empty()) return {};
  if (arguments.type == "text")
    return std::vector<std::uint8_t>(arguments.value.begin(), arguments.value.end());
  return number_bytes(arguments.value, static_cast<std::size_t>(std::stoi(arguments.type.substr(1)) / 8));
}

// The bytes of a number of the size that the object has now.
std::vector<std::uint8_t> untyped_bytes(const CanSdoArguments& arguments, bus::SdoTransfer& transfer,
                                        canopen::ObjectAddress address) {
  const std::size_t size = transfer.read(address).size();
  if (size == 0 || size > 4)
    throw std::invalid_argument("found an object of " + std::to_string(size) +
                                " bytes, expected --type or a download");
  return number_bytes(arguments.value, size);
}

// Prints the progress of a transfer on a terminal, and nothing into a pipe.
bus::SdoProgress progress_of(const char* what) {
  if (isatty(STDERR_FILENO) == 0) return {};
  return [what](std::size_t done, std::size_t total) {
    if (total == 0) {
      print_error("\r{} {} bytes ", what, done);
    } else {
      print_error("\r{} {} of {} bytes ({} %) ", what, done, total, 100 * done / total);
      if (done >= total) print_error("\n");
    }
  };
}

void write_file(const std::filesystem::path& file, const std::vector<std::uint8_t>& data) {
  write_whole_file(file, {reinterpret_cast<const char*>(data.data()), data.size()});
}

std::vector<std::uint8_t> read_file(const std::filesystem::path& file) {
  const std::string bytes = read_text_file(file, "a file to download");
  return {bytes.begin(), bytes.end()};
}

CLI::App* add(CLI::App& sdo, const char* name, const char* text,
              const std::shared_ptr<CanSdoArguments>& arguments) {
  CLI::App* command = sdo.add_subcommand(name, text);
  command->add_option("NODE", arguments->node, "1 to 127, decimal")->required()->check(taken_by(parse_node));
  command->add_option("OBJECT", arguments->object, "Index and sub-index, hexadecimal: 1018:1")
      ->required()
      ->check(taken_by(parse_object));
  add_sdo_options(*command, arguments->channel);
  add_can_options(*command, arguments->can);
  return command;
}

}  // namespace

void add_can_sdo_command(CLI::App& can, Invocation&) {
  CLI::App* sdo = can.add_subcommand("sdo", "Read and write the objects of a node");
  sdo->require_subcommand(1);
  auto arguments = std::make_shared<CanSdoArguments>();

  add(*sdo, "read", "Show the value of an object", arguments)->callback([arguments] {
    const auto address = parse_object(arguments->object);
    const auto transport = open_can(arguments->can);
    print_value(open_transfer(*arguments, *transport).read(address));
  });

  CLI::App* write = add(*sdo, "write", "Write the value of an object", arguments);
  write->add_option("VALUE", arguments->value, "A number, decimal or 0x..., or a text")->required();
  write
      ->add_option("--type", arguments->type,
                   "u8, i8, u16, i16, u32, i32 or text (default: a number of the object's size)")
      ->check(CLI::IsMember({"u8", "i8", "u16", "i16", "u32", "i32", "text"}));
  write->callback([arguments] {
    const auto address = parse_object(arguments->object);
    const auto bytes = typed_bytes(*arguments);
    if (!bytes) static_cast<void>(number_bytes(arguments->value, 4));  // refuses it before the bus is opened
    const auto transport = open_can(arguments->can);
    bus::SdoTransfer transfer = open_transfer(*arguments, *transport);
    transfer.write(address, bytes ? *bytes : untyped_bytes(*arguments, transfer, address));
  });

  CLI::App* upload = add(*sdo, "upload", "Read a large object into a file, by block transfer", arguments);
  upload->add_option("FILE", arguments->file, "The file for the object's bytes")->required();
  upload->callback([arguments] {
    const auto address = parse_object(arguments->object);
    const auto transport = open_can(arguments->can);
    write_file(arguments->file, open_transfer(*arguments, *transport).upload(address, progress_of("read")));
  });

  CLI::App* download =
      add(*sdo, "download", "Write a file into a large object, by block transfer", arguments);
  download->add_option("FILE", arguments->file, "The file to write into the object")->required();
  download->callback([arguments] {
    const auto address = parse_object(arguments->object);
    const std::vector<std::uint8_t> data = read_file(arguments->file);
    const auto transport = open_can(arguments->can);
    open_transfer(*arguments, *transport).download(address, data, progress_of("wrote"));
  });
}

}  // namespace koboshi::cli
