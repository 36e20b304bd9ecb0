#pragma once

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "hal/linux/file_descriptor.h"

namespace koboshi::view {

// Encodes a film with Debian's ffmpeg. The file is whole or absent: it is written under another name and
// renamed at the end.
class Encoder {
 public:
  struct Film {
    std::filesystem::path file;  // .mp4, .gif or .webp
    int width_px = 0;
    int height_px = 0;
    double frames_per_s = 0.0;
    // Called again and again while ffmpeg lets the caller wait. It may throw, which abandons the film.
    std::function<void()> while_waiting{};
  };

  // Starts to encode. A GIF needs the palette of palette_of(). Throws InputError where there is no
  // ffmpeg, and WriteError.
  explicit Encoder(const Film& film, const std::filesystem::path& palette = {});
  // Ends ffmpeg and removes what it has written, unless finish() has returned.
  ~Encoder();
  Encoder(const Encoder&) = delete;
  Encoder& operator=(const Encoder&) = delete;

  // Adds a frame: rows from the top, four bytes a pixel: blue, green, red, unused. Throws std::runtime_error
  // with ffmpeg's message if it has failed.
  void add(std::span<const std::uint8_t> pixels);
  // Ends the film and gives it its name. Throws std::runtime_error and WriteError.
  void finish();

  // An encoder that computes the palette of a GIF from frames, into a file beside it.
  static Encoder palette_of(const Film& film, const std::filesystem::path& palette);

 private:
  Encoder(const Film& film, const std::filesystem::path& file, const std::vector<std::string>& output);
  void start(const std::vector<std::string>& arguments);
  [[noreturn]] void fail();
  int wait_patiently();

  std::filesystem::path file_;
  std::filesystem::path beside_;
  hal::FileDescriptor input_;
  hal::FileDescriptor messages_;
  std::function<void()> while_waiting_;
  pid_t child_ = 0;
};

}  // namespace koboshi::view
