#include "sim_board/state/archive.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "sim_board/random/random_stream.h"
#include "sim_board/storage/node_flash.h"

namespace koboshi::sim_board {
namespace {

// One member of every kind.
struct Machine {
  // Not copyable, with a state of its own.
  struct Part {
    explicit Part(int number) : number(number) {}
    Part(const Part&) = delete;
    Part& operator=(const Part&) = delete;

    void archive(StateArchive& archive) { archive(number); }
    int number;
  };
  // Holds a pointer to itself.
  struct Ring {
    Ring() : newest(&slots[0]) {}
    Ring(const Ring&) = delete;
    Ring& operator=(const Ring&) = delete;

    std::array<int, 3> slots{};
    int* newest;
  };

  void archive(StateArchive& archive) {
    archive(count, name, queue, parts, spare, waiting, late);
    archive.in_place(ring);
  }

  int count = 1;
  std::string name = "one";
  std::vector<int> queue{1, 2};
  std::vector<std::unique_ptr<Part>> parts;
  std::optional<Part> spare;
  std::optional<double> waiting = 0.5;
  std::multimap<int, std::string> late{{3, "three"}, {3, "drei"}};
  Ring ring;
};

TEST(StateArchive, RestoresEveryKindOfMember) {
  Machine machine;
  machine.parts.push_back(std::make_unique<Machine::Part>(7));
  machine.spare.emplace(8);
  machine.ring.slots = {1, 2, 3};
  const SavedState saved = StateArchive::save(machine);

  machine.count = 2;
  machine.name = std::string(100, 'x');
  machine.queue = {};
  machine.parts[0]->number = machine.spare->number = 0;
  machine.waiting.reset();
  machine.late = {};
  machine.ring.slots = {};
  machine.ring.newest = &machine.ring.slots[2];
  for (int twice = 0; twice < 2; ++twice) {
    StateArchive::restore(saved, machine);
    EXPECT_EQ(machine.count, 1);
    EXPECT_EQ(machine.name, "one");
    EXPECT_EQ(machine.queue, (std::vector{1, 2}));
    EXPECT_EQ(machine.parts[0]->number, 7);
    EXPECT_EQ(machine.spare->number, 8);
    EXPECT_EQ(machine.waiting, 0.5);
    EXPECT_EQ(machine.late, (std::multimap<int, std::string>{{3, "three"}, {3, "drei"}}));
    EXPECT_EQ(machine.ring.slots, (std::array{1, 2, 3}));
    EXPECT_EQ(machine.ring.newest, &machine.ring.slots[0]);
  }
}

TEST(StateArchive, RejectsAnotherNumberOfObjects) {
  Machine machine;
  const SavedState saved = StateArchive::save(machine);
  machine.parts.push_back(std::make_unique<Machine::Part>(7));
  EXPECT_THROW(StateArchive::restore(saved, machine), std::logic_error);
  machine.parts.clear();
  machine.spare.emplace(8);
  EXPECT_THROW(StateArchive::restore(saved, machine), std::logic_error);
  machine.spare.reset();
  int more = 0;
  EXPECT_THROW(StateArchive::restore(saved, machine, more), std::logic_error);
  const SavedState larger = StateArchive::save(machine, more);
  EXPECT_THROW(StateArchive::restore(larger, machine), std::logic_error);
}

TEST(StateArchive, RestoresRandomStreams) {
  RandomStream random(1, "test");
  random.normal();  // leaves a spare one
  const SavedState saved = StateArchive::save(random);
  const std::array first{random.normal(), random.normal(), random.uniform()};
  StateArchive::restore(saved, random);
  EXPECT_EQ((std::array{random.normal(), random.normal(), random.uniform()}), first);
}

TEST(StateArchive, RestoresFlashAndPendingWrites) {
  NodeFlash flash;
  ASSERT_TRUE(flash.begin_write(NodeFlash::kSectorSize_bytes, std::array{std::byte{1}, std::byte{2}}));
  while (flash.state() == hal::StorageState::kBusy) {
  }
  ASSERT_TRUE(flash.begin_erase(NodeFlash::kSectorSize_bytes));
  ASSERT_EQ(flash.state(), hal::StorageState::kBusy);
  const std::vector<std::byte> before(flash.contents().begin(), flash.contents().end());
  const SavedState saved = StateArchive::save(flash);
  EXPECT_LT(saved.size_bytes(), 2 * NodeFlash::kSectorSize_bytes + 100);

  flash.lose_power();
  ASSERT_TRUE(flash.begin_erase(2 * NodeFlash::kSectorSize_bytes));
  StateArchive::restore(saved, flash);
  EXPECT_TRUE(std::ranges::equal(flash.contents(), before));
  while (flash.state() == hal::StorageState::kBusy) {
  }
  EXPECT_EQ(std::ranges::count(flash.contents(), std::byte{0xFF}),
            static_cast<std::ptrdiff_t>(flash.contents().size()));
}

}  // namespace
}  // namespace koboshi::sim_board
