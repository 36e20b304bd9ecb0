#include <sstream>

#include "sim_board/can/candump_log.h"
#include "tests/fuzz/fuzz_input.h"

// A log of can-utils. What is read and written again reads as the same frame.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace koboshi;
  using namespace koboshi::sim_board;
  std::istringstream stream{std::string(fuzz::text_of({data, size}))};
  CandumpReader reader(stream, "can.log");
  while (true) {
    const auto frame = fuzz::read_or_refuse([&] { return reader.next(); });
    if (!frame || !*frame) return 0;
    std::string line = log_line(**frame);
    line.pop_back();  // the newline
    const LogLine again = parse_log_line(line);
    if (again.kind != LineKind::kFrame || again.logged.frame != (*frame)->frame) __builtin_trap();
  }
}
