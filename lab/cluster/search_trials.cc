#include "lab/cluster/search_trials.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <iterator>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include "base/file/output_file.h"
#include "base/file/output_folder.h"
#include "base/text/error.h"
#include "lab/experiment/trial_store.h"
#include "simulation/batch/parallel.h"

namespace koboshi::lab {
namespace {

namespace fs = std::filesystem;
using WaitClock = std::chrono::steady_clock;

// Sets the record of a trial if it is known, and returns whether it is.
bool take(const TrialStore& store, SearchTrial& wanted) {
  const Record* record = store.find(*wanted.experiment, wanted.trial.cell, wanted.trial.seed);
  if (record != nullptr) wanted.trial.record = *record;
  return record != nullptr;
}

// Trials that were finished before, and a file that keeps those that are played now.
class KeptTrials {
 public:
  KeptTrials(const fs::path& file, const TrialFormat& format)
      : store_(format.experiment, format.metrics), out_(file, OutputFile::Mode::kAppend) {
    fs::resize_file(file, store_.read(file));
  }

  TrialStore& store() { return store_; }

  // Plays these trials, by number, or takes them if they are known by then.
  void play(std::vector<SearchTrial>& trials, const std::vector<std::size_t>& numbers, std::size_t jobs,
            const TrialFinished& finished) {
    std::mutex mutex;
    simulation::for_each_parallel(numbers.size(), jobs, [&](std::size_t i) {
      SearchTrial& wanted = trials[numbers[i]];
      {
        const std::lock_guard lock(mutex);
        if (take(store_, wanted)) return finished(numbers[i]);
      }
      wanted.trial.record = wanted.experiment->play(wanted.trial.cell, wanted.trial.seed);
      const std::lock_guard lock(mutex);
      // Two candidates may be the same point: one line is enough.
      if (store_.find(*wanted.experiment, wanted.trial.cell, wanted.trial.seed) == nullptr) {
        store_.add(*wanted.experiment, wanted.trial);
        out_.write(trial_line(*wanted.experiment, wanted.trial));
        out_.flush();
      }
      finished(numbers[i]);
    });
  }

 private:
  TrialStore store_;
  OutputFile out_;
};

class PassingTrials : public SearchTrials {
 public:
  explicit PassingTrials(std::size_t jobs) : jobs_(jobs) {}

  void play(std::vector<SearchTrial>& trials, const TrialFinished& finished) override {
    std::mutex mutex;
    simulation::for_each_parallel(trials.size(), jobs_, [&](std::size_t i) {
      Trial& trial = trials[i].trial;
      trial.record = trials[i].experiment->play(trial.cell, trial.seed);
      const std::lock_guard lock(mutex);
      finished(i);
    });
  }

 private:
  const std::size_t jobs_;
};

class NoTrials : public SearchTrials {
 public:
  void play(std::vector<SearchTrial>& trials, const TrialFinished&) override {
    throw TrialsMissing(trials.size(), trials.size());
  }
};

class LocalTrials : public SearchTrials {
 public:
  LocalTrials(const fs::path& log, const TrialFormat& format, std::size_t jobs)
      : kept_(log, format), jobs_(jobs) {}

  void play(std::vector<SearchTrial>& trials, const TrialFinished& finished) override {
    std::vector<std::size_t> all(trials.size());
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
    kept_.play(trials, all, jobs_, finished);
  }

 private:
  KeptTrials kept_;
  const std::size_t jobs_;
};

// The files of all shards, as far as they were read.
class ShardFiles {
 public:
  ShardFiles(fs::path folder, std::size_t count) : folder_(std::move(folder)), offsets_(count, 0) {}

  void read_into(TrialStore& store) {
    for (std::size_t i = 0; i < offsets_.size(); ++i)
      offsets_[i] = store.read(shard_file(folder_, {i + 1, offsets_.size()}), offsets_[i]);
  }

 private:
  const fs::path folder_;
  std::vector<std::uintmax_t> offsets_;
};

class ShardTrials : public SearchTrials {
 public:
  ShardTrials(const fs::path& folder, const Shard& shard, const TrialFormat& format, std::size_t jobs)
      : shard_(shard), jobs_(jobs), kept_(shard_file(folder, shard), format), files_(folder, shard.count) {}

  void play(std::vector<SearchTrial>& trials, const TrialFinished& finished) override {
    known_.assign(trials.size(), false);
    const TrialFinished once = [&](std::size_t number) {
      known_[number] = true;
      finished(number);
    };
    const WaitClock::time_point begin = WaitClock::now();
    take_known(trials, once);
    const auto [first, end] = range_of(shard_, trials.size());
    play_unknown(trials, first, end, trials.size(), once);
    const auto patience = 2 * (WaitClock::now() - begin) + std::chrono::seconds(1);
    // By turns: a file server answers for all shards, so that many of them look less often.
    const auto pause = std::chrono::milliseconds(std::min<std::size_t>(20 * shard_.count, 5000));
    for (WaitClock::time_point since = WaitClock::now(); !take_known(trials, once);) {
      if (WaitClock::now() - since < patience) {
        std::this_thread::sleep_for(pause);
      } else {
        play_unknown(trials, end, end + trials.size(), jobs_, once);
      }
    }
  }

 private:
  // True if all are known.
  bool take_known(std::vector<SearchTrial>& trials, const TrialFinished& once) {
    files_.read_into(kept_.store());
    bool all = true;
    for (std::size_t i = 0; i < trials.size(); ++i) {
      if (!known_[i] && take(kept_.store(), trials[i])) once(i);
      all = all && known_[i];
    }
    return all;
  }

  // Plays at most so many of the trials from `first` to before `end`, which is counted beyond the last trial
  // from the first one again.
  void play_unknown(std::vector<SearchTrial>& trials, std::size_t first, std::size_t end, std::size_t at_most,
                    const TrialFinished& once) {
    std::vector<std::size_t> numbers;
    for (std::size_t i = first; i < end && numbers.size() < at_most; ++i) {
      if (!known_[i % trials.size()]) numbers.push_back(i % trials.size());
    }
    kept_.play(trials, numbers, jobs_, once);
  }

  const Shard shard_;
  const std::size_t jobs_;
  KeptTrials kept_;
  ShardFiles files_;
  std::vector<bool> known_{};  // of this generation
};

class MergedTrials : public SearchTrials {
 public:
  MergedTrials(const fs::path& folder, std::size_t shards, const TrialFormat& format, const fs::path& log)
      : store_(format.experiment, format.metrics), written_(format.experiment, format.metrics) {
    ShardFiles(folder, shards).read_into(store_);
    if (!log.empty()) out_.emplace(log);
  }

  void play(std::vector<SearchTrial>& trials, const TrialFinished& finished) override {
    std::size_t missing = 0;
    for (SearchTrial& wanted : trials) missing += take(store_, wanted) ? 0u : 1u;
    if (missing > 0) throw TrialsMissing(missing, trials.size());
    for (std::size_t i = 0; i < trials.size(); ++i) {
      write(trials[i]);
      finished(i);
    }
    if (out_) out_->flush();
  }

 private:
  void write(const SearchTrial& wanted) {
    if (!out_ || written_.find(*wanted.experiment, wanted.trial.cell, wanted.trial.seed) != nullptr) return;
    written_.add(*wanted.experiment, wanted.trial);
    out_->write(trial_line(*wanted.experiment, wanted.trial));
  }

  TrialStore store_;
  TrialStore written_;
  std::optional<OutputFile> out_;
};

}  // namespace

std::unique_ptr<SearchTrials> make_passing_trials(std::size_t jobs) {
  return std::make_unique<PassingTrials>(jobs);
}

std::unique_ptr<SearchTrials> make_local_trials(const fs::path& log, const TrialFormat& format,
                                                std::size_t jobs) {
  return std::make_unique<LocalTrials>(log, format, jobs);
}

std::unique_ptr<SearchTrials> make_shard_trials(const fs::path& folder, const Shard& shard,
                                                const TrialFormat& format, std::size_t jobs) {
  return std::make_unique<ShardTrials>(folder, shard, format, jobs);
}

std::unique_ptr<SearchTrials> make_merged_trials(const fs::path& folder, std::size_t shards,
                                                 const TrialFormat& format, const fs::path& log) {
  return std::make_unique<MergedTrials>(folder, shards, format, log);
}

std::unique_ptr<SearchTrials> make_no_trials() { return std::make_unique<NoTrials>(); }

void merge_into(const fs::path& folder, const std::function<void(const fs::path&)>& merge,
                const std::function<std::string()>& so_far) {
  const FolderLock lock(folder);
  const fs::path beside = folder / "merging";
  fs::remove_all(beside);
  fs::create_directory(beside);
  try {
    merge(beside);
  } catch (const TrialsMissing& error) {
    fs::remove_all(beside);
    throw InputError(folder, 0,
                     fmt::format("incomplete shards: {} of {} trials are missing after {}", error.missing,
                                 error.all, so_far()),
                     "those of a whole search (koboshi lab submit runs the shards)");
  }
  for (const auto& entry : fs::directory_iterator(beside))
    fs::rename(entry.path(), folder / entry.path().filename());
  fs::remove(beside);
}

std::vector<ShardProgress> search_progress(const fs::path& folder, std::size_t shards, std::size_t left) {
  std::vector<ShardProgress> progress;
  for (std::size_t i = 1; i <= shards; ++i) {
    std::ifstream file(shard_file(folder, {i, shards}), std::ios::binary);
    const auto lines = std::count(std::istreambuf_iterator<char>(file), {}, '\n');
    progress.push_back({.finished = static_cast<std::size_t>(lines),
                        .remaining = left == 0 ? 0 : std::max<std::size_t>(1, left / shards)});
  }
  return progress;
}

}  // namespace koboshi::lab
