#include "lab/experiment/trial_log.h"

namespace koboshi::lab {

TrialLog::TrialLog(const std::filesystem::path& file, const Experiment& experiment)
    : experiment_(experiment), known_(experiment.name, experiment.metrics) {
  if (file.empty()) return;
  out_.emplace(file, OutputFile::Mode::kAppend);
  std::filesystem::resize_file(file, known_.read(file));
}

std::optional<Record> TrialLog::find(std::size_t cell, std::uint64_t seed) const {
  const Record* known = known_.find(experiment_, cell, seed);
  return known == nullptr ? std::nullopt : std::optional(*known);
}

void TrialLog::add(const Trial& trial) {
  if (!out_) return;
  const std::string line = trial_line(experiment_, trial);
  const std::lock_guard lock(mutex_);
  out_->write(line);
  out_->flush();
}

}  // namespace koboshi::lab
