#include "base/yaml/yaml_events.h"

namespace koboshi {
namespace {

// Some errors of libfyaml reach standard error in spite of FYPCF_QUIET.
fy_diag* collecting_diagnostics() {
  fy_diag* diagnostics = fy_diag_create(nullptr);
  if (diagnostics != nullptr) fy_diag_set_collect_errors(diagnostics, true);
  return diagnostics;
}

// Readers have a limit of their own for the depth, which is above the library's.
fy_parser* create_parser(fy_diag* diagnostics) {
  constexpr auto kFlags = static_cast<fy_parse_cfg_flags>(FYPCF_QUIET | FYPCF_DISABLE_DEPTH_LIMIT);
  const fy_parse_cfg config{nullptr, kFlags, nullptr, diagnostics};
  return fy_parser_create(&config);
}

}  // namespace

YamlEvents::YamlEvents(std::string_view text)
    : diagnostics_(collecting_diagnostics(), fy_diag_destroy),
      parser_(create_parser(diagnostics_.get()), fy_parser_destroy),
      event_(nullptr, FreeEvent{parser_.get()}) {
  if (!parser_ || fy_parser_set_string(parser_.get(), text.data(), text.size()) != 0)
    throw std::runtime_error("libfyaml has no memory for a parser");
}

const fy_event& YamlEvents::next() {
  event_.reset(fy_parser_parse(parser_.get()));
  if (event_) return *event_;
  void* iterator = nullptr;
  const fy_diag_error* const error = fy_diag_errors_iterate(diagnostics_.get(), &iterator);
  if (error == nullptr || error->msg == nullptr) throw YamlRefused("not understood", 1);
  // A token of several lines, such as a plain text that turns out to be a key, is wrong where it ends.
  const fy_mark* const end = error->fyt == nullptr ? nullptr : fy_token_end_mark(error->fyt);
  throw YamlRefused(error->msg, end == nullptr ? error->line : end->line + 1);
}

std::string_view text_of(fy_token* token) {
  std::size_t length = 0;
  const char* const text = token == nullptr ? nullptr : fy_token_get_text(token, &length);
  return text == nullptr ? std::string_view() : std::string_view(text, length);
}

}  // namespace koboshi
