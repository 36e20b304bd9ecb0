#include "view/live/access.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace koboshi::view {
namespace {

constexpr std::uint16_t kPort = 8123;
constexpr std::string_view kToken = "0123456789abcdef0123456789abcdef";

const RequestHead kPageRequest{.target = "/0123456789abcdef0123456789abcdef/", .hosts = {"127.0.0.1:8123"}};
const RequestHead kStreamRequest{.is_upgrade = true,
                                 .target = "/0123456789abcdef0123456789abcdef/stream",
                                 .hosts = {"127.0.0.1:8123"},
                                 .origins = {"http://127.0.0.1:8123"}};

Access judged(RequestHead request, void (*change)(RequestHead&)) {
  change(request);
  return judge(request, kPort, kToken);
}

TEST(Access, TokensAreLongAndDiffer) {
  std::set<std::string> tokens;
  for (int i = 0; i < 100; ++i) tokens.insert(make_token());
  EXPECT_EQ(tokens.size(), 100u);
  for (const std::string& token : tokens) {
    EXPECT_EQ(token.size(), 32u);  // 128 bits
    EXPECT_EQ(token.find_first_not_of("0123456789abcdef"), std::string::npos);
  }
}

TEST(Access, ComparesTheWholeToken) {
  EXPECT_TRUE(equal_in_constant_time(kToken, kToken));
  EXPECT_TRUE(equal_in_constant_time("", ""));
  for (std::size_t i = 0; i < kToken.size(); ++i) {
    std::string other(kToken);
    other[i] = 'g';
    EXPECT_FALSE(equal_in_constant_time(kToken, other));
    EXPECT_FALSE(equal_in_constant_time(kToken, kToken.substr(0, i)));
  }
}

TEST(Access, GivesPageAndStreamToTheirAddress) {
  EXPECT_EQ(judge(kPageRequest, kPort, kToken), Access::kPage);
  EXPECT_EQ(judge(kStreamRequest, kPort, kToken), Access::kStream);
  EXPECT_EQ(judged(kPageRequest, [](auto& r) { r.target.remove_suffix(1); }), Access::kPage);
  EXPECT_EQ(judged(kStreamRequest,
                   [](auto& r) {
                     r.hosts = {"localhost:8123"};
                     r.origins = {"http://localhost:8123"};
                   }),
            Access::kStream);
}

TEST(Access, NeedsTheToken) {
  for (const char* target :
       {"/", "", "*", "//", "/1123456789abcdef0123456789abcdef/", "/0123456789abcdef/",
        "/0123456789abcdef0123456789abcdefg/", "http://127.0.0.1:8123/x/",
        "/0123456789abcdef0123456789abcdef/other", "/0123456789abcdef0123456789abcdef/?x"}) {
    RequestHead request = kPageRequest;
    request.target = target;
    EXPECT_EQ(judge(request, kPort, kToken), Access::kNotFound) << target;
  }
  EXPECT_EQ(judged(kStreamRequest, [](auto& r) { r.target = "/1123456789abcdef0123456789abcdef/stream"; }),
            Access::kNotFound);
}

// A foreign name that resolves to 127.0.0.1 must not work: its page would be of the same origin.
TEST(Access, RefusesOtherHosts) {
  for (const RequestHead& known : {kPageRequest, kStreamRequest}) {
    for (const char* host : {"evil.example:8123", "127.0.0.1", "127.0.0.1:80", "localhost", "", "[::1]:8123",
                             "127.0.0.1:8123.evil.example"}) {
      RequestHead request = known;
      request.hosts = {host};
      if (!request.origins.empty()) request.origins = {"http://127.0.0.1:8123"};
      EXPECT_EQ(judge(request, kPort, kToken), Access::kForbidden) << host;
    }
    EXPECT_EQ(judged(known, [](auto& r) { r.hosts = {}; }), Access::kForbidden);
    EXPECT_EQ(judged(known, [](auto& r) { r.hosts.push_back("127.0.0.1:8123"); }), Access::kForbidden);
  }
}

TEST(Access, RefusesOtherOrigins) {
  for (const char* origin : {"http://evil.example", "null", "https://127.0.0.1:8123", "http://127.0.0.1:80",
                             "http://localhost:8123", ""}) {
    for (RequestHead request : {kPageRequest, kStreamRequest}) {
      request.origins = {origin};
      EXPECT_EQ(judge(request, kPort, kToken), Access::kForbidden) << origin;
    }
  }
  // A browser always names the origin of a WebSocket.
  EXPECT_EQ(judged(kStreamRequest, [](auto& r) { r.origins = {}; }), Access::kForbidden);
  EXPECT_EQ(judged(kStreamRequest, [](auto& r) { r.origins.push_back(r.origins[0]); }), Access::kForbidden);
}

TEST(Access, OnlyReads) {
  EXPECT_EQ(judged(kPageRequest, [](auto& r) { r.is_get = false; }), Access::kMethodNotAllowed);
  EXPECT_EQ(judged(kStreamRequest, [](auto& r) { r.is_upgrade = false; }), Access::kNotFound);
  EXPECT_EQ(judged(kPageRequest,
                   [](auto& r) {
                     r.is_upgrade = true;
                     r.origins = {"http://127.0.0.1:8123"};
                   }),
            Access::kNotFound);
}

}  // namespace
}  // namespace koboshi::view
