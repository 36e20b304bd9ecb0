#include "sim_board/engine/mujoco/library.h"

#include <algorithm>
#include <array>
#include <mutex>

namespace koboshi::sim_board {
namespace {

// Throws through MuJoCo's C functions. They own nothing but their arena, which is discarded with the world,
// and Debian's amd64 and arm64 libraries contain unwind tables.
void throw_error(const char* message) { throw MujocoError(message); }

void drop_warning(const char*) {}

// A mjVFS contains thousands of names: too large for the stack.
class VirtualFile {
 public:
  static constexpr const char* kName = "world.xml";

  explicit VirtualFile(const std::string& text) {
    mj_defaultVFS(vfs_.get());
    mj_makeEmptyFileVFS(vfs_.get(), kName, static_cast<int>(text.size()));
    std::ranges::copy(text, static_cast<char*>(vfs_->filedata[mj_findFileVFS(vfs_.get(), kName)]));
  }
  ~VirtualFile() { mj_deleteVFS(vfs_.get()); }
  VirtualFile(const VirtualFile&) = delete;
  VirtualFile& operator=(const VirtualFile&) = delete;

  const mjVFS* get() const { return vfs_.get(); }

 private:
  std::unique_ptr<mjVFS> vfs_ = std::make_unique<mjVFS>();
};

}  // namespace

void start_mujoco() {
  static const bool started = [] {
    mju_user_error = throw_error;
    mju_user_warning = drop_warning;
    return true;
  }();
  static_cast<void>(started);
}

MujocoModel load_model(const std::string& mjcf) {
  // MuJoCo's reader stores the last model in a global variable.
  static std::mutex reader;
  const std::lock_guard lock(reader);
  const VirtualFile file(mjcf);
  std::array<char, 1000> message{};
  MujocoModel model(mj_loadXML(VirtualFile::kName, file.get(), message.data(), message.size()));
  if (!model) throw MujocoError(message.data());
  return model;
}

MujocoData make_data(const mjModel& model) {
  MujocoData data(mj_makeData(&model));
  if (!data) throw MujocoError("no memory for a world");
  return data;
}

}  // namespace koboshi::sim_board
