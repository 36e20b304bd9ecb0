#include "tools/import/read/mjcf_reader.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include "base/text/error.h"
#include "base/text/text.h"
#include "tools/import/mesh/limited_child.h"
#include "tools/import/read/mjcf_subset.h"
#include "tools/import/read/xml_values.h"

namespace koboshi::tools {
namespace {

using Model = std::unique_ptr<mjModel, decltype(&mj_deleteModel)>;

constexpr ChildLimits kLimits{.processor_s = 4, .memory_bytes = std::size_t{2} << 30};

// MuJoCo would write warnings to a file in the working folder.
void ignore_warning(const char*) {}

// A virtual file beside the source, so that meshes are found from there. A mjVFS contains thousands of names:
// too large for the stack.
class VirtualFile {
 public:
  VirtualFile(const std::filesystem::path& beside, const std::string& text)
      : path_(beside.parent_path() / kName) {
    mj_defaultVFS(vfs_.get());
    mj_makeEmptyFileVFS(vfs_.get(), kName, static_cast<int>(text.size()));
    std::ranges::copy(text, static_cast<char*>(vfs_->filedata[mj_findFileVFS(vfs_.get(), kName)]));
  }
  ~VirtualFile() { mj_deleteVFS(vfs_.get()); }
  VirtualFile(const VirtualFile&) = delete;
  VirtualFile& operator=(const VirtualFile&) = delete;

  const mjVFS* vfs() const { return vfs_.get(); }
  const char* path() const { return path_.c_str(); }

 private:
  static constexpr const char* kName = "koboshi_mjcf_subset.xml";

  std::filesystem::path path_;
  std::unique_ptr<mjVFS> vfs_ = std::make_unique<mjVFS>();
};

Model load(const std::filesystem::path& file, const std::string& text, std::string& fault) {
  std::array<char, 1000> message{};
  const VirtualFile source(file, text);
  auto* const handler = mju_user_warning;
  mju_user_warning = ignore_warning;
  Model model(mj_loadXML(source.path(), source.vfs(), message.data(), static_cast<int>(message.size())),
              mj_deleteModel);
  mju_user_warning = handler;
  if (!model) {
    fault = message.data();  // whole: the name of the body comes last
    std::ranges::replace(fault, '\n', ' ');
    fault = utf8_line(trimmed_name(fault));
  }
  return model;
}

// The place of the line's number in a message of MuJoCo, which ends with "line 7" or "line = 7, column = -1";
// empty without one.
struct LineNumber {
  std::size_t begin = 0;
  std::size_t size = 0;
};
LineNumber line_in(const std::string& message) {
  const std::size_t at = message.rfind("line ");
  if (at == std::string::npos) return {};
  const std::size_t begin = std::min(message.find_first_not_of(" =", at + 5), message.size());
  const std::size_t end = std::min(message.find_first_not_of("0123456789", begin), message.size());
  return {begin, end - begin};
}

Model load_or_refuse(const std::filesystem::path& file, const MjcfSubset& subset) {
  const ChildResult trial = run_in_child(kLimits, [&] {
    std::string fault;
    const Model model = load(file, subset.text, fault);
    return fault;
  });
  if (!trial.fault.empty())
    throw InputError(file, 0, "a model on which MuJoCo " + trial.fault, "one that MuJoCo can load");
  const std::string expected = fmt::format("a model that MuJoCo {} can load", mj_versionString());
  if (!trial.output.empty()) {
    // The line of the subset is none of the source's.
    std::string message = trial.output;
    const LineNumber number = line_in(message);
    const auto line =
        static_cast<std::size_t>(parse_integer(message.substr(number.begin, number.size)).value_or(0));
    const int source_line = line < subset.lines.size() ? subset.lines[line] : 0;
    if (number.size > 0) message.replace(number.begin, number.size, std::to_string(source_line));
    throw InputError(file, source_line, message, expected);
  }
  std::string fault;
  Model model = load(file, subset.text, fault);
  if (!model) throw InputError(file, 0, fault, expected);
  return model;
}

template <typename Number>
Eigen::Vector3d vector_at(const Number* values, int index) {
  const Number* const v = values + 3 * index;
  return {static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])};
}

Eigen::Isometry3d pose_at(const mjtNum* positions, const mjtNum* quaternions, int index) {
  const mjtNum* const q = quaternions + 4 * index;
  return Eigen::Translation3d(vector_at(positions, index)) *
         Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized();
}

class MjcfReader {
 public:
  MjcfReader(const std::filesystem::path& file, const mjModel& model, const MjcfSubset& subset,
             ImportReport& report)
      : model_(model), subset_(subset), report_(report) {
    robot_.file = file;
    robot_.name = model.names;  // the model's own name comes first
    if (!name_fault(robot_.name).empty()) robot_.name = file.stem().string();
  }

  ImportedRobot read() {
    find_kept_bodies();
    last_link_.assign(static_cast<std::size_t>(model_.nbody), -1);
    X_LB_.assign(static_cast<std::size_t>(model_.nbody), Eigen::Isometry3d::Identity());
    for (int body = 1; body < model_.nbody; ++body)
      if (kept_[static_cast<std::size_t>(body)]) read_body(body);
    if (robot_.links.size() > kMaxImportedLinks)
      throw InputError(robot_.file, 0, std::to_string(robot_.links.size()) + " links",
                       "at most " + std::to_string(kMaxImportedLinks));
    read_actuators();
    read_couplings();
    read_loops();
    return std::move(robot_);
  }

 private:
  std::string name_of(const int* addresses, int index, const char* kind) const {
    const std::string name = model_.names + addresses[index];
    return name_fault(name).empty() ? name : fmt::format("{}_{}", kind, index);
  }

  // Bodies of the tree with the most hinges; the others are floors, balls and tables.
  void find_kept_bodies() {
    std::vector<int> root(static_cast<std::size_t>(model_.nbody), 0);
    std::vector<int> hinges(static_cast<std::size_t>(model_.nbody), 0);
    for (int body = 1; body < model_.nbody; ++body) {
      const int parent = model_.body_parentid[body];
      root[static_cast<std::size_t>(body)] = parent == 0 ? body : root[static_cast<std::size_t>(parent)];
      hinges[static_cast<std::size_t>(root[static_cast<std::size_t>(body)])] += model_.body_jntnum[body];
    }
    const int best = static_cast<int>(std::ranges::max_element(hinges) - hinges.begin());
    for (const int body_root : root) kept_.push_back(body_root == best && body_root != 0);
    if (best == 0) throw InputError(robot_.file, 0, "a model without joints", "a robot");
    std::string others;
    for (int body = 1; body < model_.nbody; ++body)
      if (model_.body_parentid[body] == 0 && body != best)
        others += (others.empty() ? "" : ", ") + one_line(name_of(model_.name_bodyadr, body, "body"));
    if (!others.empty())
      report_.warnings.push_back(fmt::format("left out beside the robot {}: {}, with all that they carry",
                                             one_line(name_of(model_.name_bodyadr, best, "body")), others));
  }

  // One link for the body, and one without mass in front of it for each further joint. A link's frame is at
  // its joint, parallel to the body's.
  void read_body(int body) {
    const int parent_body = model_.body_parentid[body];
    const auto index = static_cast<std::size_t>(body);
    const std::string body_name = name_of(model_.name_bodyadr, body, "body");
    std::vector<int> joints;
    for (int i = 0; i < model_.body_jntnum[body]; ++i)
      if (model_.jnt_type[model_.body_jntadr[body] + i] != mjJNT_FREE)
        joints.push_back(model_.body_jntadr[body] + i);
    const bool is_root = parent_body == 0;
    if (is_root) {
      last_link_[index] = add_link(body_name + (joints.empty() ? "" : "_base"));
      if (joints.empty()) return fill_link(body);
    }
    int parent = is_root ? last_link_[index] : last_link_[static_cast<std::size_t>(parent_body)];
    // The body's frame in the parent link's.
    const Eigen::Isometry3d X_PB = is_root ? Eigen::Isometry3d::Identity()
                                           : X_LB_[static_cast<std::size_t>(parent_body)] *
                                                 pose_at(model_.body_pos, model_.body_quat, body);
    if (joints.empty()) {
      last_link_[index] = add_link(body_name);
      add_joint({.name = body_name + "_fixed",
                 .kind = JointKind::kFixed,
                 .kind_name = "fixed",
                 .parent = parent,
                 .X_PL = X_PB});
      return fill_link(body);
    }
    Eigen::Isometry3d X_before = X_PB;  // of the body's frame in the link before
    for (std::size_t i = 0; i < joints.size(); ++i) {
      const Eigen::Vector3d p_BJ = vector_at(model_.jnt_pos, joints[i]);
      const bool is_last = i + 1 == joints.size();
      last_link_[index] = add_link(is_last ? body_name : fmt::format("{}_{}", body_name, i + 1));
      ImportedJoint joint = hinge(joints[i]);
      joint.parent = parent;
      joint.X_PL = X_before * Eigen::Translation3d(p_BJ);
      add_joint(std::move(joint));
      X_before = Eigen::Translation3d(-p_BJ);
      parent = last_link_[index];
    }
    X_LB_[index] = X_before;
    fill_link(body);
  }

  static int line_of(const std::map<std::string, int>& lines, const std::string& name) {
    const auto found = lines.find(name);
    return found == lines.end() ? 0 : found->second;
  }

  int add_link(std::string name) {
    const int line = line_of(subset_.body_lines, name);
    robot_.links.push_back({.name = std::move(name), .line = line});
    return static_cast<int>(robot_.links.size()) - 1;
  }
  void add_joint(ImportedJoint joint) {
    joint.child = static_cast<int>(robot_.links.size()) - 1;
    robot_.joints.push_back(std::move(joint));
  }

  ImportedJoint hinge(int index) const {
    ImportedJoint joint{.name = name_of(model_.name_jntadr, index, "joint")};
    joint.line = line_of(subset_.joint_lines, joint.name);
    const int type = model_.jnt_type[index];
    joint.kind_name = type == mjJNT_HINGE ? "hinge" : type == mjJNT_SLIDE ? "slide" : "ball";
    joint.kind = type != mjJNT_HINGE              ? JointKind::kOther
                 : model_.jnt_limited[index] != 0 ? JointKind::kHinge
                                                  : JointKind::kContinuous;
    joint.axis_L = vector_at(model_.jnt_axis, index).normalized();
    if (joint.kind == JointKind::kHinge) {
      // The model's own pose is that of joint angle `ref`, which qpos0 holds.
      const double zero_rad = model_.qpos0[model_.jnt_qposadr[index]];
      joint.lower_rad = model_.jnt_range[2 * index] - zero_rad;
      joint.upper_rad = model_.jnt_range[2 * index + 1] - zero_rad;
    }
    if (type == mjJNT_HINGE) {
      const int dof = model_.jnt_dofadr[index];
      joint.rotor_inertia_kg_m2 = model_.dof_armature[dof];
      joint.coulomb_friction_Nm = model_.dof_frictionloss[dof];
      if (model_.nuser_jnt > 1)
        joint.effort_Nm = std::max(0.0, model_.jnt_user[index * model_.nuser_jnt + 1]);
    }
    return joint;
  }

  void fill_link(int body) {
    ImportedLink& link = robot_.links[static_cast<std::size_t>(last_link_[static_cast<std::size_t>(body)])];
    const Eigen::Isometry3d& X_LB = X_LB_[static_cast<std::size_t>(body)];
    const Eigen::Isometry3d X_LC = X_LB * pose_at(model_.body_ipos, model_.body_iquat, body);
    link.mass_kg = model_.body_mass[body];
    link.p_LCom_L = X_LC.translation();
    link.I_LCom_L =
        X_LC.linear() * vector_at(model_.body_inertia, body).asDiagonal() * X_LC.linear().transpose();
    for (int site = 0; site < model_.nsite; ++site) {
      const std::string name = model_.names + model_.name_siteadr[site];
      if (model_.site_bodyid[site] == body && is_of_imu(name))
        link.frames.push_back({name, X_LB * pose_at(model_.site_pos, model_.site_quat, site)});
    }
    for (int i = 0; i < model_.body_geomnum[body]; ++i) {
      const int geom = model_.body_geomadr[body] + i;
      std::optional<ImportedShape> shape = shape_of(geom);
      if (!shape) continue;
      shape->X_LG = X_LB * pose_at(model_.geom_pos, model_.geom_quat, geom);
      const bool makes_contacts = model_.geom_contype[geom] != 0 || model_.geom_conaffinity[geom] != 0;
      constexpr int kFirstHiddenGroup = 3;  // viewers show the groups 0 to 2
      const bool is_shown = model_.geom_group[geom] < kFirstHiddenGroup;
      // Models that list the pairs that may touch switch off all others; what is not shown is there to touch.
      if (makes_contacts || !is_shown) link.collisions.push_back(*shape);
      if (is_shown) link.visuals.push_back(std::move(*shape));
    }
  }

  static bool is_of_imu(std::string name) {
    std::ranges::transform(name, name.begin(), [](unsigned char c) { return std::tolower(c); });
    return name_fault(name).empty() && name.find("imu") != std::string::npos;
  }

  std::optional<ImportedShape> shape_of(int geom) const {
    ImportedShape shape;
    const Eigen::Vector3d size_m = vector_at(model_.geom_size, geom);
    switch (model_.geom_type[geom]) {
      case mjGEOM_SPHERE:
        shape.kind = ShapeKind::kSphere;
        shape.size_m = Eigen::Vector3d::Constant(size_m.x());
        break;
      case mjGEOM_CAPSULE:
      case mjGEOM_CYLINDER:
        shape.kind = model_.geom_type[geom] == mjGEOM_CAPSULE ? ShapeKind::kCapsule : ShapeKind::kCylinder;
        shape.size_m = {size_m.x(), size_m.x(), 2.0 * size_m.y()};
        break;
      case mjGEOM_ELLIPSOID:  // as the box around it
      case mjGEOM_BOX:
        shape.size_m = 2.0 * size_m;
        break;
      case mjGEOM_MESH:
        shape.kind = ShapeKind::kMesh;
        shape.surface = surface_of(model_.geom_dataid[geom]);
        break;
      default:
        return std::nullopt;  // planes and height fields are ground
    }
    const int material = model_.geom_matid[geom];
    const float* const rgba = material < 0 ? model_.geom_rgba + 4 * geom : model_.mat_rgba + 4 * material;
    shape.colour = std::array{std::clamp(rgba[0], 0.0F, 1.0F), std::clamp(rgba[1], 0.0F, 1.0F),
                              std::clamp(rgba[2], 0.0F, 1.0F)};
    return shape;
  }

  std::shared_ptr<const view::Mesh> surface_of(int mesh) const {
    auto surface = std::make_shared<view::Mesh>();
    for (int i = 0; i < model_.mesh_vertnum[mesh]; ++i)
      surface->vertices_m.push_back(vector_at(model_.mesh_vert, model_.mesh_vertadr[mesh] + i).cast<float>());
    for (int i = 0; i < model_.mesh_facenum[mesh]; ++i) {
      const int* const face = model_.mesh_face + 3 * (model_.mesh_faceadr[mesh] + i);
      surface->triangles.push_back({static_cast<std::uint32_t>(face[0]), static_cast<std::uint32_t>(face[1]),
                                    static_cast<std::uint32_t>(face[2])});
    }
    return surface;
  }

  void read_actuators() {
    for (int i = 0; i < model_.nu; ++i) {
      if (model_.actuator_trntype[i] != mjTRN_JOINT) continue;
      const auto index =
          robot_.find_joint(name_of(model_.name_jntadr, model_.actuator_trnid[2 * i], "joint"));
      if (!index) continue;
      ImportedJoint& joint = robot_.joints[static_cast<std::size_t>(*index)];
      joint.has_actuator = true;
      limit_effort(joint, actuator_force(i));
    }
  }

  // The most that an actuator gives, in N m at the joint; 0 if the model does not limit it.
  double actuator_force(int i) const {
    const double gear = std::abs(model_.actuator_gear[6 * i]);
    if (model_.actuator_forcelimited[i] != 0) return gear * model_.actuator_forcerange[2 * i + 1];
    const bool is_motor =
        model_.actuator_gaintype[i] == mjGAIN_FIXED && model_.actuator_biastype[i] == mjBIAS_NONE;
    if (!is_motor || model_.actuator_ctrllimited[i] == 0) return 0.0;
    return gear * std::abs(model_.actuator_gainprm[mjNGAIN * i]) * model_.actuator_ctrlrange[2 * i + 1];
  }

  // The joint's own limit and the actuator's both hold.
  static void limit_effort(ImportedJoint& joint, double force_Nm) {
    if (force_Nm <= 0.0) return;
    joint.effort_Nm = joint.effort_Nm > 0.0 ? std::min(joint.effort_Nm, force_Nm) : force_Nm;
  }

  void read_couplings() {
    for (const MjcfCoupling& coupling : subset_.couplings) {
      const auto index = robot_.find_joint(coupling.joint);
      if (!index || !robot_.find_joint(coupling.of)) continue;
      ImportedJoint& joint = robot_.joints[static_cast<std::size_t>(*index)];
      joint.mimics = coupling.of;
      joint.mimic_ratio = coupling.ratio;
      joint.mimic_offset_rad = coupling.offset_rad;
    }
  }

  void read_loops() {
    for (const MjcfLoop& loop : subset_.loops) {
      const auto one = link_of(loop.one);
      const auto other = link_of(loop.other);
      if (one && other) robot_.loops.push_back({*one, *other});
    }
    if (subset_.tendons > 0)
      report_.warnings.push_back(fmt::format("{} left out", count_text(subset_.tendons, "tendon")));
  }
  std::optional<int> link_of(const std::string& body_name) const {
    const int body = mj_name2id(&model_, mjOBJ_BODY, body_name.c_str());
    if (body < 0 || last_link_[static_cast<std::size_t>(body)] < 0) return std::nullopt;
    return last_link_[static_cast<std::size_t>(body)];
  }

  const mjModel& model_;
  const MjcfSubset& subset_;
  ImportReport& report_;
  ImportedRobot robot_;
  std::vector<bool> kept_;               // by body
  std::vector<int> last_link_;           // by body: the link that has its mass
  std::vector<Eigen::Isometry3d> X_LB_;  // by body: its frame in that link's
};

}  // namespace

ImportedRobot read_mjcf(const std::filesystem::path& file, const std::string& text, ImportReport& report) {
  const MjcfSubset subset = mjcf_subset(file, text, report);
  const Model model = load_or_refuse(file, subset);
  return MjcfReader(file, *model, subset, report).read();
}

}  // namespace koboshi::tools
