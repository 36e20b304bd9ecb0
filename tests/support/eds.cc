#include "tests/support/eds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <ios>
#include <ostream>
#include <set>

#include "firmware/canopen/pdo.h"

namespace koboshi::test {
namespace {

using canopen::DataType;
using canopen::Entry;
using canopen::ObjectAddress;
using Section = std::map<std::string, std::string>;

std::int64_t number(const std::string& text) { return std::stoll(text, nullptr, 0); }

// The number of a default that may be relative to the node id.
std::int64_t without_node_id(const std::string& text) {
  constexpr std::string_view kNodeId = "$NODEID+";
  return number(text.starts_with(kNodeId) ? text.substr(kNodeId.size()) : text);
}

std::map<std::string, Section> read_sections(const std::string& name) {
  std::ifstream file(std::filesystem::path(KOBOSHI_SOURCE_DIR) / "docs/reference" / name);
  std::map<std::string, Section> sections;
  Section* section = nullptr;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with('[')) section = &sections[line.substr(1, line.find(']') - 1)];
    const std::size_t equals = line.find('=');
    if (section != nullptr && equals != std::string::npos)
      (*section)[line.substr(0, equals)] = line.substr(equals + 1);
  }
  return sections;
}

EdsValue value_of(const Section& section) {
  const auto optional = [&](const char* key) -> std::optional<std::int64_t> {
    const auto found = section.find(key);
    if (found == section.end()) return std::nullopt;
    return number(found->second);
  };
  const auto given = section.find("DefaultValue");
  return {.data_type = static_cast<unsigned>(number(section.at("DataType"))),
          .access = section.at("AccessType"),
          .low = optional("LowLimit"),
          .high = optional("HighLimit"),
          .default_value = given == section.end() ? std::string() : given->second,
          .mappable = section.at("PDOMapping") == "1"};
}

std::string access_of(const Entry& row) {
  if (row.offset == Entry::kConstant && row.type != DataType::kDomain) return "const";
  if (row.access == canopen::Access::kReadOnly) return "ro";
  if (row.access == canopen::Access::kWriteOnly) return "wo";
  return row.mappable == canopen::Mappable::kRpdo ? "rww" : "rw";
}

void expect_row(const EdsValue& expected, const Entry& row, unsigned element,
                std::span<const std::byte> values) {
  EXPECT_EQ(static_cast<unsigned>(row.type), expected.data_type);
  EXPECT_EQ(access_of(row), expected.access);
  EXPECT_EQ(row.mappable != canopen::Mappable::kNo, expected.mappable);
  EXPECT_EQ(row.limited || row.listed, expected.low.has_value());
  if (expected.low && expected.high) {
    const std::uint32_t span = row.listed ? static_cast<std::uint32_t>(std::bit_width(row.high)) - 1 : 0;
    EXPECT_EQ(canopen::integer_of(row.low, row.type), *expected.low);
    EXPECT_EQ(canopen::integer_of(row.listed ? row.low + span : row.high, row.type), *expected.high);
  }
  if (expected.default_value.empty() || !row.is_in_ram() || values.empty()) return;
  std::uint32_t raw = 0;
  std::memcpy(&raw, values.data() + row.offset + element * row.stride_bytes, canopen::size_bytes(row.type));
  EXPECT_EQ(canopen::integer_of(raw, row.type), number(expected.default_value));
}

// The value of a PDO's record that has the default 0 in the data sheet if it is not there.
std::int64_t default_at(const Eds& eds, std::size_t index, std::uint8_t subindex) {
  const auto found = eds.find({static_cast<std::uint16_t>(index), subindex});
  return found == eds.end() ? 0 : without_node_id(found->second.default_value);
}

void expect_pdos(const Eds& eds, std::span<const canopen::PdoConfiguration> pdos, std::size_t first_record) {
  for (std::size_t i = 0; i < pdos.size(); ++i) {
    SCOPED_TRACE(testing::Message() << "PDO record " << std::hex << first_record + i);
    const canopen::PdoConfiguration& pdo = pdos[i];
    if (pdo.cob_id != canopen::kCobIdInvalid) {
      EXPECT_EQ(pdo.cob_id, default_at(eds, first_record + i, 1));
      const auto cob_id = eds.find({static_cast<std::uint16_t>(first_record + i), 1});
      ASSERT_NE(cob_id, eds.end());
      EXPECT_EQ(pdo.plus_node_id, cob_id->second.default_value.starts_with("$NODEID"));
    }
    EXPECT_EQ(pdo.transmission_type, default_at(eds, first_record + i, 2));
    EXPECT_EQ(pdo.inhibit_time_100us, default_at(eds, first_record + i, 3));
    EXPECT_EQ(pdo.event_timer_ms, default_at(eds, first_record + i, 5));
    for (std::size_t object = 0; object < pdo.mapping.size(); ++object) {
      const auto subindex = static_cast<std::uint8_t>(object + 1);
      EXPECT_EQ(pdo.mapping[object], default_at(eds, first_record + canopen::kMappingRecord + i, subindex));
    }
  }
}

}  // namespace

Eds read_eds(const std::string& name) {
  Eds eds;
  for (const auto& [title, section] : read_sections(name)) {
    const bool whole = title.find_first_not_of("0123456789ABCDEF") == std::string::npos && title.size() == 4;
    const std::size_t sub = title.find("sub");
    if (!whole && sub != 4) continue;
    const auto index = static_cast<std::uint16_t>(std::stoul(title.substr(0, 4), nullptr, 16));
    if (!whole) {
      const auto subindex = static_cast<std::uint8_t>(std::stoul(title.substr(sub + 3), nullptr, 16));
      if (subindex != 0) eds[{index, subindex}] = value_of(section);
    } else if (section.contains("CompactSubObj")) {
      for (std::int64_t i = 1; i <= number(section.at("CompactSubObj")); ++i)
        eds[{index, static_cast<std::uint8_t>(i)}] = value_of(section);
    } else if (section.contains("DataType")) {
      eds[{index, 0}] = value_of(section);
    }
  }
  return eds;
}

void expect_described_by(const Eds& eds, const canopen::NodeDescription& node,
                         std::span<const std::byte> values) {
  std::set<ObjectAddress> rows;
  for (const Entry& row : node.rows) {
    for (unsigned element = 0; element < row.count; ++element) {
      const ObjectAddress address{row.index, static_cast<std::uint8_t>(row.subindex + element)};
      SCOPED_TRACE(testing::Message() << "object " << std::hex << address.index << ":" << +address.subindex);
      rows.insert(address);
      const auto expected = eds.find(address);
      ASSERT_NE(expected, eds.end()) << "is not in the data sheet";
      expect_row(expected->second, row, element, values);
    }
  }
  for (const auto& [address, value] : eds) {
    if (address.index < canopen::kFirstOwnersIndex) continue;
    EXPECT_TRUE(rows.contains(address))
        << "no row for object " << std::hex << address.index << ":" << +address.subindex;
  }
  expect_pdos(eds, node.rpdos, canopen::kFirstRpdoRecord);
  expect_pdos(eds, node.tpdos, canopen::kFirstTpdoRecord);
  EXPECT_EQ(node.device_type, without_node_id(eds.at({0x1000, 0}).default_value));
  EXPECT_EQ(node.vendor_id, without_node_id(eds.at({0x1018, 1}).default_value));
  EXPECT_EQ(node.product_code, without_node_id(eds.at({0x1018, 2}).default_value));
  EXPECT_EQ(node.revision_number, without_node_id(eds.at({0x1018, 3}).default_value));
  EXPECT_EQ(node.heartbeat_ms, without_node_id(eds.at({0x1017, 0}).default_value));
}

void expect_separate_values(std::span<const Entry> rows, std::span<const std::uint16_t> twice) {
  std::map<std::size_t, ObjectAddress> owners;
  for (const Entry& row : rows) {
    if (!row.is_in_ram()) continue;
    const std::size_t size = canopen::size_bytes(row.type);
    EXPECT_TRUE(row.count == 1 || row.stride_bytes == size) << std::hex << row.index << ":" << +row.subindex;
    for (std::size_t element = 0; element < row.count; ++element) {
      const std::size_t begin = row.offset + element * row.stride_bytes;
      if (std::ranges::find(twice, begin) != twice.end()) continue;
      EXPECT_EQ(begin % size, 0u) << std::hex << row.index << ":" << row.subindex + element;
      for (std::size_t byte = begin; byte < begin + size; ++byte) {
        const auto [owner, free] = owners.insert({byte, {row.index, row.subindex}});
        EXPECT_TRUE(free) << std::hex << row.index << ":" << row.subindex + element << " and "
                          << owner->second.index << ":" << +owner->second.subindex << " share a byte";
      }
    }
  }
}

}  // namespace koboshi::test
