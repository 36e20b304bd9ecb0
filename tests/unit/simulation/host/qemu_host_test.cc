#include "simulation/host/qemu_host.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "simulation/assembly/simulation.h"
#include "simulation/scenario/reader.h"
#include "tests/support/temporary_folder.h"

namespace koboshi::simulation {
namespace {

namespace fs = std::filesystem;
using testing::StrEq;
using testing::ThrowsMessage;

// A program on the PATH by the name of QEMU that answers each message with the message itself, as the image
// acknowledges its programming and its start. tests/target has the real one.
class EchoingQemu {
 public:
  EchoingQemu() {
    const fs::path program = folder_.path / "qemu-system-arm";
    std::ofstream(program) << "#!/bin/sh\nexec cat <&3 >&4\n";
    fs::permissions(program, fs::perms::owner_all);
    std::ofstream(image()) << "no image";
    setenv("PATH", (folder_.path.string() + ":" + path_).c_str(), 1);
  }
  ~EchoingQemu() { setenv("PATH", path_.c_str(), 1); }
  fs::path image() const { return folder_.path / "koboshi.elf"; }

 private:
  test::TemporaryFolder folder_;
  const std::string path_ = std::getenv("PATH");
};

TEST(QemuHost, RejectsASnapshotWithOneLine) {
  const EchoingQemu qemu;
  Simulation simulation(read_scenario(KOBOSHI_SOURCE_DIR "/scenarios/squat.yaml"), in_qemu(qemu.image()));
  EXPECT_THAT([&] { static_cast<void>(simulation.snapshot()); },
              ThrowsMessage<sim_board::NotSaveable>(
                  StrEq("firmware inside QEMU has no snapshots: use --controller in-process")));
}

}  // namespace
}  // namespace koboshi::simulation
