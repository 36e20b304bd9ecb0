#include "base/text/error.h"
#include "tools/policy/onnx_reader.h"

namespace koboshi::tools {

bool reads_onnx() { return false; }

Mlp read_onnx(const std::filesystem::path& file, const std::string&) {
  throw InputError(file, 0, "an ONNX file, and this build of koboshi cannot read ONNX",
                   "a build with libonnx-dev and libprotobuf-dev installed");
}

}  // namespace koboshi::tools
