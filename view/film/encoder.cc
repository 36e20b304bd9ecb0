#include "view/film/encoder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <utility>

#include "base/file/output_file.h"
#include "base/text/error.h"
#include "base/text/foreign_text.h"
#include "hal/linux/child_process.h"

namespace koboshi::view {
namespace {

constexpr int kPatience_ms = 100;  // between two calls of while_waiting
constexpr int kPause_ms = 5;       // between two looks at whether ffmpeg has ended

// ffmpeg would take a name like 2:1.mp4 for a protocol.
std::string name_of(const std::filesystem::path& file) { return "file:" + file.string(); }

std::vector<std::string> mp4_output() {
  // H.264 as browsers and slides play it: 4:2:0, BT.709, index at the beginning.
  return {"-vf",
          "scale=out_color_matrix=bt709:out_range=tv,format=yuv420p",
          "-c:v",
          "libx264",
          "-preset",
          "medium",
          "-crf",
          "19",
          "-colorspace",
          "bt709",
          "-color_primaries",
          "bt709",
          "-color_trc",
          "bt709",
          "-color_range",
          "tv",
          "-movflags",
          "+faststart",
          "-f",
          "mp4"};
}

std::vector<std::string> webp_output() {
  return {"-c:v", "libwebp_anim", "-quality", "72", "-compression_level", "6", "-loop", "0", "-f", "webp"};
}

std::vector<std::string> gif_output(const std::filesystem::path& palette) {
  return {"-i",     name_of(palette),
          "-lavfi", "paletteuse=dither=bayer:bayer_scale=4:diff_mode=rectangle",
          "-loop",  "0",
          "-f",     "gif"};
}

std::vector<std::string> palette_output() {
  return {"-vf", "palettegen=stats_mode=full", "-frames:v", "1", "-c:v", "png", "-f", "image2pipe"};
}

std::vector<std::string> output_of(const Encoder::Film& film, const std::filesystem::path& palette) {
  const std::string extension = extension_of(film.file);
  if (extension == ".gif") return gif_output(palette);
  return extension == ".webp" ? webp_output() : mp4_output();
}

}  // namespace

Encoder::Encoder(const Film& film, const std::filesystem::path& palette)
    : Encoder(film, film.file, output_of(film, palette)) {}

Encoder Encoder::palette_of(const Film& film, const std::filesystem::path& palette) {
  return Encoder(film, palette, palette_output());
}

Encoder::Encoder(const Film& film, const std::filesystem::path& file, const std::vector<std::string>& output)
    : file_(file), beside_(file), while_waiting_(film.while_waiting) {
  beside_ += ".part";
  OutputFile(beside_).close();  // ffmpeg's own message would be about its parts
  std::vector<std::string> arguments{"ffmpeg", "-hide_banner", "-loglevel", "error", "-y", "-f", "rawvideo"};
  arguments.insert(arguments.end(), {"-pixel_format", "bgr0", "-video_size",
                                     fmt::format("{}x{}", film.width_px, film.height_px), "-framerate",
                                     fmt::format("{}", film.frames_per_s), "-i", "pipe:0"});
  arguments.insert(arguments.end(), output.begin(), output.end());
  arguments.insert(arguments.end(), {"-fflags", "+bitexact", "-flags:v", "+bitexact", name_of(beside_)});
  start(arguments);
}

void Encoder::start(const std::vector<std::string>& arguments) {
  std::array<int, 2> ends{};  // a socket: writing to one whose reader is gone need not raise a signal
  hal::checked(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()), "a socket for ffmpeg");
  input_ = hal::FileDescriptor(ends[0]);
  const hal::FileDescriptor output(ends[1]);
  messages_ = hal::FileDescriptor(hal::checked(::memfd_create("ffmpeg", MFD_CLOEXEC), "memory for ffmpeg"));
  const int error = hal::spawn(
      arguments, {.input = output.number(), .output = messages_.number(), .errors = messages_.number()},
      child_);
  if (error == 0) return;
  child_ = 0;
  std::error_code ignored;
  std::filesystem::remove(beside_, ignored);
  if (error == ENOENT)
    throw InputError(file_, 0, "no program ffmpeg, which encodes films", "it (apt install ffmpeg)");
  throw std::system_error(error, std::generic_category(), "ffmpeg does not start");
}

Encoder::~Encoder() {
  if (child_ == 0) return;
  ::kill(child_, SIGKILL);
  hal::wait_for_child(child_);
  std::error_code ignored;
  std::filesystem::remove(beside_, ignored);
}

int Encoder::wait_patiently() {
  if (!while_waiting_) return hal::wait_for_child(child_);
  int status = 0;
  while (::waitpid(child_, &status, WNOHANG) == 0) {
    while_waiting_();
    ::poll(nullptr, 0, kPause_ms);
  }
  return status;
}

void Encoder::fail() {
  input_ = hal::FileDescriptor();
  hal::wait_for_child(child_);
  child_ = 0;
  std::error_code ignored;
  std::filesystem::remove(beside_, ignored);
  std::array<char, 400> text{};
  const ssize_t length = ::pread(messages_.number(), text.data(), text.size(), 0);
  std::string message(text.data(), length > 0 ? static_cast<std::size_t>(length) : 0);
  message = message.substr(0, message.find('\n'));
  throw std::runtime_error("cannot write " + file_.string() + ": ffmpeg failed" +
                           (message.empty() ? "" : ": " + message));
}

void Encoder::add(std::span<const std::uint8_t> pixels) {
  while (!pixels.empty()) {
    pollfd room{.fd = input_.number(), .events = POLLOUT, .revents = 0};
    if (::poll(&room, 1, kPatience_ms) == 0 && while_waiting_) while_waiting_();
    const ssize_t sent = ::send(input_.number(), pixels.data(), pixels.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (sent < 0 && (errno == EINTR || errno == EAGAIN)) continue;
    if (sent < 0) fail();
    pixels = pixels.subspan(static_cast<std::size_t>(sent));
  }
}

void Encoder::finish() {
  input_ = hal::FileDescriptor();  // the end of its input
  const int status = wait_patiently();
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) fail();
  child_ = 0;
  if (std::rename(beside_.c_str(), file_.c_str()) != 0) {
    const int error = errno;
    std::error_code ignored;
    std::filesystem::remove(beside_, ignored);
    throw WriteError(file_, error);
  }
}

}  // namespace koboshi::view
