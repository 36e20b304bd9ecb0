#include "lab/learn/checkpoint.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "base/text/error.h"
#include "base/text/text.h"
#include "simulation/record/summary.h"

namespace koboshi::lab {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kCheckpointVersion = 2;

Json json_of(const ValidationMean& validation) {
  return {{"generation", validation.generation},
          {"reward", validation.reward},
          {"survived", validation.survived},
          {"drift_m_per_s", validation.drift_m_per_s},
          {"turn_rad_per_s", validation.turn_rad_per_s},
          {"power_W", validation.power_W},
          {"lean_rad2", validation.lean_rad2},
          {"offset", validation.offset},
          {"stopped", validation.stopped}};
}

ValidationMean validation_of(const Json& json) {
  return {.generation = json.at("generation").get<std::uint64_t>(),
          .reward = json.at("reward").get<double>(),
          .survived = json.at("survived").get<double>(),
          .drift_m_per_s = json.at("drift_m_per_s").get<double>(),
          .turn_rad_per_s = json.at("turn_rad_per_s").get<double>(),
          .power_W = json.at("power_W").get<double>(),
          .lean_rad2 = json.at("lean_rad2").get<double>(),
          .offset = json.at("offset").get<double>(),
          .stopped = json.at("stopped").get<double>()};
}

Checkpoint checkpoint_of(const Json& json) {
  Checkpoint checkpoint;
  checkpoint.inputs = json.at("inputs").get<std::string>();
  checkpoint.search = {.generation = json.at("generation").get<std::uint64_t>(),
                       .steps = json.at("steps").get<std::uint64_t>(),
                       .mean = json.at("mean").get<std::vector<double>>(),
                       .first_moment = json.at("first_moment").get<std::vector<double>>(),
                       .second_moment = json.at("second_moment").get<std::vector<double>>()};
  checkpoint.stage = json.at("stage").get<std::size_t>();
  checkpoint.survived = json.at("survived").get<std::vector<double>>();
  for (const Json& each : json.at("validations")) checkpoint.validations.push_back(validation_of(each));
  checkpoint.best = json.at("best").get<std::size_t>();
  checkpoint.best_weights = json.at("best_weights").get<std::vector<double>>();
  checkpoint.log_bytes = json.at("log_bytes").get<std::uint64_t>();
  return checkpoint;
}

bool is_consistent(const Checkpoint& checkpoint) {
  const std::size_t size = checkpoint.search.mean.size();
  return checkpoint.search.first_moment.size() == size && checkpoint.search.second_moment.size() == size &&
         checkpoint.best_weights.size() <= size && checkpoint.best < checkpoint.validations.size();
}

}  // namespace

void write_checkpoint(const std::filesystem::path& file, const Checkpoint& checkpoint) {
  Json validations = Json::array();
  for (const ValidationMean& each : checkpoint.validations) validations.push_back(json_of(each));
  simulation::write_json(file, Json{{"version", kCheckpointVersion},
                                    {"inputs", checkpoint.inputs},
                                    {"generation", checkpoint.search.generation},
                                    {"steps", checkpoint.search.steps},
                                    {"stage", checkpoint.stage},
                                    {"survived", checkpoint.survived},
                                    {"validations", validations},
                                    {"best", checkpoint.best},
                                    {"log_bytes", checkpoint.log_bytes},
                                    {"best_weights", checkpoint.best_weights},
                                    {"mean", checkpoint.search.mean},
                                    {"first_moment", checkpoint.search.first_moment},
                                    {"second_moment", checkpoint.search.second_moment}});
}

std::optional<Checkpoint> read_checkpoint(const std::filesystem::path& file) {
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) return std::nullopt;
  const char* const kExpected = "the state of a training, as `koboshi learn` writes it";
  const std::string text = read_text_file(file, kExpected);
  try {
    const Json json = Json::parse(text);
    if (json.at("version").get<int>() != kCheckpointVersion)
      throw InputError(file, 0, "version " + one_line(json.at("version").dump()),
                       std::to_string(kCheckpointVersion));
    Checkpoint checkpoint = checkpoint_of(json);
    if (!is_consistent(checkpoint)) throw InputError(file, 0, "lists that do not fit each other", kExpected);
    return checkpoint;
  } catch (const nlohmann::json::exception& error) {
    throw InputError(file, 0, one_line(error.what()), kExpected);
  }
}

}  // namespace koboshi::lab
