#include "simulation/record/summary.h"

#include <gtest/gtest.h>

#include <sys/resource.h>

#include <csignal>
#include <limits>
#include <system_error>

#include "tests/support/temporary_folder.h"

namespace koboshi::simulation {
namespace {

const RunSummary kSummary = {
    .fell = false,
    .verdict = "stands; did not fall; 0 faults",
    .falls = 0,
    .stands = true,
    .duration_s = 60.0,
    .can_bus_load = 0.512,
    .state_hash = "00000000deadbeef",
    .faults = 0,
    .solver_warnings = 2,
    .stepper = "world",
    .base_height_error_max_m = 0.0015,
    .foot_slip_max_m = 0.00025,
    .events = {{2'000'600, "command", "Command enable: obeyed.", {{"command", "enable"}}}}};

TEST(Summary, HasItsKeysInOrder) {
  test::TemporaryFolder folder;
  write_json(folder.path / "summary.json", to_json(kSummary));
  EXPECT_EQ(test::read_file(folder.path / "summary.json"),
            "{\n"
            "  \"fell\": false,\n"
            "  \"verdict\": \"stands; did not fall; 0 faults\",\n"
            "  \"falls\": 0,\n"
            "  \"stands\": true,\n"
            "  \"duration_s\": 60.0,\n"
            "  \"can_bus_load\": 0.512,\n"
            "  \"state_hash\": \"00000000deadbeef\",\n"
            "  \"faults\": 0,\n"
            "  \"solver_warnings\": 2,\n"
            "  \"stepper\": \"world\",\n"
            "  \"base_height_error_max_m\": 0.0015,\n"
            "  \"foot_slip_max_m\": 0.00025,\n"
            "  \"lost_abilities\": [],\n"
            "  \"events\": [\n"
            "    {\n"
            "      \"t_s\": 2.0006,\n"
            "      \"kind\": \"command\",\n"
            "      \"text\": \"Command enable: obeyed.\",\n"
            "      \"fields\": {\n"
            "        \"command\": \"enable\"\n"
            "      }\n"
            "    }\n"
            "  ]\n"
            "}\n");
}

TEST(Summary, HasWalkKeysOnlyAfterAWalk) {
  EXPECT_FALSE(to_json(kSummary).contains("distance_m"));
  RunSummary walked = kSummary;
  walked.events.clear();
  walked.walk = {.distance_m = 3.0,
                 .speed_m_per_s = 0.2,
                 .lateral_drift_m = -0.1,
                 .heading_drift_rad = 0.05,
                 .energy_J = 40.0,
                 .zmp_rms_error_m = 0.02,
                 .zmp_lag_s = -0.025,
                 .zmp_margin_p05_m = std::numeric_limits<double>::quiet_NaN(),
                 .zmp_sensor_vs_truth_rms_m = 0.0008,
                 .roll_rms_rad = 0.03,
                 .foot_lift_m = 0.006};
  const std::string text = to_json(walked).dump();
  EXPECT_TRUE(text.ends_with(
      "\"foot_slip_max_m\":0.00025,\"lost_abilities\":[],\"distance_m\":3.0,\"speed_m_per_s\":0.2,"
      "\"lateral_drift_m\":-0.1,\"heading_drift_rad\":0.05,\"energy_J\":40.0,\"zmp_rms_error_"
      "m\":0.02,\"zmp_lag_s\":-0.025,"
      "\"zmp_margin_p05_m\":null,\"zmp_sensor_vs_truth_rms_m\":0.0008,\"roll_rms_rad\":0.03,"
      "\"foot_lift_m\":0.006,\"events\":[]}"))
      << text;
}

TEST(Summary, ReplacesTheFileAtomically) {
  test::TemporaryFolder folder;
  test::write_file(folder.path / "timing.json", std::string(10'000, 'x'));
  write_json(folder.path / "timing.json", {{"real_time_factor", 6.5}});
  EXPECT_EQ(test::read_file(folder.path / "timing.json"), "{\n  \"real_time_factor\": 6.5\n}\n");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path), {}), 1);
}

TEST(Summary, IsWrittenWhateverBytesANameHas) {
  test::TemporaryFolder folder;
  write_json(folder.path / "summary.json", {{"robot",
                                             "k\xF6"
                                             "boshi"}});
  EXPECT_EQ(test::read_file(folder.path / "summary.json"),
            "{\n  \"robot\": \"k\uFFFD"
            "boshi\"\n}\n");
}

TEST(Summary, KeepsTheOldFileWhenWritingFails) {
  test::TemporaryFolder folder;
  test::write_file(folder.path / "summary.json", "old");
  // A limit of the file's size stands for a full disk.
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const rlimit limit{.rlim_cur = 10, .rlim_max = before.rlim_max};
  setrlimit(RLIMIT_FSIZE, &limit);
  EXPECT_THROW(write_json(folder.path / "summary.json", to_json(kSummary)), std::system_error);
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  EXPECT_EQ(test::read_file(folder.path / "summary.json"), "old");
  EXPECT_FALSE(std::filesystem::exists(folder.path / "summary.json.part"));
}

}  // namespace
}  // namespace koboshi::simulation
