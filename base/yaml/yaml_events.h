#pragma once

#include <libfyaml.h>

#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>

namespace koboshi {

// Malformed YAML, or YAML that the caller does not read. `what()` says what was found.
struct YamlRefused : std::runtime_error {
  YamlRefused(const std::string& found, int at_line) : std::runtime_error(found), line(at_line) {}
  int line;  // from 1
};

// The events of libfyaml's parser in order, each valid until the next one.
class YamlEvents {
 public:
  // The text must outlive the events. It is UTF-8.
  explicit YamlEvents(std::string_view text);

  // Throws YamlRefused at malformed YAML. At the end of the text: FYET_STREAM_END, once.
  const fy_event& next();

 private:
  struct FreeEvent {
    fy_parser* parser;
    void operator()(fy_event* event) const { fy_parser_event_free(parser, event); }
  };

  std::unique_ptr<fy_diag, decltype(&fy_diag_destroy)> diagnostics_;
  std::unique_ptr<fy_parser, decltype(&fy_parser_destroy)> parser_;
  std::unique_ptr<fy_event, FreeEvent> event_;
};

// Returns the text of a token; empty without one.
[[nodiscard]] std::string_view text_of(fy_token* token);

}  // namespace koboshi
