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

void OutputFile::flush() {
  if (std::fflush(stream_.get()) != 0) fail();
}

void OutputFile::close() {
  if (std::fclose(stream_.release()) != 0) fail();
}

void OutputFile::fail() const {
  throw std::system_error(errno, std::generic_category(), "cannot write " + file_.string());
}

void write_whole_file(const std::filesystem::path& file, std::string_view text) {
  std::filesystem::path beside = file;
  beside += ".part";
  try {
    OutputFile output(beside);
    output.write(text);
    output.close();
    std::filesystem::rename(beside, file);
  } catch (...) {
    std::error_code ignored;
    std::filesystem::remove(beside, ignored);
    throw;
  }
}

}  // namespace koboshi::sim
