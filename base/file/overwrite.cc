#include "base/file/overwrite.h"

#include <system_error>

#include "base/text/error.h"

namespace koboshi {

void refuse_to_overwrite(std::initializer_list<std::filesystem::path> inputs,
                         const std::filesystem::path& output) {
  for (const std::filesystem::path& input : inputs) {
    std::error_code missing;
    if (!input.empty() && !output.empty() && std::filesystem::equivalent(input, output, missing))
      throw InputError(output, 0, "the input as the output", "another file for the result");
  }
}

}  // namespace koboshi
