#include "simulation/policy/policy_image.h"

#include "simulation/model/image_writer.h"

namespace koboshi::simulation {
namespace {

using policy::padded;

std::int8_t weight_at(const PolicyLayer& layer, std::size_t row, std::size_t column) {
  return row < layer.rows && column < layer.columns ? layer.weights[row * layer.columns + column]
                                                    : std::int8_t{0};
}

void write_weights(const PolicyLayer& layer, ImageWriter& image) {
  for (std::size_t row = 0; row < padded(layer.rows); row += policy::kRowsAtOnce) {
    for (std::size_t column = 0; column < padded(layer.columns); column += 2) {
      for (const std::size_t pair : {row, row + 2}) {
        for (const std::size_t c : {column, column + 1}) {
          image.u16(static_cast<std::uint16_t>(
              policy::packed_weights(weight_at(layer, pair, c), weight_at(layer, pair + 1, c))));
        }
      }
    }
  }
}

}  // namespace

std::vector<std::byte> make_policy_image(const PolicyContents& contents) {
  ImageWriter image;
  const auto i32 = [&](std::int32_t value) { image.u32(static_cast<std::uint32_t>(value)); };
  image.u32(contents.model_id);
  for (std::size_t i = 0; i < policy::kPolicyNameSize; ++i)
    image.u8(i < contents.name.size() ? static_cast<std::uint8_t>(contents.name[i]) : std::uint8_t{0});
  image.u8(static_cast<std::uint8_t>(contents.inputs.size()));
  image.u8(static_cast<std::uint8_t>(contents.outputs.size()));
  image.u8(static_cast<std::uint8_t>(contents.layers.size()));
  image.u8(contents.patience_ticks);
  for (std::size_t i = 0; i < padded(contents.inputs.size()); ++i)
    image.u8(i < contents.inputs.size() ? contents.inputs[i].signal : std::uint8_t{0});
  for (const policy::Input& input : contents.inputs) {
    for (const std::int32_t field : {input.mean, input.multiplier, input.low, input.high}) i32(field);
  }
  for (const policy::Output& output : contents.outputs) {
    for (const std::int32_t field :
         {std::int32_t{output.joint}, output.scale, output.bound.raw(), output.rate.raw()})
      i32(field);
  }
  for (const PolicyLayer& layer : contents.layers) {
    image.u8(static_cast<std::uint8_t>(padded(layer.rows)));
    image.u8(static_cast<std::uint8_t>(layer.activation));
    image.u8(static_cast<std::uint8_t>(layer.fraction_bits));
    image.u8(0);
    i32(layer.multiplier);
  }
  for (const PolicyLayer& layer : contents.layers) {
    for (std::size_t row = 0; row < padded(layer.rows); ++row) i32(row < layer.rows ? layer.biases[row] : 0);
    write_weights(layer, image);
  }
  return image.finish(policy::kPolicyMagic, policy::kPolicyVersion);
}

}  // namespace koboshi::simulation
