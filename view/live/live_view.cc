#include "view/live/live_view.h"

#include <fmt/core.h>

#include <algorithm>
#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <cstdio>
#include <deque>
#include <mutex>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <thread>
#include <utility>

#include "base/file/standard_streams.h"
#include "view/live/access.h"
#include "view/live/batch.h"
#include "view/live/connection.h"
#include "view/replay/replay_data.h"
#include "view/replay/replay_page.h"

namespace koboshi::view {
namespace {

using boost::asio::ip::tcp;
using nlohmann::ordered_json;

constexpr int kUpdates_per_s = 60;
constexpr std::size_t kBacklogBatches = static_cast<std::size_t>(kUpdates_per_s) * LiveView::kBacklog_s;
constexpr std::chrono::milliseconds kClosing{500};

std::shared_ptr<const std::string> shared(std::string text) {
  return std::make_shared<const std::string>(std::move(text));
}

ordered_json keys_json(const PageKeys& keys) {
  ordered_json rows = ordered_json::array();
  for (const PageKeys::Row& row : keys.rows) rows.push_back({{"keys", row.keys}, {"name", row.name}});
  return rows;
}

// In the order of tools::FrameKind.
ordered_json kinds_json() {
  ordered_json kinds = ordered_json::array();
  for (int kind = 0; kind <= static_cast<int>(bus::FrameKind::kOther); ++kind)
    kinds.push_back(kind_text(static_cast<bus::FrameKind>(kind)));
  return kinds;
}

}  // namespace

class LiveView::Server {
 public:
  explicit Server(std::uint16_t port) : acceptor_(context_), timer_(context_), deadline_(context_) {
    const tcp::endpoint endpoint(boost::asio::ip::address_v4::loopback(), port);
    acceptor_.open(endpoint.protocol());
    acceptor_.set_option(tcp::acceptor::reuse_address(true));
    acceptor_.bind(endpoint);
    acceptor_.listen();
    hub_.port = acceptor_.local_endpoint().port();
    hub_.token = make_token();
    hub_.greeting = [this] { return greeting(); };
  }
  ~Server() { close(); }

  Hub& hub() { return hub_; }

  void start(const Recording& head, const bus::Network& network) {
    links_ = head.scene.links.size();
    signals_ = head.signals.size();
    maker_.emplace(links_, signals_);
    hub_.page = live_page(head.title, hub_.port);
    hello_ = shared(replay_data(head, nullptr, network));
    control_ = {{"keys", keys_json(hub_.keys)}, {"refusal", hub_.keys.refusal}, {"kinds", kinds_json()}};
    accept();
    next_flush_ = std::chrono::steady_clock::now();
    flush_later();
    thread_ = std::thread([this] { serve(); });
  }

  void close() {
    if (!thread_.joinable()) return;
    boost::asio::post(context_, [this] { end(); });
    thread_.join();
    hub_.emptied = {};
  }

  template <typename Add>
  void add(Add add_to) {
    const std::lock_guard lock(mutex_);
    if (maker_) add_to(*maker_);
  }
  void tell(std::string note) {
    const std::lock_guard lock(mutex_);
    notes_.push_back(std::move(note));
  }
  void set_dropped(std::uint64_t count) { dropped_.store(count, std::memory_order_relaxed); }

 private:
  // --- the server's thread ---

  // An error ends the view, not the run.
  void serve() {
    try {
      context_.run();
    } catch (const std::exception& error) {
      print_error("koboshi: warning: the live view has ended: {}\n", error.what());
    }
  }

  void accept() {
    acceptor_.async_accept([this](boost::beast::error_code error, tcp::socket socket) {
      if (!acceptor_.is_open()) return;
      // Without room the socket is closed at once.
      if (!error && hub_.connections < Connection::kMaxConnections)
        std::make_shared<Connection>(std::move(socket), hub_)->start();
      accept();
    });
  }

  void flush_later() {
    // After a pause of the machine, the missed updates are left out.
    next_flush_ = std::max(next_flush_ + std::chrono::microseconds(1'000'000 / kUpdates_per_s),
                           std::chrono::steady_clock::now());
    timer_.expires_at(next_flush_);
    timer_.async_wait([this](boost::beast::error_code error) {
      if (error) return;
      flush();
      flush_later();
    });
  }

  void flush() {
    std::optional<BatchMaker> filled;
    std::vector<std::string> notes;
    {
      const std::lock_guard lock(mutex_);
      // Moved out under the lock, encoded without it.
      if (!maker_->empty()) filled = std::exchange(*maker_, BatchMaker(links_, signals_));
      notes.swap(notes_);
    }
    if (filled) {
      backlog_.push_back(std::make_shared<const Batch>(filled->take()));
      if (backlog_.size() > kBacklogBatches) {
        old_marks_ += backlog_.front()->marks;
        backlog_.pop_front();
      }
      for_each_viewer([&](Connection& viewer) { viewer.send(backlog_.back()); });
    }
    for (std::string& note : notes) tell_all("note", control_["note"] = std::move(note));
    const std::uint64_t dropped = dropped_.load(std::memory_order_relaxed);
    if (dropped != told_dropped_) tell_all("dropped", control_["dropped"] = told_dropped_ = dropped);
  }

  void tell_all(const char* name, const ordered_json& value) {
    const std::string text =
        ordered_json{{name, value}}.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
    for_each_viewer([&](Connection& viewer) { viewer.send_text(text); });
  }

  template <typename Use>
  void for_each_viewer(Use use) {
    std::erase_if(hub_.viewers, [](const auto& viewer) { return viewer.expired(); });
    for (const auto& viewer : hub_.viewers) use(*viewer.lock());
  }

  std::vector<Message> greeting() const {
    std::string past = old_marks_;
    for (const auto& batch : backlog_) past += batch->bytes;
    return {{true, shared(control_.dump(-1, ' ', false, ordered_json::error_handler_t::replace))},
            {false, hello_},
            {false, shared(std::move(past))}};
  }

  void end() {
    acceptor_.close();
    timer_.cancel();
    flush();
    tell_all("end", true);
    for_each_viewer([](Connection& viewer) { viewer.finish(); });
    deadline_.expires_after(kClosing);
    deadline_.async_wait([this](boost::beast::error_code) { context_.stop(); });
    hub_.emptied = [this] { deadline_.cancel(); };
    if (hub_.connections == 0) hub_.emptied();
  }

  // Before the context: connections that it holds use the hub.
  Hub hub_;
  boost::asio::io_context context_{1};
  tcp::acceptor acceptor_;
  boost::asio::steady_timer timer_;
  boost::asio::steady_timer deadline_;
  std::chrono::steady_clock::time_point next_flush_;
  std::shared_ptr<const std::string> hello_;
  ordered_json control_;
  std::deque<std::shared_ptr<const Batch>> backlog_;
  std::string old_marks_;  // events and pushes from before the backlog
  std::size_t links_ = 0;
  std::size_t signals_ = 0;
  std::uint64_t told_dropped_ = 0;

  // --- shared with other threads ---
  std::mutex mutex_;
  std::optional<BatchMaker> maker_;
  std::vector<std::string> notes_;
  std::atomic<std::uint64_t> dropped_ = 0;

  std::thread thread_;
};

LiveView::LiveView(std::uint16_t port) try
    : server_(std::make_unique<Server>(port)),
      address_(fmt::format("http://127.0.0.1:{}/{}/", server_->hub().port, server_->hub().token)) {
} catch (const boost::system::system_error& error) {
  throw std::invalid_argument(
      fmt::format("found port {} of 127.0.0.1 ({}), expected a free port", port, error.code().message()));
}

LiveView::~LiveView() = default;

void LiveView::set_keys(PageKeys keys) { server_->hub().keys = std::move(keys); }

void LiveView::start(const Recording& head, const bus::Network& network) { server_->start(head, network); }

void LiveView::close() { server_->close(); }

void LiveView::add_sample(std::uint64_t time_us, std::span<const Pose> links,
                          std::span<const ContactForce> contacts, std::span<const float> values) {
  server_->add([&](BatchMaker& maker) { maker.add_sample(time_us, links, contacts, values); });
}

void LiveView::add_event(const Event& event) {
  server_->add([&](BatchMaker& maker) { maker.add_event(event); });
}

void LiveView::add_push(const Push& push) {
  server_->add([&](BatchMaker& maker) { maker.add_push(push); });
}

void LiveView::add_frame(const Frame& frame) {
  server_->add([&](BatchMaker& maker) { maker.add_frame(frame); });
}

void LiveView::tell(std::string note) { server_->tell(std::move(note)); }

void LiveView::set_dropped(std::uint64_t count) { server_->set_dropped(count); }

}  // namespace koboshi::view
