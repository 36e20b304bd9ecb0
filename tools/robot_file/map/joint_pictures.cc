#include "tools/robot_file/map/joint_pictures.h"

#include <Eigen/Geometry>
#include <utility>
#include <variant>

#include "base/text/user_units.h"
#include "view/capture/scene.h"
#include "view/film/film.h"
#include "view/render/camera.h"
#include "view/render/camera_path.h"

namespace koboshi::tools {
namespace {

constexpr double kTurn_rad = 20.0 / kDegreesPerRad;
constexpr view::Colour kMoved{1.0F, 0.5F, 0.1F};
constexpr int kSize_px = 480;

// Whether a link hangs on a joint, directly or through others.
std::vector<bool> moved_links(const sim_board::RobotDescription& robot, std::size_t joint) {
  std::vector<bool> moved(robot.links.size(), false);
  moved[static_cast<std::size_t>(robot.joints[joint].child)] = true;
  for (const sim_board::FollowerDescription& follower : robot.followers)
    if (follower.leader == static_cast<int>(joint))
      moved[static_cast<std::size_t>(follower.hinge.child)] = true;
  for (std::size_t round = 0; round < robot.hinge_count(); ++round) {
    for (std::size_t i = 0; i < robot.hinge_count(); ++i)
      if (moved[static_cast<std::size_t>(robot.hinge(i).parent)])
        moved[static_cast<std::size_t>(robot.hinge(i).child)] = true;
  }
  return moved;
}

view::Scene scene_of(const sim_board::RobotDescription& robot) {
  return view::make_scene(robot,
                          {.present = false, .surface = {}, .patches = {}, .boxes = {}, .height_fields = {}});
}

// The box around what is seen of the robot in its only sample, in the world.
Eigen::AlignedBox3d bounds_m(const view::Recording& recording) {
  Eigen::AlignedBox3d bounds;
  const view::Sample& sample = recording.samples.front();
  for (std::size_t i = 0; i < recording.scene.links.size(); ++i) {
    const view::Pose& pose = sample.links[i];
    const Eigen::Isometry3d X_WL =
        Eigen::Translation3d(pose.p_WL_m.cast<double>()) * pose.q_WL.cast<double>();
    bounds.extend(X_WL.translation());
    for (const view::Shape& shape : recording.scene.links[i].visuals) {
      const Eigen::Isometry3d X_WG = X_WL * shape.X_LG;
      if (const auto* const mesh = std::get_if<view::Mesh>(&shape.geometry)) {
        for (const Eigen::Vector3f& vertex : mesh->vertices_m) bounds.extend(X_WG * vertex.cast<double>());
      } else {
        bounds.extend(X_WG.translation());
      }
    }
  }
  return bounds;
}

// Shows the whole robot, whose head may be far above its last joint.
view::CameraChoice camera_for(const view::Recording& recording) {
  view::CameraChoice choice{.motion = view::CameraMotion::kFixed};
  const Eigen::AlignedBox3d bounds = bounds_m(recording);
  const view::Camera camera{.azimuth_rad = choice.azimuth_rad, .elevation_rad = choice.elevation_rad};
  constexpr double kAir = 1.05;
  choice.target_W_m = bounds.center();
  choice.distance_m = view::distance_to_fit(camera, 1.0, kAir * 0.5 * bounds.diagonal().norm());
  return choice;
}

void draw(const view::Recording& recording, RobotShapes shapes, const std::filesystem::path& file) {
  const view::FilmOptions options{.out = file,
                                  .width_px = kSize_px,
                                  .height_px = kSize_px,
                                  .at_s = {0.0},
                                  .camera = camera_for(recording),
                                  .collisions = shapes == RobotShapes::kCollisions};
  view::render(recording, options, [](int, int) {});
}

view::Recording turned(const sim_board::RobotDescription& robot, const view::Scene& scene,
                       std::size_t joint) {
  const sim_board::JointDescription& described = robot.joints[joint];
  const double angle_rad = described.upper_rad >= kTurn_rad ? kTurn_rad : -kTurn_rad;
  const Eigen::Isometry3d turn = Eigen::Translation3d(described.p_MJ) *
                                 Eigen::AngleAxisd(angle_rad, described.axis_M) *
                                 Eigen::Translation3d(-described.p_MJ);
  view::Recording recording{.title = robot.name};
  recording.scene = scene;
  view::Sample sample;
  const std::vector<bool> moved = moved_links(robot, joint);
  for (std::size_t link = 0; link < robot.links.size(); ++link) {
    const Eigen::Isometry3d X_ML = moved[link] ? turn * robot.links[link].X_ML : robot.links[link].X_ML;
    sample.links.push_back({.p_WL_m = X_ML.translation().cast<float>(),
                            .q_WL = Eigen::Quaterniond(X_ML.linear()).cast<float>()});
    if (!moved[link]) continue;
    for (view::Shape& shape : recording.scene.links[link].visuals) shape.colour = kMoved;
  }
  recording.samples.push_back(std::move(sample));
  return recording;
}

}  // namespace

std::vector<std::filesystem::path> draw_joint_pictures(const sim_board::RobotDescription& robot,
                                                       const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  const view::Scene scene = scene_of(robot);
  std::vector<std::filesystem::path> files;
  for (std::size_t joint = 0; joint < robot.joints.size(); ++joint) {
    files.push_back(folder / (robot.joints[joint].name + ".png"));
    draw(turned(robot, scene, joint), RobotShapes::kVisuals, files.back());
  }
  return files;
}

void draw_robot(const sim_board::RobotDescription& robot, RobotShapes shapes,
                const std::filesystem::path& file) {
  view::Recording recording{.title = robot.name};
  recording.scene = scene_of(robot);
  view::Sample sample;
  for (const sim_board::LinkDescription& link : robot.links)
    sample.links.push_back({.p_WL_m = link.X_ML.translation().cast<float>(),
                            .q_WL = Eigen::Quaterniond(link.X_ML.linear()).cast<float>()});
  recording.samples.push_back(std::move(sample));
  draw(recording, shapes, file);
}

}  // namespace koboshi::tools
