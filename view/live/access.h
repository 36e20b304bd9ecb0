#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace koboshi::view {

// The parts of an HTTP request that decide on its answer.
struct RequestHead {
  bool is_get = true;
  bool is_upgrade = false;                  // to a WebSocket
  std::string_view target = {};             // the path and what follows it
  std::vector<std::string_view> hosts{};    // values of all fields Host
  std::vector<std::string_view> origins{};  // values of all fields Origin
};

enum class Access {
  kPage,
  kStream,            // the WebSocket
  kForbidden,         // 403: another host or another site's page asks
  kNotFound,          // 404: no or another token
  kMethodNotAllowed,  // 405
};

// Returns 128 random bits of the kernel as 32 hexadecimal digits. Throws std::system_error.
[[nodiscard]] std::string make_token();

// Compares in a time that depends on the lengths only.
[[nodiscard]] bool equal_in_constant_time(std::string_view a, std::string_view b);

// Decides who may see the page `/TOKEN/` and its stream `/TOKEN/stream` on this port of 127.0.0.1. The host
// must be named 127.0.0.1 or localhost, so that no foreign name that resolves to 127.0.0.1 works (DNS
// rebinding). The stream is for pages of the same origin only.
[[nodiscard]] Access judge(const RequestHead& request, std::uint16_t port, std::string_view token);

}  // namespace koboshi::view
