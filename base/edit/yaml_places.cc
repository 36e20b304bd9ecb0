#include "base/edit/yaml_places.h"

#include <string>
#include <utility>

#include "base/text/error.h"
#include "base/yaml/yaml_events.h"

namespace koboshi {
namespace {

using Kind = YamlPlace::Kind;

std::size_t start_of(fy_token* token) { return fy_token_start_mark(token)->input_pos; }
std::size_t end_of(fy_token* token) { return fy_token_end_mark(token)->input_pos; }

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
        throw YamlRefused("an alias", 0);
    }
  }

  YamlPlace scalar(const fy_event& event, std::size_t after) const {
    YamlPlace place;
    place.begin = place.end = after;
    fy_token* token = event.scalar.value;
    const fy_scalar_style style = fy_token_scalar_style(token);
    if (style == FYSS_PLAIN && text_of(token).empty()) return place;
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
      if (event.type != FYET_SCALAR) throw YamlRefused("a map or list as a key", 0);
      const YamlPlace key = scalar(event, 0);
      std::string key_text(text_of(event.scalar.value));
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
  YamlEvents events_;
};

}  // namespace

YamlPlace locate_yaml(std::string_view text, const std::filesystem::path& source) {
  try {
    return Locator(text).document();
  } catch (const YamlRefused& refused) {
    throw InputError(source, refused.line, refused.what(), "YAML that can be edited in place");
  }
}

}  // namespace koboshi
