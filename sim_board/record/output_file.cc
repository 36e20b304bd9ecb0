#include "sim_board/record/output_file.h"

#include <cerrno>
#include <system_error>

namespace koboshi::sim {

OutputFile::OutputFile(const std::filesystem::path& file)
    : file_(file), stream_(std::fopen(file.c_str(), "wb")) {
  if (stream_ == nullptr) fail();
}

void OutputFile::write(std::string_view bytes) {
  if (std::fwrite(bytes.data(), 1, bytes.size(), stream_.get()) != bytes.size()) fail();
}

void OutputFile::close() {
  if (std::fclose(stream_.release()) != 0) fail();
}

void OutputFile::fail() const {
  throw std::system_error(errno, std::generic_category(), "cannot write " + file_.string());
}

}  // namespace koboshi::sim
