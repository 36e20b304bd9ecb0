#include "tools/edit/yaml_places.h"

#include <libfyaml.h>

#include <memory>
#include <stdexcept>
#include <utility>

#include "base/text/error.h"

namespace koboshi::tools {
namespace {

using Kind = YamlPlace::Kind;

// libfyaml reads the document in another way than parse_yaml. `what()` says what it found.
struct Refused : std::runtime_error {
  using std::runtime_error::runtime_error;
};

std::size_t start_of(fy_token* token) { return fy_token_start_mark(token)->input_pos; }
std::size_t end_of(fy_token* token) { return fy_token_end_mark(token)->input_pos; }

struct FreeEvent {
  fy_parser* parser;
  void operator()(fy_event* event) const { fy_parser_event_free(parser, event); }
};

// The parser's events in order, each valid until the next one.
class Events {
 public:
  explicit Events(std::string_view text)
      : silence_(silent_diagnostics(), fy_diag_destroy),
        parser_(create_parser(silence_.get()), fy_parser_destroy),
        event_(nullptr, FreeEvent{parser_.get()}) {
    if (!parser_ || fy_parser_set_string(parser_.get(), text.data(), text.size()) != 0)
      throw std::runtime_error("libfyaml has no memory for a parser");
  }

  // Throws Refused at malformed YAML and at the end of the text.
  const fy_event& next() {
    event_.reset(fy_parser_parse(parser_.get()));
    if (!event_) throw Refused("YAML that libfyaml refuses");
    return *event_;
  }

 private:
  // Some errors of libfyaml reach standard error in spite of FYPCF_QUIET.
  static fy_diag* silent_diagnostics() {
    fy_diag* diagnostics = fy_diag_create(nullptr);
    if (diagnostics != nullptr) fy_diag_set_collect_errors(diagnostics, true);
    return diagnostics;
  }
  static fy_parser* create_parser(fy_diag* diagnostics) {
    const fy_parse_cfg config{nullptr, FYPCF_QUIET, nullptr, diagnostics};
    return fy_parser_create(&config);
  }

  std::unique_ptr<fy_diag, decltype(&fy_diag_destroy)> silence_;
  std::unique_ptr<fy_parser, decltype(&fy_parser_destroy)> parser_;
  std::unique_ptr<fy_event, FreeEvent> event_;
};

class Locator {
 public:
  explicit Locator(std::string_view text) : text_(text), events_(text) {}

  YamlPlace document() {
    while (events_.next().type != FYET_DOCUMENT_START) {
    }
    return value(events_.next(), 0);
  }

 private:
  // The value of an event. `after`: where the value may begin, after its colon or dash.
  YamlPlace value(const fy_event& event, std::size_t after) {
    switch (event.type) {
      case FYET_SCALAR:
        return scalar(event, after);
      case FYET_MAPPING_START:
        return map(event.mapping_start.mapping_start);
      case FYET_SEQUENCE_START:
        return list(event.sequence_start.sequence_start, after);
      default:
        throw Refused("an alias");
    }
  }

  YamlPlace scalar(const fy_event& event, std::size_t after) const {
    YamlPlace place;
    place.begin = place.end = after;
    fy_token* token = event.scalar.value;
    const fy_scalar_style style = fy_token_scalar_style(token);
    std::size_t length = 0;
    fy_token_get_text(token, &length);
    if (style == FYSS_PLAIN && length == 0) return place;
    place.begin = start_of(token);
    place.end = end_of(token);
    if (style == FYSS_SINGLE_QUOTED || style == FYSS_DOUBLE_QUOTED) include_quotes(place);
    if (style == FYSS_LITERAL || style == FYSS_FOLDED) {
      place.kind = Kind::kBlockText;
      place.begin = text_.find_first_of("|>", after);
    }
    return place;
  }

  void include_quotes(YamlPlace& place) const {
    const auto is_quote = [&](std::size_t at) { return text_[at] == '"' || text_[at] == '\''; };
    if (place.begin > 0 && is_quote(place.begin - 1)) --place.begin;
    if (place.end < text_.size() && is_quote(place.end)) ++place.end;
  }

  YamlPlace map(fy_token* token) {
    YamlPlace place;
    place.kind = begins_with(token, '{') ? Kind::kFlowMap : Kind::kBlockMap;
    if (place.is_flow()) place.begin = start_of(token);
    for (;;) {
      const fy_event& event = events_.next();
      if (event.type == FYET_MAPPING_END) return close(std::move(place), event.mapping_end.mapping_end);
      if (event.type != FYET_SCALAR) throw Refused("a map or list as a key");
      const YamlPlace key = scalar(event, 0);
      std::size_t length = 0;
      const char* const name = fy_token_get_text(event.scalar.value, &length);
      std::string key_text(name, length);
      YamlPlace item = value(events_.next(), text_.find(':', key.end) + 1);
      item.key = std::move(key_text);
      item.key_begin = key.begin;
      item.key_end = key.end;
      place.items.push_back(std::move(item));
    }
  }

  YamlPlace list(fy_token* token, std::size_t after) {
    YamlPlace place;
    place.kind = begins_with(token, '[') ? Kind::kFlowList : Kind::kBlockList;
    if (place.is_flow()) place.begin = after = start_of(token);
    for (;;) {
      const fy_event& event = events_.next();
      if (event.type == FYET_SEQUENCE_END) return close(std::move(place), event.sequence_end.sequence_end);
      place.items.push_back(value(event, after_dash(after)));
      after = place.items.back().end;
    }
  }

  // Only an empty item needs it: the other tokens know their place.
  std::size_t after_dash(std::size_t after) const {
    const std::size_t dash = text_.find('-', after);
    return dash == std::string_view::npos ? after : dash + 1;
  }

  bool begins_with(fy_token* token, char bracket) const {
    return token != nullptr && text_[start_of(token)] == bracket;
  }

  // A collection in block style begins and ends with its items.
  YamlPlace close(YamlPlace place, fy_token* token) const {
    if (place.is_flow()) {
      place.end = start_of(token) + 1;
    } else {
      const YamlPlace& first = place.items.front();
      place.begin = place.is_map() ? first.key_begin : text_.rfind('-', first.begin - 1);
      place.end = place.items.back().end;
    }
    return place;
  }

  std::string_view text_;
  Events events_;
};

}  // namespace

YamlPlace locate_yaml(std::string_view text, const std::filesystem::path& source) {
  try {
    return Locator(text).document();
  } catch (const Refused& refused) {
    throw InputError(source, 0, refused.what(), "YAML that can be edited in place");
  }
}

}  // namespace koboshi::tools
