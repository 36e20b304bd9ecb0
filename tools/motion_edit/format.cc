#include "tools/motion_edit/format.h"

#include <algorithm>
#include <vector>

#include "base/edit/yaml_document.h"
#include "base/edit/yaml_places.h"
#include "base/text/error.h"
#include "base/text/text.h"
#include "base/yaml/yaml_tree.h"

namespace koboshi::tools {
namespace {

struct Comment {
  std::size_t offset = 0;
  std::string text;  // from its # to the end of the line
  bool is_on_own_line = false;
};

// Finds the comments: each # after a blank or at the beginning of a line, outside of values and keys.
class CommentFinder {
 public:
  CommentFinder(const std::string& text, const YamlPlace& root)
      : text_(text), opaque_(text.size() + 1, false) {
    mark(root);
  }

  std::vector<Comment> find() const {
    std::vector<Comment> comments;
    for (std::size_t i = 0; i < text_.size(); ++i) {
      if (text_[i] != '#' || opaque_[i]) continue;
      if (i > 0 && text_[i - 1] != ' ' && text_[i - 1] != '\t' && text_[i - 1] != '\n') continue;
      const std::size_t end = std::min(text_.find('\n', i), text_.size());
      const std::size_t line = i == 0 ? 0 : text_.rfind('\n', i - 1) + 1;
      const bool own = text_.find_first_not_of(" \t", line) == i;
      std::string comment = text_.substr(i, end - i);
      while (!comment.empty() && (comment.back() == ' ' || comment.back() == '\r' || comment.back() == '\t'))
        comment.pop_back();
      comments.push_back({i, std::move(comment), own});
      i = end;
    }
    return comments;
  }

 private:
  void mark(const YamlPlace& place) {
    std::fill(opaque_.begin() + static_cast<std::ptrdiff_t>(place.key_begin),
              opaque_.begin() + static_cast<std::ptrdiff_t>(place.key_end), true);
    if (place.kind == YamlPlace::Kind::kScalar || place.kind == YamlPlace::Kind::kBlockText) {
      std::fill(opaque_.begin() + static_cast<std::ptrdiff_t>(place.begin),
                opaque_.begin() + static_cast<std::ptrdiff_t>(place.end), true);
    }
    for (const YamlPlace& item : place.items) mark(item);
  }

  const std::string& text_;
  std::vector<bool> opaque_;
};

class Formatter {
 public:
  Formatter(const std::string& text, const YamlPlace& root)
      : text_(text), root_(root), comments_(CommentFinder(text, root).find()) {}

  std::string format() {
    for (const YamlPlace& item : root_.items) write_root_item(item);
    write_comments_before(text_.size() + 1, "");
    return std::move(out_);
  }

 private:
  static std::size_t begin_of(const YamlPlace& place) {
    return place.key.empty() ? place.begin : place.key_begin;
  }

  // --- Comments and empty lines

  // Whether the line of `offset` follows an empty line.
  bool is_after_empty_line(std::size_t offset) const {
    if (offset > text_.size()) return false;
    std::size_t line = offset == 0 ? 0 : text_.rfind('\n', offset - 1);
    if (offset == 0 || line == std::string::npos || line == 0) return false;
    const std::size_t before = text_.rfind('\n', line - 1);
    const std::size_t begin = before == std::string::npos ? 0 : before + 1;
    return text_.find_first_not_of(" \t\r", begin) >= line;
  }

  void write_empty_line(std::size_t offset) {
    const bool is_first = out_.empty() || out_.ends_with("\n\n") || !out_.ends_with('\n');
    if (!is_first && is_after_empty_line(offset)) out_ += '\n';
  }

  void write_comments_before(std::size_t end, const std::string& indent) {
    for (; next_ < comments_.size() && comments_[next_].offset < end; ++next_) {
      write_empty_line(comments_[next_].offset);
      out_ += indent + comments_[next_].text + "\n";
    }
  }

  // Begins a line for the value that begins at `begin`, after the comments above it. A dash of `lead` stands
  // in the line alone.
  void begin_line(std::size_t begin, std::size_t comments_end, const std::string& lead) {
    std::string indent = lead;
    if (indent.ends_with("- ")) indent.resize(indent.size() - 2);
    write_comments_before(comments_end, indent);
    write_empty_line(begin);
    out_ += lead;
  }

  // Ends the line, with a comment that stands in the same line as `end`.
  void end_line(std::size_t end) {
    if (next_ < comments_.size() && !comments_[next_].is_on_own_line &&
        text_.find('\n', end) > comments_[next_].offset) {
      out_ += "  " + comments_[next_++].text;
    }
    out_ += '\n';
  }

  // --- Values on one line

  std::string scalar_text(const YamlPlace& place) const {
    std::string text = text_.substr(place.begin, place.end - place.begin);
    if (place.kind == YamlPlace::Kind::kScalar && text.find('\n') == std::string::npos) return text;
    // A text over several lines: its value, quoted.
    const std::string document = "{value: " + text + "}";
    std::string value;
    try {
      value = parse_yaml(place.kind == YamlPlace::Kind::kScalar ? document : "value: " + text, "")
                  .items.at(0)
                  .scalar;
    } catch (const InputError&) {
      value = text;
    }
    std::string quoted = "\"";
    for (const char letter : value) {
      if (letter == '"' || letter == '\\') quoted += '\\';
      quoted += letter == '\n'   ? std::string("\\n")
                : letter == '\t' ? std::string("\\t")
                                 : std::string(1, letter);
    }
    return quoted + "\"";
  }

  std::string key_text(const YamlPlace& place) const {
    return text_.substr(place.key_begin, place.key_end - place.key_begin);
  }

  // Quotes a plain scalar of block style that flow style would misread.
  std::string flow_scalar(const YamlPlace& place) const {
    std::string text = scalar_text(place);
    const bool plain = !text.empty() && text.front() != '"' && text.front() != '\'';
    if (!plain || text.find_first_of(",[]{}") == std::string::npos) return text;
    return "\"" + text + "\"";
  }

  std::string flow_text(const YamlPlace& place) const {
    if (!place.is_map() && !place.is_list()) return flow_scalar(place);
    std::string text;
    for (const YamlPlace& item : place.items) {
      if (!text.empty()) text += ", ";
      if (place.is_map()) text += key_text(item) + ": ";
      text += flow_text(item);
    }
    return place.is_map() ? "{" + text + "}" : "[" + text + "]";
  }

  // --- Lines

  static const YamlPlace* find(const YamlPlace& map, const std::string& key) {
    for (const YamlPlace& item : map.items) {
      if (item.key == key) return &item;
    }
    return nullptr;
  }

  void write_line(const YamlPlace& item, const std::string& indent) {
    begin_line(begin_of(item), item.end, indent);
    const std::string value = item.is_map() || item.is_list() ? flow_text(item) : scalar_text(item);
    out_ += key_text(item) + (value.empty() ? ":" : ": " + value);
    end_line(item.end);
  }

  void write_key(const YamlPlace& item, const std::string& indent) {
    begin_line(begin_of(item), begin_of(item), indent);
    out_ += key_text(item) + ":";
    end_line(item.key_end);
  }

  void write_root_item(const YamlPlace& item) {
    const bool has_items = !item.items.empty();
    if (item.key == "poses" && item.is_map() && has_items) {
      write_key(item, "");
      for (const YamlPlace& pose : item.items) write_line(pose, "  ");
    } else if (item.key == "routines" && item.is_map() && has_items) {
      write_key(item, "");
      for (const YamlPlace& routine : item.items) {
        if (!routine.is_list() || routine.items.empty()) {
          write_line(routine, "  ");
          continue;
        }
        write_key(routine, "  ");
        write_steps(routine, "    ");
      }
    } else if (item.key == "steps" && item.is_list() && has_items) {
      write_key(item, "");
      write_steps(item, "  ");
    } else {
      write_line(item, "");
    }
  }

  void write_steps(const YamlPlace& list, const std::string& indent) {
    for (const YamlPlace& step : list.items) write_step(step, indent);
  }

  void write_step(const YamlPlace& step, const std::string& indent) {
    const YamlPlace* loop = step.is_map() ? find(step, "loop") : nullptr;
    const bool is_loop = loop != nullptr && step.items.size() == 1 && loop->is_map() && !loop->items.empty();
    const bool is_if = step.is_map() && find(step, "if") != nullptr && find(step, "then") != nullptr;
    if (is_loop) {
      begin_line(step.begin, begin_of(*loop), indent + "- ");
      out_ += "loop:";
      end_line(loop->key_end);
      write_block(*loop, indent + "    ", false);
    } else if (is_if) {
      write_block(step, indent, true);
    } else {
      begin_line(step.begin, step.end, indent + "- ");
      out_ += step.is_map() || step.is_list() ? flow_text(step) : scalar_text(step);
      end_line(step.end);
    }
  }

  // Writes the entries of a map, those that are lists of steps as blocks. `is_item`: the first follows a
  // dash.
  void write_block(const YamlPlace& map, const std::string& indent, bool is_item) {
    bool is_first = is_item;
    for (const YamlPlace& entry : map.items) {
      const std::string lead = is_item ? indent + (is_first ? "- " : "  ") : indent;
      is_first = false;
      const bool nests = (entry.key == "steps" || entry.key == "then" || entry.key == "else") &&
                         entry.is_list() && !entry.items.empty();
      if (!nests) {
        write_line(entry, lead);
        continue;
      }
      write_key(entry, lead);
      write_steps(entry, indent + (is_item ? "    " : "  "));
    }
  }

  const std::string& text_;
  const YamlPlace& root_;
  std::vector<Comment> comments_;
  std::size_t next_ = 0;  // comment to write
  std::string out_;
};

bool is_same(const YamlNode& a, const YamlNode& b) {
  return a.kind == b.kind && a.key == b.key && a.scalar == b.scalar && a.items.size() == b.items.size() &&
         std::equal(a.items.begin(), a.items.end(), b.items.begin(), is_same);
}

// The layout is that of motions: a scenario in it would be no longer readable.
void refuse_other_files(const YamlNode& root, const std::filesystem::path& source) {
  const YamlNode* version = root.find("version");
  const int line = version == nullptr ? 0 : version->line;
  const std::string number = version == nullptr ? std::string() : version->scalar;
  if (number != "1" && number != "2") {
    throw InputError(source, line, version == nullptr ? "no version" : "version " + one_line(number),
                     "a motion of version 1 or 2");
  }
  if (root.find("steps") == nullptr) throw InputError(source, 0, "no key steps", "a motion");
}

}  // namespace

std::string format_motion(const std::filesystem::path& source, const std::string& text) {
  const YamlNode before = parse_yaml(text, source);
  refuse_other_files(before, source);
  std::string formatted = Formatter(text, locate_yaml(text, source)).format();
  if (!is_same(before, parse_yaml(formatted, source)))
    throw InputError(source, 0, "a layout that the formatter cannot keep",
                     "a motion file in flow and block style");
  return formatted;
}

std::string upgrade_motion(const std::filesystem::path& source, const std::string& text) {
  YamlDocument document(source, text);
  const YamlNode* version = document.tree().find("version");
  if (version == nullptr || version->scalar != "1") return text;
  // In version 1 an end follows every last step; in version 2 a jump can be the last one.
  const YamlNode* steps = document.tree().find("steps");
  const bool ends_with_jump =
      steps != nullptr && !steps->items.empty() && steps->items.back().find("jump") != nullptr;
  if (ends_with_jump) document.insert(YamlPath("steps." + std::to_string(steps->items.size())), "end");
  document.set("version", "2");
  return document.text();
}

}  // namespace koboshi::tools
