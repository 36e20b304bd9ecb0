// Writes the replay pages that replay_test.py opens into a folder.

#include <exception>
#include <filesystem>
#include <iostream>

#include "tests/support/walking_recording.h"
#include "view/replay/replay_page.h"

int main(int argc, char** argv) try {
  using namespace koboshi::view;
  if (argc != 2) throw std::invalid_argument("usage: sample_pages FOLDER");
  const std::filesystem::path folder = argv[1];
  const Recording sample = walking_recording();
  const Recording stumbling = walking_recording({.stumbles_at_s = 1.5});
  const Recording minute = walking_recording({.duration_s = 60.0, .signals = 133, .drives = 48});
  write_replay_page(sample, nullptr, walking_network(), folder / "sample.html");
  write_replay_page(sample, &stumbling, walking_network(), folder / "compare.html");
  write_replay_page(minute, nullptr, walking_network(), folder / "minute.html");
  return 0;
} catch (const std::exception& error) {
  std::cerr << "sample_pages: " << error.what() << '\n';
  return 1;
}
