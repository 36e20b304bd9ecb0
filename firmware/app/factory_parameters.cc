#include "firmware/app/factory_parameters.h"

#include "firmware/storage/image.h"
#include "firmware/storage/parameter_store.h"

namespace koboshi::app {
namespace {

constexpr std::uint16_t kFirstManufacturerIndex = 0x2000;  // CiA 301, table 42
constexpr std::size_t kIdSize = 4;

struct Write {
  canopen::Location location;
  std::uint32_t value = 0;
};

// Sets `write` to what the record asks for. False where the dictionary does not take it.
bool resolve(const storage::ParameterRecord& record, const canopen::Dictionary& dictionary, Write& write) {
  write.value = record.value;
  if (record.index < kFirstManufacturerIndex || record.size_bytes == 0) return false;
  const auto checked =
      dictionary.check_write({record.index, record.subindex}, write.value, record.size_bytes, write.location);
  return checked == canopen::AbortCode::kNone && canopen::is_parameter(*write.location.entry);
}

}  // namespace

FactoryStatus load_factory_parameters(std::span<const std::byte> item, std::uint32_t model_id,
                                      canopen::Dictionary dictionary) {
  if (item.empty()) return FactoryStatus::kNone;
  storage::Image image;
  const auto opened = storage::open_image(item, kFactoryParametersMagic, kFactoryParametersVersion, image);
  if (opened != storage::ImageStatus::kOk) return FactoryStatus::kDamaged;
  storage::ImageReader reader(image.body);
  const std::uint32_t found_for = reader.u32();
  if (!reader.ok() || reader.remaining() % storage::ParameterRecord::kSize_bytes != 0)
    return FactoryStatus::kDamaged;
  if (found_for != model_id) return FactoryStatus::kOtherModel;
  const auto records = image.body.subspan(kIdSize);
  storage::ParameterRecord record;
  Write write;
  constexpr std::size_t kSize = storage::ParameterRecord::kSize_bytes;
  for (std::size_t at = 0; storage::read_record(records, at, record); at += kSize) {
    if (!resolve(record, dictionary, write)) return FactoryStatus::kRefused;
  }
  for (std::size_t at = 0; storage::read_record(records, at, record); at += kSize) {
    if (resolve(record, dictionary, write)) dictionary.store(write.location, write.value);
  }
  return FactoryStatus::kLoaded;
}

}  // namespace koboshi::app
