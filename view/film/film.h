#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

#include "view/recording/recording.h"
#include "view/render/camera_path.h"
#include "view/render/overlay.h"

namespace koboshi::view {

// How a recording is shown. The extension of `out` decides what it becomes: .png a picture, or with several
// instants a strip; .mp4, .gif and .webp a film.
struct FilmOptions {
  std::filesystem::path out{};
  int width_px = 0;  // of each instant in a strip; 0, like height_px: the default of the kind
  int height_px = 0;
  std::optional<double> frames_per_s{};  // default: 30, of a GIF or WebP file 20
  std::optional<double> from_s{};        // default: the recording's begin and end
  std::optional<double> to_s{};
  std::vector<double> at_s{};  // a picture's or a strip's instants
  int instants = 0;            // of a strip, evenly spaced; instead of at_s
  double speed = 1.0;          // recorded seconds per second of film
  CameraChoice camera{};
  Overlays overlays{};
  bool collisions = false;
  bool translucent = false;
};

// Called after each frame, and again while ffmpeg lets the caller wait.
using FilmProgress = std::function<void(int frames, int total)>;

// Writes the file. Throws InputError for options that do not fit the recording, WriteError,
// GlError, and what `progress` throws; then there is no file.
void render(const Recording& recording, const FilmOptions& options, const FilmProgress& progress);

}  // namespace koboshi::view
