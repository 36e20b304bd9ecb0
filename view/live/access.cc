#include "view/live/access.h"

#include <fmt/core.h>
#include <sys/random.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <system_error>

namespace koboshi::view {

std::string make_token() {
  std::array<unsigned char, 16> bytes{};
  if (getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size()))
    throw std::system_error(errno, std::generic_category(), "random bits for the address of the live view");
  std::string token;
  for (const unsigned char byte : bytes) token += fmt::format("{:02x}", byte);
  return token;
}

bool equal_in_constant_time(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  volatile unsigned difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    difference = difference | (static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i]));
  }
  return difference == 0;
}

Access judge(const RequestHead& request, std::uint16_t port, std::string_view token) {
  if (request.hosts.size() != 1 || request.origins.size() > 1) return Access::kForbidden;
  const std::string_view host = request.hosts.front();
  const std::array<std::string, 2> own{fmt::format("127.0.0.1:{}", port), fmt::format("localhost:{}", port)};
  if (std::ranges::find(own, host) == own.end()) return Access::kForbidden;
  const bool same_origin =
      !request.origins.empty() && request.origins.front() == fmt::format("http://{}", host);
  if (!request.origins.empty() && !same_origin) return Access::kForbidden;
  if (request.is_upgrade && !same_origin) return Access::kForbidden;

  std::string_view target = request.target;
  if (!target.starts_with('/')) return Access::kNotFound;
  target.remove_prefix(1);
  const std::size_t end = std::min(target.find('/'), target.size());
  if (!equal_in_constant_time(target.substr(0, end), token)) return Access::kNotFound;
  if (!request.is_get) return Access::kMethodNotAllowed;
  const std::string_view rest = target.substr(end);
  if (rest == "/stream" && request.is_upgrade) return Access::kStream;
  return (rest.empty() || rest == "/") && !request.is_upgrade ? Access::kPage : Access::kNotFound;
}

}  // namespace koboshi::view
