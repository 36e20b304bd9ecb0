// An external program that records the run of a scenario with the robot's firmware:
//
//   own_recorder SCENARIO SECONDS FOLDER
//
// leaves trace.csv, can.log and summary.json, byte for byte as `koboshi run` does, in an existing folder.

#include <filesystem>
#include <vector>

#include "simulation/assembly/simulation.h"
#include "simulation/host/in_process_host.h"
#include "simulation/observe/run_recorder.h"
#include "simulation/record/recorder.h"
#include "simulation/scenario/reader.h"

int main(int count, char** arguments) {
  if (count != 4) return 2;
  using namespace koboshi::simulation;
  const std::vector<koboshi::Override> duration{{"duration_s", arguments[2]}};
  const std::filesystem::path folder = arguments[3];
  Simulation simulation(read_scenario(arguments[1], duration), in_process());
  Recorder files(folder, RunRecorder::columns(simulation.robot()), WhenFull::kWait);
  RunRecorder recorder(simulation, &files);
  while (!simulation.finished()) {
    simulation.advance();
    recorder.record();
  }
  files.close();
  write_json(folder / "summary.json", to_json(recorder.summary()));
  return 0;
}
