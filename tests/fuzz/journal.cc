#include "lab/bring_up/journal.h"

#include "lab/bring_up/robot_files.h"
#include "tests/fuzz/fuzz_input.h"

// The journal of a bring-up (JSON), with the origin that bring-up asks for. What was read is written as a
// journal that is read again.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace koboshi;
  static fuzz::InputFile file("bring-up.json");
  const auto read = [](const std::string& text) {
    const std::string_view view = text;
    return fuzz::read_or_refuse([&] {
      return lab::read_journal(file.with({reinterpret_cast<const std::uint8_t*>(view.data()), view.size()}));
    });
  };
  const std::string text(fuzz::text_of({data, size}));
  read(text);  // most likely a file of somebody else
  const std::size_t brace = text.find('{');
  if (brace == std::string::npos) return 0;
  std::string own = text;
  own.insert(brace + 1, std::string("\"origin\": \"") + lab::kOrigin + "\",");
  const auto journal = read(own);
  if (!journal || !*journal) return 0;
  const auto again = read(lab::journal_text(**journal));
  if (!again || !*again || lab::journal_text(**again) != lab::journal_text(**journal)) __builtin_trap();
  return 0;
}
