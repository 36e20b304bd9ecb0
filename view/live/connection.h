#pragma once

#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "view/live/live_view.h"
#include "view/live/send_queue.h"

namespace koboshi::view {

class Connection;

struct Message {
  bool is_text = false;
  std::shared_ptr<const std::string> data;
};

// State that the connections of a server share. All of it belongs to the server's thread.
struct Hub {
  std::uint16_t port = 0;
  std::string token{};
  std::string page{};  // HTML
  PageKeys keys{};
  std::function<std::vector<Message>()> greeting{};  // the first messages to a page
  std::vector<std::weak_ptr<Connection>> viewers{};
  std::size_t connections = 0;
  std::function<void()> emptied{};  // called when the last connection has gone; may be empty
};

// A connection of a browser: one request, for the page or for the stream.
class Connection : public std::enable_shared_from_this<Connection> {
 public:
  static constexpr std::size_t kMaxConnections = 16;
  // A page that is further behind loses samples and frames.
  static constexpr std::size_t kMaxBatches = 60;
  // Texts that wait for a page; the oldest are dropped.
  static constexpr std::size_t kMaxTexts = 32;

  Connection(boost::asio::ip::tcp::socket socket, Hub& hub);
  ~Connection() {
    if (--hub_.connections == 0 && hub_.emptied) hub_.emptied();
  }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  void start();
  // To a page with a stream.
  void send(std::shared_ptr<const Batch> batch);
  void send_text(std::string text);
  // Closes the stream when everything has been sent.
  void finish();

 private:
  using Error = boost::beast::error_code;

  void answer();
  void respond(boost::beast::http::status status, const char* type, std::string body);
  void open_stream();
  void read_key();
  void obey(const std::string& key);
  void write_next();
  void close(boost::beast::websocket::close_code code);

  Hub& hub_;
  boost::beast::tcp_stream socket_;
  boost::beast::flat_buffer buffer_;
  boost::beast::http::request_parser<boost::beast::http::empty_body> parser_;
  boost::beast::http::response<boost::beast::http::string_body> response_;
  std::optional<boost::beast::websocket::stream<boost::beast::tcp_stream>> stream_;
  std::deque<Message> messages_;  // before those of the queue
  SendQueue queue_;
  Message sending_;
  bool is_sending_ = false;
  bool is_finishing_ = false;
  bool is_closed_ = false;
};

}  // namespace koboshi::view
