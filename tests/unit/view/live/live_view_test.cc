#include "view/live/live_view.h"

#include <gtest/gtest.h>

#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <chrono>
#include <cstring>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "tests/support/walking_recording.h"
#include "tests/unit/view/live/batch_reader.h"
#include "view/live/connection.h"

namespace koboshi::view {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using tcp = asio::ip::tcp;
using nlohmann::json;

const Recording& walk() {
  static const Recording recording = walking_recording({.duration_s = 0.2});
  return recording;
}

Recording head_of_walk() {
  Recording head = walk();
  head.samples.clear();
  head.events.clear();
  head.pushes.clear();
  head.frames.clear();
  return head;
}

// A view of the made-up walk, and what its address consists of.
struct Served {
  explicit Served(PageKeys keys = {}) {
    view.set_keys(std::move(keys));
    view.start(head_of_walk(), walking_network());
    const std::string rest = view.address().substr(std::string("http://").size());
    host = rest.substr(0, rest.find('/'));
    path = rest.substr(rest.find('/'));
    port = static_cast<std::uint16_t>(std::stoul(host.substr(host.find(':') + 1)));
  }
  void add_sample(std::size_t i) {
    const Sample& sample = walk().samples.at(i);
    view.add_sample(sample.time_us, sample.links, sample.contacts, sample.values);
  }
  tcp::endpoint endpoint() const { return {asio::ip::address_v4::loopback(), port}; }

  LiveView view{0};
  std::string host;  // 127.0.0.1:PORT
  std::string path;  // /TOKEN/
  std::uint16_t port = 0;
};

http::response<http::string_body> response_to(const Served& served, const std::string& target,
                                              const std::string& host) {
  asio::io_context context;
  beast::tcp_stream stream(context);
  stream.connect(served.endpoint());
  http::request<http::empty_body> request(http::verb::get, target, 11);
  request.set(http::field::host, host);
  http::write(stream, request);
  beast::flat_buffer buffer;
  http::response_parser<http::string_body> parser;
  parser.body_limit(std::uint64_t{8} << 20);
  http::read(stream, buffer, parser);
  return parser.release();
}

// A page's stream.
class Page {
 public:
  explicit Page(const Served& served, std::optional<std::string> origin = {}) {
    stream_.next_layer().connect(served.endpoint());
    const std::string own = "http://" + served.host;
    stream_.set_option(websocket::stream_base::decorator(
        [&](websocket::request_type& request) { request.set(http::field::origin, origin.value_or(own)); }));
    stream_.read_message_max(std::size_t{64} << 20);
    stream_.handshake(served.host, served.path + "stream", error);
  }

  std::string next() {
    beast::flat_buffer buffer;
    stream_.read(buffer, error);
    return beast::buffers_to_string(buffer.data());
  }
  // Skips messages until a text has this field.
  json next_text_with(const std::string& field) {
    while (true) {
      const std::string message = next();
      if (error) return {};
      if (!stream_.got_text()) continue;
      json text = json::parse(message);
      if (text.contains(field)) return text;
    }
  }
  void press(const std::string& key) {
    stream_.text(true);
    stream_.write(asio::buffer(key), error);
  }
  void send_binary() {
    stream_.binary(true);
    stream_.write(asio::buffer("w", 1), error);
  }
  // Reads until the stream is closed.
  websocket::close_code closing() {
    while (!error) (void)next();
    return static_cast<websocket::close_code>(stream_.reason().code);
  }

  beast::error_code error;

 private:
  asio::io_context context_;
  websocket::stream<tcp::socket> stream_{context_};
};

TEST(LiveView, ServesItsPageToTheTokenOnly) {
  const Served served;
  const auto page = response_to(served, served.path, served.host);
  EXPECT_EQ(page.result(), http::status::ok);
  EXPECT_NE(page.body().find("koboshi"), std::string::npos);
  const std::string policy(page["Content-Security-Policy"]);
  EXPECT_NE(policy.find("default-src 'none'"), std::string::npos);
  EXPECT_NE(policy.find("connect-src ws://" + served.host), std::string::npos);
  EXPECT_EQ(page.count("Access-Control-Allow-Origin"), 0u);
  EXPECT_EQ(response_to(served, "/", served.host).result(), http::status::not_found);
  EXPECT_EQ(response_to(served, "/00000000000000000000000000000000/", served.host).result(),
            http::status::not_found);
  EXPECT_EQ(response_to(served, served.path, "evil.example").result(), http::status::forbidden);
  EXPECT_EQ(response_to(served, served.path + "stream", served.host).result(), http::status::not_found);
}

// 127.0.0.2 is also this machine: a server on all addresses would answer there.
TEST(LiveView, ListensOnOneAddressOnly) {
  const Served served;
  asio::io_context context;
  tcp::socket socket(context);
  beast::error_code error;
  socket.connect({asio::ip::make_address("127.0.0.2"), served.port}, error);
  EXPECT_EQ(error, asio::error::connection_refused);
}

TEST(LiveView, RefusesAPortInUse) {
  const Served served;
  EXPECT_THROW(LiveView(served.port), std::invalid_argument);
}

TEST(LiveView, RefusesPagesOfOthers) {
  const Served served;
  EXPECT_EQ(Page(served, "http://evil.example").error, websocket::error::upgrade_declined);
  EXPECT_EQ(Page(served, "null").error, websocket::error::upgrade_declined);
  EXPECT_FALSE(Page(served).error);
}

TEST(LiveView, GivesAPageThePastAndThenTheStream) {
  Served served;
  served.add_sample(0);
  served.view.add_event({3'000, "state", "Stands."});
  Page page(served);
  const json control = json::parse(page.next());
  EXPECT_EQ(control["kinds"].size(), 9u);
  EXPECT_TRUE(control["keys"].empty());
  const std::string hello = page.next();
  std::uint32_t length = 0;
  std::memcpy(&length, hello.data(), sizeof length);
  const json header = json::parse(hello.substr(4, length));
  EXPECT_EQ(header["run"]["scene"]["links"].size(), walk().scene.links.size());
  EXPECT_EQ(header["run"]["times"]["count"], 0);

  // The sample may be in the past or come afterwards: that depends on the moment of the connection.
  served.add_sample(1);
  std::vector<double> times_us;
  std::string event;
  while (times_us.size() < 2 && !page.error) {
    for (const ReadBatch& batch : read_batches(page.next())) {
      times_us.insert(times_us.end(), batch.times_us.begin(), batch.times_us.end());
      if (!batch.json.is_null() && batch.json.contains("events")) event = batch.json["events"][0]["text"];
    }
  }
  EXPECT_EQ(times_us, (std::vector<double>{10'000, 20'000}));
  EXPECT_EQ(event, "Stands.");
  served.view.tell("walk");
  EXPECT_EQ(page.next_text_with("note")["note"], "walk");
  served.view.set_dropped(7);
  EXPECT_EQ(page.next_text_with("dropped")["dropped"], 7);
  // A page that opens late hears them at once.
  const json late = json::parse(Page(served).next());
  EXPECT_EQ(late["note"], "walk");
  EXPECT_EQ(late["dropped"], 7);
}

TEST(LiveView, SendsTheRestAtTheEndAndCloses) {
  Served served;
  Page page(served);
  page.next();
  page.next();
  served.add_sample(0);
  served.view.add_event({5'000, "end", "stands"});
  std::thread closing([&] { served.view.close(); });
  std::size_t samples = 0;
  bool ended = false;
  while (!page.error) {
    const std::string message = page.next();
    if (message.starts_with("{")) {
      ended = ended || json::parse(message).contains("end");
    } else {
      for (const ReadBatch& batch : read_batches(message)) samples += batch.times_us.size();
    }
  }
  closing.join();
  EXPECT_EQ(page.closing(), websocket::close_code::normal);
  EXPECT_EQ(samples, 1u);
  EXPECT_TRUE(ended);
}

// Nobody waits for a page that reads nothing; other pages get everything.
TEST(LiveView, IsNotDisturbedByAPageThatDoesNotRead) {
  Served served;
  Page asleep(served);
  Page awake(served);
  awake.next();
  awake.next();
  std::uint64_t time_us = 0;
  const Sample& sample = walk().samples.front();
  const auto start = std::chrono::steady_clock::now();
  std::size_t seen = 0;
  // More than the sockets can hold.
  constexpr std::size_t kSamples = 40'000;
  for (std::size_t i = 0; i < kSamples; ++i)
    served.view.add_sample(time_us += 10, sample.links, sample.contacts, sample.values);
  while (seen < kSamples && !awake.error) {
    for (const ReadBatch& batch : read_batches(awake.next())) seen += batch.times_us.size();
  }
  EXPECT_EQ(seen, kSamples);
  served.view.close();
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(20));
}

PageKeys keys_that(PageKeys::Answer answer, std::vector<std::string>& pressed) {
  return {.rows = {{{"w", "ArrowUp"}, "forward"}}, .press = [answer, &pressed](std::string_view key) {
            pressed.emplace_back(key);
            return answer;
          }};
}

TEST(LiveView, HandsKeysOn) {
  std::vector<std::string> pressed;
  Served served(keys_that(PageKeys::Answer::kBusy, pressed));
  Page page(served);
  EXPECT_EQ(json::parse(page.next())["keys"],
            json::parse(R"([{"keys": ["w", "ArrowUp"], "name": "forward"}])"));
  page.press("ArrowUp");
  EXPECT_EQ(page.next_text_with("refused")["refused"], "Too many keys at once: this one is lost.");
  EXPECT_EQ(pressed, std::vector<std::string>{"ArrowUp"});
}

TEST(LiveView, RefusesKeysWithTheReason) {
  std::vector<std::string> pressed;
  PageKeys keys = keys_that(PageKeys::Answer::kTaken, pressed);
  keys.refusal = "A real bus.";
  Served served(keys);
  Page page(served);
  EXPECT_EQ(json::parse(page.next())["refusal"], "A real bus.");
  page.press("w");
  EXPECT_EQ(page.next_text_with("refused")["refused"], "A real bus.");
  EXPECT_TRUE(pressed.empty());
  Served without;
  Page other(without);
  other.press("w");
  EXPECT_EQ(other.next_text_with("refused")["refused"], "This run takes no keys.");
}

TEST(LiveView, ClosesTheStreamOfAPageThatSendsAnythingElse) {
  std::vector<std::string> pressed;
  Served served(keys_that(PageKeys::Answer::kUnknown, pressed));
  Page unknown(served);
  unknown.press("nonsense");
  EXPECT_EQ(unknown.closing(), websocket::close_code::policy_error);
  Page large(served);
  large.press(std::string(1000, 'w'));
  EXPECT_EQ(large.closing(), websocket::close_code::too_big);
  Page binary(served);
  binary.send_binary();
  EXPECT_EQ(binary.closing(), websocket::close_code::unknown_data);
  EXPECT_EQ(pressed, std::vector<std::string>{"nonsense"});
}

TEST(LiveView, LimitsTheNumberOfConnections) {
  const Served served;
  std::vector<std::unique_ptr<Page>> pages;
  for (std::size_t i = 0; i < Connection::kMaxConnections; ++i) {
    pages.push_back(std::make_unique<Page>(served));
    EXPECT_FALSE(pages.back()->error);
  }
  EXPECT_TRUE(Page(served).error);
  pages.front()->press("w");  // those that are open stay
  EXPECT_FALSE(pages.front()->error);
}

}  // namespace
}  // namespace koboshi::view
