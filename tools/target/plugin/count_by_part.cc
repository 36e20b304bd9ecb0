// A plugin of QEMU that counts the instructions of the firmware by the part of it that they belong to. It
// watches the image from outside, so that the image is the same with and without it, and not one instruction
// more.
//
// An instruction belongs to the part of the code that it is in; of code that is of no part, such as the
// compiler's library, to the part that has called it. Who has called is known from the calls and returns that
// are executed.
//
// Arguments: code=FILE, whose lines say ADDRESS SIZE PART ROOT of each stretch of code: PART is a number or
// -1, ROOT is 1 where a function begins that is to be measured. counts=FILE, where each return from a root
// leaves a line with its address and the instructions of each part.
#include <algorithm>
#include <array>
#include <cstdio>
#include <deque>
#include <fstream>
#include <string_view>
#include <vector>

#include "tools/target/plugin/qemu_plugin.h"

int qemu_plugin_version = 1;

namespace {

constexpr int kPartOfCaller = -1;
constexpr std::size_t kMaxParts = 8;

struct Stretch {
  std::uint64_t address = 0;
  std::uint64_t size = 0;
  int part = kPartOfCaller;
  bool root = false;
};

struct Instruction {
  std::uint64_t address = 0;
  std::uint64_t end = 0;
  bool calls = false;
  const Stretch* stretch = nullptr;  // null outside all
};

class Counter {
 public:
  bool open(const char* code, const char* counts) {
    std::ifstream file(code);
    for (Stretch s; file >> s.address >> s.size >> s.part >> s.root;) code_.push_back(s);
    std::ranges::sort(code_, {}, &Stretch::address);
    out_ = std::fopen(counts, "w");
    return !code_.empty() && out_ != nullptr && std::setvbuf(out_, nullptr, _IOLBF, BUFSIZ) == 0;
  }

  Instruction* add(Instruction instruction) {
    const auto after = std::ranges::upper_bound(code_, instruction.address, {}, &Stretch::address);
    if (after != code_.begin() && instruction.address < (after - 1)->address + (after - 1)->size) {
      instruction.stretch = &*(after - 1);
    }
    return &instructions_.emplace_back(instruction);
  }

  void execute(const Instruction& now) {
    while (!calls_.empty() && calls_.back().returns_to == now.address) leave();
    const bool called = before_.calls && now.address != before_.end;
    if (calls_.empty()) {
      if (called && now.stretch != nullptr && now.stretch->root) begin(*now.stretch);
    } else if (called) {
      calls_.push_back({before_.end, part_});
    }
    if (!calls_.empty()) {
      if (now.stretch != before_.stretch) enter(now.stretch);
      ++counts_[static_cast<std::size_t>(part_)];
    }
    before_ = now;
  }

 private:
  struct Call {
    std::uint64_t returns_to;
    int caller_part;
  };

  void begin(const Stretch& root) {
    root_ = root.address;
    part_ = 0;
    counts_.fill(0);
    calls_.push_back({before_.end, part_});
  }

  void enter(const Stretch* stretch) {
    if (stretch != nullptr && stretch->part != kPartOfCaller) part_ = stretch->part;
  }

  void leave() {
    part_ = calls_.back().caller_part;
    calls_.pop_back();
    if (!calls_.empty()) return;
    std::fprintf(out_, "%llu", static_cast<unsigned long long>(root_));
    for (const std::uint64_t count : counts_)
      std::fprintf(out_, " %llu", static_cast<unsigned long long>(count));
    std::fputc('\n', out_);
  }

  std::vector<Stretch> code_;
  std::deque<Instruction> instructions_;  // addresses stay
  std::FILE* out_ = nullptr;
  Instruction before_;
  std::vector<Call> calls_;  // that have not returned, from the root on
  std::uint64_t root_ = 0;
  int part_ = 0;
  std::array<std::uint64_t, kMaxParts> counts_{};
};

Counter counter;

// BL and BLX (register), the two ways to call (ARMv7-M, A7.7.18 and A7.7.19).
bool is_call(const std::uint8_t* bytes, std::size_t size) {
  const unsigned first = bytes[0] | bytes[1] << 8;
  if (size == 2) return (first & 0xFF87) == 0x4780;
  const unsigned second = bytes[2] | bytes[3] << 8;
  return (first & 0xF800) == 0xF000 && (second & 0xD000) == 0xD000;
}

void on_executed(unsigned int, void* instruction) {
  counter.execute(*static_cast<const Instruction*>(instruction));
}

void on_translated(qemu_plugin_id_t, qemu_plugin_tb* block) {
  for (std::size_t i = 0; i < qemu_plugin_tb_n_insns(block); ++i) {
    qemu_plugin_insn* const raw = qemu_plugin_tb_get_insn(block, i);
    const std::uint64_t address = qemu_plugin_insn_vaddr(raw);
    const std::size_t size = qemu_plugin_insn_size(raw);
    const auto* const bytes = static_cast<const std::uint8_t*>(qemu_plugin_insn_data(raw));
    Instruction* const instruction =
        counter.add({.address = address, .end = address + size, .calls = is_call(bytes, size)});
    qemu_plugin_register_vcpu_insn_exec_cb(raw, on_executed, QEMU_PLUGIN_CB_NO_REGS, instruction);
  }
}

const char* value(int argc, char** argv, std::string_view key) {
  for (int i = 0; i < argc; ++i) {
    if (std::string_view(argv[i]).starts_with(key)) return argv[i] + key.size();
  }
  return "";
}

}  // namespace

int qemu_plugin_install(qemu_plugin_id_t id, const qemu_info_t*, int argc, char** argv) {
  if (!counter.open(value(argc, argv, "code="), value(argc, argv, "counts="))) return 1;
  qemu_plugin_register_vcpu_tb_trans_cb(id, on_translated);
  return 0;
}
