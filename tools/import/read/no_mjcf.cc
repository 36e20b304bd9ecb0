#include "base/text/error.h"
#include "tools/import/read/mjcf_reader.h"

namespace koboshi::tools {

ImportedRobot read_mjcf(const std::filesystem::path& file, const std::string&, ImportReport&) {
  throw InputError(file, 0, "a MuJoCo model in a build without MuJoCo",
                   "a build with it: on Debian, apt-get install libmujoco-dev");
}

}  // namespace koboshi::tools
