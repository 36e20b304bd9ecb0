#include "hal/lockstep/batch.h"

namespace koboshi::hal {
namespace {

constexpr std::uint8_t kRemoteBit = 0x80;  // in the size byte of a frame
constexpr std::uint8_t kRecoverBit = 0x01;
constexpr std::uint8_t kKickedBit = 0x02;
constexpr std::uint8_t kEnabledBit = 0x04;

// Appends little-endian integers. Past the end of the buffer it writes nothing and records the error.
class Writer {
 public:
  explicit Writer(std::span<std::byte> bytes) : bytes_(bytes) {}

  template <typename Unsigned>
  void put(Unsigned value) {
    if (bytes_.size() - length_ < sizeof(Unsigned)) overflown_ = true;
    if (overflown_) return;
    for (std::size_t i = 0; i < sizeof(Unsigned); ++i) {
      bytes_[length_++] = static_cast<std::byte>((value >> (8 * i)) & 0xFF);
    }
  }
  void put_axes(const std::array<std::int16_t, 3>& axes) {
    for (const std::int16_t axis : axes) put(static_cast<std::uint16_t>(axis));
  }
  [[nodiscard]] std::size_t length() const { return overflown_ ? 0 : length_; }

 private:
  std::span<std::byte> bytes_;
  std::size_t length_ = 0;
  bool overflown_ = false;
};

// Reads little-endian integers. After a missing or out-of-range value it returns zeros, and `complete`
// returns false.
class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  template <typename Unsigned>
  Unsigned get() {
    if (bytes_.size() < sizeof(Unsigned)) valid_ = false;
    if (!valid_) return 0;
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < sizeof(Unsigned); ++i) {
      value |= std::to_integer<std::uint64_t>(bytes_[i]) << (8 * i);
    }
    bytes_ = bytes_.subspan(sizeof(Unsigned));
    return static_cast<Unsigned>(value);
  }
  template <typename Unsigned>
  Unsigned get_at_most(Unsigned limit) {
    const auto value = get<Unsigned>();
    require(value <= limit);
    return valid_ ? value : Unsigned{0};
  }
  bool get_bool() { return get_at_most<std::uint8_t>(1) == 1; }
  void get_axes(std::array<std::int16_t, 3>& axes) {
    for (std::int16_t& axis : axes) axis = static_cast<std::int16_t>(get<std::uint16_t>());
  }
  void require(bool condition) { valid_ = valid_ && condition; }
  // Returns whether every field was present and valid and no bytes follow.
  [[nodiscard]] bool complete() const { return valid_ && bytes_.empty(); }

 private:
  std::span<const std::byte> bytes_;
  bool valid_ = true;
};

void put(Writer& writer, const CanFrame& frame) {
  writer.put(frame.identifier);
  writer.put(static_cast<std::uint8_t>(frame.size | (frame.remote ? kRemoteBit : 0)));
  for (const std::uint8_t byte : frame.data) writer.put(byte);
}

void get(Reader& reader, CanFrame& frame) {
  frame.identifier = reader.get_at_most<std::uint16_t>(0x7FF);
  const auto control = reader.get<std::uint8_t>();
  frame.remote = (control & kRemoteBit) != 0;
  frame.size = static_cast<std::uint8_t>(control & ~kRemoteBit);
  reader.require(frame.size <= frame.data.size());
  for (std::uint8_t& byte : frame.data) byte = reader.get<std::uint8_t>();
}

void put(Writer& writer, const ImuSample& sample) {
  writer.put(sample.time_us);
  writer.put_axes(sample.gyro_raw);
  writer.put_axes(sample.accelerometer_raw);
}

void get(Reader& reader, ImuSample& sample) {
  sample.time_us = reader.get<std::uint32_t>();
  reader.get_axes(sample.gyro_raw);
  reader.get_axes(sample.accelerometer_raw);
}

void put(Writer& writer, const AnkleSample& sample) {
  writer.put(sample.time_us);
  writer.put_axes(sample.force_raw);
  writer.put_axes(sample.torque_raw);
}

void get(Reader& reader, AnkleSample& sample) {
  sample.time_us = reader.get<std::uint32_t>();
  reader.get_axes(sample.force_raw);
  reader.get_axes(sample.torque_raw);
}

void put(Writer& writer, const CanStatus& status) {
  writer.put(static_cast<std::uint8_t>(status.state));
  writer.put(status.transmit_error_count);
  writer.put(status.receive_error_count);
  writer.put(status.receive_overruns);
}

void get(Reader& reader, CanStatus& status) {
  constexpr auto kLast = static_cast<std::uint8_t>(CanErrorState::kBusOff);
  status.state = static_cast<CanErrorState>(reader.get_at_most<std::uint8_t>(kLast));
  status.transmit_error_count = reader.get<std::uint8_t>();
  status.receive_error_count = reader.get<std::uint8_t>();
  status.receive_overruns = reader.get<std::uint16_t>();
}

template <typename T, std::size_t kCapacity>
void put(Writer& writer, const BoundedList<T, kCapacity>& list) {
  writer.put(list.size);
  for (const T& item : list.view()) put(writer, item);
}

template <typename T, std::size_t kCapacity>
void get(Reader& reader, BoundedList<T, kCapacity>& list) {
  list.size = reader.get_at_most<std::uint16_t>(kCapacity);
  for (std::size_t i = 0; i < list.size; ++i) get(reader, list.items[i]);
}

}  // namespace

std::size_t encode(const BatchInput& input, std::span<std::byte> bytes) {
  Writer writer(bytes);
  writer.put(input.now_us);
  writer.put(static_cast<std::uint8_t>(input.tick));
  put(writer, input.can_status);
  for (const std::uint16_t space : input.transmit_space) writer.put(space);
  for (const bool pending : input.transmit_pending) writer.put(static_cast<std::uint8_t>(pending));
  writer.put(input.imu_overruns);
  put(writer, input.frames);
  put(writer, input.imu);
  for (const bool fresh : input.ankle_fresh) writer.put(static_cast<std::uint8_t>(fresh));
  for (const AnkleSample& ankle : input.ankles) put(writer, ankle);
  return writer.length();
}

bool decode(std::span<const std::byte> bytes, BatchInput& input) {
  Reader reader(bytes);
  input.now_us = reader.get<std::uint64_t>();
  input.tick = reader.get_bool();
  get(reader, input.can_status);
  for (std::uint16_t& space : input.transmit_space) space = reader.get<std::uint16_t>();
  for (bool& pending : input.transmit_pending) pending = reader.get_bool();
  input.imu_overruns = reader.get<std::uint16_t>();
  get(reader, input.frames);
  get(reader, input.imu);
  for (bool& fresh : input.ankle_fresh) fresh = reader.get_bool();
  for (AnkleSample& ankle : input.ankles) get(reader, ankle);
  return reader.complete();
}

std::size_t encode(const BatchOutput& output, std::span<std::byte> bytes) {
  Writer writer(bytes);
  put(writer, output.frames);
  writer.put(static_cast<std::uint8_t>((output.recover ? kRecoverBit : 0) |
                                       (output.watchdog_kicked ? kKickedBit : 0) |
                                       (output.drive_enabled ? kEnabledBit : 0)));
  return writer.length();
}

bool decode(std::span<const std::byte> bytes, BatchOutput& output) {
  Reader reader(bytes);
  get(reader, output.frames);
  const auto flags = reader.get_at_most<std::uint8_t>(kRecoverBit | kKickedBit | kEnabledBit);
  output.recover = (flags & kRecoverBit) != 0;
  output.watchdog_kicked = (flags & kKickedBit) != 0;
  output.drive_enabled = (flags & kEnabledBit) != 0;
  return reader.complete();
}

}  // namespace koboshi::hal
