#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "lab/bring_up/start_values.h"

namespace koboshi::lab {

// A rung of the ladder from a model to a robot that walks.
struct Rung {
  // kImpossible: the robot has no joints for it, or they do not reach it; the rungs above are tried.
  enum class Result { kReached, kFailed, kImpossible, kNotTried };

  std::string name;  // "stands"
  Result result = Result::kNotTried;
  std::string figure;  // what was measured: "leans by 1.2 deg, 5 of 5 robots"
  std::string cause;   // of a failure, or why it is impossible

  // Returns whether the rungs above may be tried.
  bool is_passed() const { return result == Result::kReached || result == Result::kImpossible; }
  // The figure, or the cause.
  const std::string& text() const { return result == Result::kReached ? figure : cause; }
};

// "yes", "NO", "n/a" or "-".
[[nodiscard]] const char* mark_of(Rung::Result result);

// A rung that was tried, as bring-up.json records it.
struct JournalEntry {
  Rung rung;
  std::string inputs;  // a hash of all that the result depends on
};

// The state of a bring-up, kept in bring-up.json: a later call continues from it.
struct Journal {
  std::vector<JournalEntry> entries;  // in the order of the rungs
  StartFactors factors;
  std::optional<double> walked_m_per_s;       // highest speed forward at which no robot fell
  std::size_t searched = 0;                   // candidates of all searches
  std::map<std::string, std::string> hashes;  // of the other files that were written, by relative path
  bool is_complete = false;                   // these files were all written
  // While the journal is incomplete, the hashes of the files that are being written. A file with either hash
  // is as bring-up wrote it.
  std::map<std::string, std::string> next_hashes{};

  const JournalEntry* find(const std::string& rung) const;
};

// Reads a journal; nothing if there is no file. Throws InputError for a file of another version, and for one
// that is not a journal.
[[nodiscard]] std::optional<Journal> read_journal(const std::filesystem::path& file);
// The text of the file.
[[nodiscard]] std::string journal_text(const Journal& journal);

}  // namespace koboshi::lab
