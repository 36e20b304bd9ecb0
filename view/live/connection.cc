#include "view/live/connection.h"

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <utility>

#include <fmt/core.h>

#include "view/live/access.h"
#include "view/replay/replay_page.h"

namespace koboshi::view {
namespace {

namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;

constexpr std::chrono::seconds kRequestTimeout{10};
constexpr std::chrono::seconds kResponseTimeout{60};  // for a megabyte through a slow tunnel
// A page that does not answer a ping for so long is gone. A browser answers only after it has read what came
// before, which takes long on a machine that is too slow for it.
constexpr std::chrono::seconds kIdleTimeout{120};
constexpr std::size_t kMaxKeyBytes = 32;
// Memory of the kernel for a page that reads slowly: less than a second of a walk.
constexpr int kSocketBuffer_bytes = 1 << 17;

std::string_view as_view(beast::string_view text) { return {text.data(), text.size()}; }

std::vector<std::string_view> values_of(const http::request<http::empty_body>& request, http::field field) {
  std::vector<std::string_view> values;
  const auto [begin, end] = request.equal_range(field);
  for (auto one = begin; one != end; ++one) values.push_back(as_view(one->value()));
  return values;
}

}  // namespace

Connection::Connection(boost::asio::ip::tcp::socket socket, Hub& hub)
    : hub_(hub), socket_(std::move(socket)), queue_(kMaxBatches) {
  ++hub_.connections;
}

void Connection::start() {
  socket_.expires_after(kRequestTimeout);
  http::async_read(socket_, buffer_, parser_, [self = shared_from_this()](Error error, std::size_t) {
    if (!error) self->answer();
  });
}

void Connection::answer() {
  const auto& request = parser_.get();
  const RequestHead head{.is_get = request.method() == http::verb::get,
                         .is_upgrade = websocket::is_upgrade(request),
                         .target = as_view(request.target()),
                         .hosts = values_of(request, http::field::host),
                         .origins = values_of(request, http::field::origin)};
  switch (judge(head, hub_.port, hub_.token)) {
    case Access::kPage:
      return respond(http::status::ok, "text/html; charset=utf-8", hub_.page);
    case Access::kStream:
      return open_stream();
    case Access::kForbidden:
      return respond(http::status::forbidden, "text/plain", "This host or origin is not allowed.\n");
    case Access::kNotFound:
      return respond(http::status::not_found, "text/plain", "Not found: use the address that was printed.\n");
    case Access::kMethodNotAllowed:
      return respond(http::status::method_not_allowed, "text/plain", "Only GET is allowed.\n");
  }
}

void Connection::respond(http::status status, const char* type, std::string body) {
  response_.result(status);
  response_.version(11);
  response_.keep_alive(false);
  response_.set(http::field::content_type, type);
  response_.set(http::field::cache_control, "no-store");
  response_.set("Content-Security-Policy", live_page_policy(hub_.port) + "; frame-ancestors 'none'");
  response_.set("Cross-Origin-Opener-Policy", "same-origin");
  response_.set("Cross-Origin-Resource-Policy", "same-origin");
  response_.set("Referrer-Policy", "no-referrer");
  response_.set("X-Content-Type-Options", "nosniff");
  if (status == http::status::method_not_allowed) response_.set(http::field::allow, "GET");
  response_.body() = std::move(body);
  response_.prepare_payload();
  socket_.expires_after(kResponseTimeout);
  http::async_write(socket_, response_, [self = shared_from_this()](Error, std::size_t) {
    Error ignored;  // the browser may have gone already
    self->socket_.socket().shutdown(boost::asio::ip::tcp::socket::shutdown_send, ignored);
  });
}

void Connection::open_stream() {
  Error ignored;  // both are improvements, not conditions
  socket_.socket().set_option(boost::asio::ip::tcp::no_delay(true), ignored);
  socket_.socket().set_option(boost::asio::socket_base::send_buffer_size(kSocketBuffer_bytes), ignored);
  socket_.expires_never();
  stream_.emplace(std::move(socket_));
  stream_->set_option(websocket::stream_base::timeout{kRequestTimeout, kIdleTimeout, true});
  stream_->read_message_max(kMaxKeyBytes);
  stream_->async_accept(parser_.get(), [self = shared_from_this()](Error error) {
    if (error) return;
    for (Message& message : self->hub_.greeting()) self->messages_.push_back(std::move(message));
    self->hub_.viewers.push_back(self->weak_from_this());
    self->buffer_.clear();
    self->read_key();
    self->write_next();
  });
}

void Connection::read_key() {
  stream_->async_read(buffer_, [self = shared_from_this()](Error error, std::size_t) {
    if (error) {
      self->is_closed_ = true;
      return;
    }
    if (!self->stream_->got_text()) return self->close(websocket::close_code::unknown_data);
    const std::string key = beast::buffers_to_string(self->buffer_.data());
    self->buffer_.consume(self->buffer_.size());
    self->obey(key);
    if (!self->is_closed_) self->read_key();
  });
}

void Connection::obey(const std::string& key) {
  const PageKeys& keys = hub_.keys;
  const auto refuse = [this](const std::string& reason) {
    send_text(nlohmann::ordered_json{{"refused", reason}}.dump(
        -1, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
  };
  if (!keys.refusal.empty() || !keys.press) {
    return refuse(keys.refusal.empty() ? "This run takes no keys." : keys.refusal);
  }
  switch (keys.press(key)) {
    case PageKeys::Answer::kTaken:
      return;
    case PageKeys::Answer::kBusy:
      return refuse("Too many keys at once: this one is lost.");
    case PageKeys::Answer::kUnknown:
      return close(websocket::close_code::policy_error);
  }
}

void Connection::send(std::shared_ptr<const Batch> batch) {
  queue_.push(std::move(batch));
  write_next();
}

void Connection::send_text(std::string text) {
  const auto texts = std::ranges::count_if(messages_, &Message::is_text);
  if (texts >= static_cast<std::ptrdiff_t>(kMaxTexts))
    messages_.erase(std::ranges::find_if(messages_, &Message::is_text));
  messages_.push_back({true, std::make_shared<const std::string>(std::move(text))});
  write_next();
}

void Connection::finish() {
  is_finishing_ = true;
  write_next();
}

void Connection::close(websocket::close_code code) {
  if (std::exchange(is_closed_, true)) return;
  stream_->async_close(code, [self = shared_from_this()](Error) {});
}

void Connection::write_next() {
  if (is_sending_ || is_closed_) return;
  if (!messages_.empty()) {
    sending_ = std::move(messages_.front());
    messages_.pop_front();
  } else if (!queue_.empty()) {
    sending_ = {false, std::make_shared<const std::string>(queue_.take())};
  } else {
    if (is_finishing_) close(websocket::close_code::normal);
    return;
  }
  is_sending_ = true;
  stream_->text(sending_.is_text);
  stream_->async_write(boost::asio::buffer(*sending_.data),
                       [self = shared_from_this()](Error error, std::size_t) {
                         self->is_sending_ = false;
                         if (error) {
                           self->is_closed_ = true;
                           return;
                         }
                         self->write_next();
                       });
}

}  // namespace koboshi::view
