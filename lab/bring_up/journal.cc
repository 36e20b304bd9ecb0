#include "lab/bring_up/journal.h"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "base/text/error.h"
#include "base/text/text.h"
#include "lab/bring_up/robot_files.h"

namespace koboshi::lab {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kJournalVersion = 1;

Json json_of(const StartFactors& factors) {
  return {{"com_height", factors.com_height},
          {"step_time", factors.step_time},
          {"gains", factors.gains},
          {"trunk_pitch_deg", factors.trunk_pitch_deg}};
}

StartFactors factors_of(const Json& json) {
  return {.com_height = json.at("com_height").get<double>(),
          .step_time = json.at("step_time").get<double>(),
          .gains = json.at("gains").get<double>(),
          .trunk_pitch_deg = json.at("trunk_pitch_deg").get<double>()};
}

Journal journal_of(const Json& json) {
  Journal journal{.entries = {},
                  .factors = factors_of(json.at("factors")),
                  .walked_m_per_s = {},
                  .searched = json.at("searched").get<std::size_t>(),
                  .hashes = json.at("files").get<std::map<std::string, std::string>>(),
                  .is_complete = json.at("complete").get<bool>(),
                  .next_hashes = {}};
  if (json.contains("walked_m_per_s")) journal.walked_m_per_s = json.at("walked_m_per_s").get<double>();
  if (json.contains("next_files"))
    journal.next_hashes = json.at("next_files").get<std::map<std::string, std::string>>();
  for (const Json& entry : json.at("rungs")) {
    const auto mark = entry.at("result").get<std::string>();
    const auto result = mark == mark_of(Rung::Result::kReached)      ? Rung::Result::kReached
                        : mark == mark_of(Rung::Result::kImpossible) ? Rung::Result::kImpossible
                                                                     : Rung::Result::kFailed;
    journal.entries.push_back({{.name = entry.at("name").get<std::string>(),
                                .result = result,
                                .figure = entry.at("figure").get<std::string>(),
                                .cause = entry.at("cause").get<std::string>()},
                               entry.at("inputs").get<std::string>()});
  }
  return journal;
}

}  // namespace

const char* mark_of(Rung::Result result) {
  constexpr std::array<const char*, 4> kMarks{"yes", "NO", "n/a", "-"};
  return kMarks.at(static_cast<std::size_t>(result));
}

const JournalEntry* Journal::find(const std::string& rung) const {
  const auto found =
      std::ranges::find_if(entries, [&](const JournalEntry& entry) { return entry.rung.name == rung; });
  return found == entries.end() ? nullptr : &*found;
}

std::optional<Journal> read_journal(const std::filesystem::path& file) {
  const std::optional<std::string> text = read_own(file);
  if (!text) return std::nullopt;
  const char* const expected = "a journal of bring-up, version 1 (--restart begins anew)";
  try {
    const Json json = Json::parse(*text);
    if (json.at("version") != kJournalVersion)
      throw InputError(file, 0, "version " + one_line(json.at("version").dump()), expected);
    return journal_of(json);
  } catch (const Json::exception& error) {
    throw InputError(file, 0, one_line(error.what()), expected);
  }
}

std::string journal_text(const Journal& journal) {
  Json rungs = Json::array();
  for (const JournalEntry& entry : journal.entries)
    rungs.push_back({{"name", entry.rung.name},
                     {"result", mark_of(entry.rung.result)},
                     {"figure", entry.rung.figure},
                     {"cause", entry.rung.cause},
                     {"inputs", entry.inputs}});
  Json json{{"origin", kOrigin},
            {"version", kJournalVersion},
            {"complete", journal.is_complete},
            {"factors", json_of(journal.factors)},
            {"searched", journal.searched},
            {"files", journal.hashes},
            {"rungs", rungs}};
  if (!journal.next_hashes.empty()) json["next_files"] = journal.next_hashes;
  if (journal.walked_m_per_s) json["walked_m_per_s"] = *journal.walked_m_per_s;
  return json.dump(2) + "\n";
}

}  // namespace koboshi::lab
