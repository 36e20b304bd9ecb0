#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bus/dictionary/network.h"
#include "view/recording/listener.h"
#include "view/recording/recording.h"

namespace koboshi::view {

// The keys that pages may press.
struct PageKeys {
  enum class Answer { kTaken, kUnknown, kBusy };
  struct Row {
    std::vector<std::string> keys;  // by their names in a browser (KeyboardEvent.key)
    std::string name;               // what they do
  };

  std::vector<Row> rows{};  // empty: this run has no keys
  std::string refusal{};    // why keys are refused, a sentence; empty: they are taken
  // Called for each key in the thread of the view.
  std::function<Answer(std::string_view key)> press{};
};

// Serves the page of a running simulation on 127.0.0.1 and streams records into it, 60 times a second. Pages
// need the random token of the address. A thread of its own does all the work; nobody waits for a browser.
class LiveView final : public RecordingListener {
 public:
  // Pages that open late, or again, get this much of the past.
  static constexpr int kBacklog_s = 20;

  // Opens the port; 0: a free one. Throws std::invalid_argument for a port that it cannot have.
  explicit LiveView(std::uint16_t port);
  ~LiveView();
  LiveView(const LiveView&) = delete;
  LiveView& operator=(const LiveView&) = delete;

  // "http://127.0.0.1:PORT/TOKEN/"
  const std::string& address() const { return address_; }

  // Call before start().
  void set_keys(PageKeys keys);
  // Begins to answer. `head` is a recording without its samples, events, pushes and frames. The thread
  // inherits the blocked signals of the caller.
  void start(const Recording& head, const bus::Network& network);
  // Sends the rest and that the run has ended, and closes. Returns after half a second at the latest.
  void close();

  // Any thread may call these.
  void add_sample(std::uint64_t time_us, std::span<const Pose> links, std::span<const ContactForce> contacts,
                  std::span<const float> values) override;
  void add_event(const Event& event) override;
  void add_push(const Push& push) override;
  void add_frame(const Frame& frame) override;
  // Shows a sentence about the keys in every page.
  void tell(std::string note);
  // Number of records that were lost before they reached the view.
  void set_dropped(std::uint64_t count);

 private:
  class Server;

  std::unique_ptr<Server> server_;
  std::string address_;
};

}  // namespace koboshi::view
