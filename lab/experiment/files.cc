#include "lab/experiment/files.h"

#include <fstream>
#include <iterator>

#include "base/file/output_file.h"
#include "base/text/error.h"
#include "base/text/text.h"
#include "simulation/record/state_hash.h"

namespace koboshi::lab {
namespace {

namespace fs = std::filesystem;

std::string bytes_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw InputError(file, 0, "nothing that can be read", "a file");
  return {std::istreambuf_iterator<char>(stream), {}};
}

// The running program does not change, and a search hashes its inputs for each of its candidates.
const std::string& hash_of_this_program() {
  static const std::string kHash = [] {
    simulation::StateHash hash;
    const std::string bytes = bytes_of("/proc/self/exe");
    hash.add(std::as_bytes(std::span(bytes)));
    return hash.hex();
  }();
  return kHash;
}

}  // namespace

std::string hash_inputs(std::span<const fs::path> files, std::span<const std::string> texts) {
  simulation::StateHash hash;
  const auto add = [&](const std::string& text) {
    hash.add(std::uint64_t{text.size()});
    hash.add(std::as_bytes(std::span(text)));
  };
  for (const fs::path& file : files) add(bytes_of(file));
  for (const std::string& text : texts) add(text);
  add(hash_of_this_program());
  return hash.hex();
}

void write_section(const fs::path& page, const std::string& title, const std::string& name,
                   const std::string& text) {
  const std::string begin = "<!-- generated: " + name + " -->\n";
  const std::string end = "<!-- end of " + name + " -->\n";
  std::string content = fs::exists(page) ? bytes_of(page) : "# " + title + "\n";
  const std::size_t from = content.find(begin);
  const std::size_t to = content.find(end);
  const std::string section = begin + text + end;
  if (from == std::string::npos && to == std::string::npos) {
    content += "\n" + section;
  } else if (from < to && to != std::string::npos) {
    content.replace(from, to + end.size() - from, section);
  } else {
    throw InputError(page, 0, "one comment of the two about the section " + name, "both, in their order");
  }
  write_whole_file(page, content);
}

}  // namespace koboshi::lab
