#include "tests/support/robot_storage.h"

#include <cstdlib>

#include "firmware/storage/catalogue.h"
#include "firmware/storage/image.h"
#include "tests/unit/firmware/motion/motion_builder.h"

namespace koboshi::test {
namespace {

std::vector<std::byte> begin_image(std::uint32_t magic, std::uint16_t version) {
  std::vector<std::byte> image;
  put(image, magic, 4);
  put(image, version, 4);  // plus the reserved field
  image.resize(storage::kImageHeaderSize);
  return image;
}

}  // namespace

std::vector<std::byte> encode(const TestMotion& motion, std::uint32_t model_id) {
  const std::size_t joints = motion.poses.empty() ? 0 : motion.poses.front().size();
  MotionBuilder builder(model_id);
  builder.name = motion.name;
  builder.joint_count = static_cast<std::uint8_t>(joints);
  for (const auto& pose : motion.poses) {
    std::vector<std::int32_t> numbers;
    for (const fixed::Angle angle : pose) numbers.push_back(motion::pose_number(angle));
    builder.packed_pose((1u << joints) - 1, std::move(numbers));
  }
  builder.steps = motion.steps;
  return builder.image();
}

std::vector<std::byte> encode(const app::ControllerValues& values, std::uint32_t model_id) {
  std::vector<std::byte> image = begin_image(app::kFactoryParametersMagic, app::kFactoryParametersVersion);
  put(image, model_id, 4);
  app::ControllerValues neutral;
  app::ControllerValues robot = values;
  const auto rows = app::kControllerNode.rows;
  const canopen::Dictionary defaults(rows, std::as_writable_bytes(std::span(&neutral, 1)));
  const canopen::Dictionary dictionary(rows, std::as_writable_bytes(std::span(&robot, 1)));
  for (const canopen::Entry& row : rows) {
    for (std::size_t i = 0; canopen::is_parameter(row) && i < row.count; ++i) {
      const canopen::ObjectAddress address{row.index, static_cast<std::uint8_t>(row.subindex + i)};
      canopen::ObjectValue value;
      canopen::ObjectValue default_value;
      if (dictionary.read(address, value) != canopen::AbortCode::kNone ||
          defaults.read(address, default_value) != canopen::AbortCode::kNone)
        std::abort();
      if (value.number() == default_value.number()) continue;
      put(image, address.index, 2);
      put(image, address.subindex, 1);
      put(image, value.size(), 1);
      put(image, value.number(), 4);
    }
  }
  seal(image);
  return image;
}

std::vector<std::byte> make_storage(std::span<const std::byte> model,
                                    std::span<const std::vector<std::byte>> motions,
                                    std::span<const std::byte> parameters) {
  std::vector<std::byte> catalogue = begin_image(storage::kCatalogueMagic, storage::kCatalogueVersion);
  const std::size_t count = 1 + motions.size() + (parameters.empty() ? 0 : 1);
  std::size_t offset = storage::kImageHeaderSize + 4 + count * storage::kCatalogueItemSize;
  put(catalogue, static_cast<std::uint32_t>(count), 4);  // plus the reserved field
  const auto add = [&](storage::ItemKind kind, std::size_t number, std::size_t size) {
    put(catalogue, static_cast<std::uint32_t>(kind), 2);
    put(catalogue, static_cast<std::uint32_t>(number), 2);
    put(catalogue, static_cast<std::uint32_t>(offset), 4);
    put(catalogue, static_cast<std::uint32_t>(size), 4);
    offset += size;
  };
  add(storage::ItemKind::kRobotModel, 0, model.size());
  if (!parameters.empty()) add(storage::ItemKind::kFactoryParameters, 0, parameters.size());
  for (std::size_t i = 0; i < motions.size(); ++i) add(storage::ItemKind::kMotion, i, motions[i].size());
  seal(catalogue);
  catalogue.insert(catalogue.end(), model.begin(), model.end());
  catalogue.insert(catalogue.end(), parameters.begin(), parameters.end());
  for (const auto& motion : motions) catalogue.insert(catalogue.end(), motion.begin(), motion.end());
  return catalogue;
}

}  // namespace koboshi::test
