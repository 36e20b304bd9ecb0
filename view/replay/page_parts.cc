#include "view/replay/page_parts.h"

// Embeds a file in read-only data between two symbols. The assembler reads it; CMakeLists.txt names the files
// as dependencies.
#define KOBOSHI_EMBED(name, file)                      \
  asm(".section .rodata\n"                             \
      ".global koboshi_page_" #name                    \
      "_begin\n"                                       \
      ".global koboshi_page_" #name                    \
      "_end\n"                                         \
      "koboshi_page_" #name                            \
      "_begin:\n"                                      \
      ".incbin \"" file                                \
      "\"\n"                                           \
      "koboshi_page_" #name                            \
      "_end:\n"                                        \
      ".previous\n");                                  \
  extern "C" const char koboshi_page_##name##_begin[]; \
  extern "C" const char koboshi_page_##name##_end[];   \
  static_assert(true)

KOBOSHI_EMBED(html, KOBOSHI_PAGE_HTML);
KOBOSHI_EMBED(style, KOBOSHI_PAGE_STYLE);
KOBOSHI_EMBED(three, KOBOSHI_PAGE_THREE);
KOBOSHI_EMBED(scripts, KOBOSHI_PAGE_SCRIPTS);

namespace koboshi::view {

PageParts page_parts() {
  const auto between = [](const char* begin, const char* end) {
    return std::string_view(begin, static_cast<std::size_t>(end - begin));
  };
  return {.html = between(koboshi_page_html_begin, koboshi_page_html_end),
          .style = between(koboshi_page_style_begin, koboshi_page_style_end),
          .three = between(koboshi_page_three_begin, koboshi_page_three_end),
          .scripts = between(koboshi_page_scripts_begin, koboshi_page_scripts_end)};
}

}  // namespace koboshi::view
