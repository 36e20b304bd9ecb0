#include "view/render/shadows.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "view/render/camera.h"
#include "view/render/shaders.h"

namespace koboshi::view {
namespace {

constexpr GLsizei kDepth_px = 1024;
constexpr GLsizei kProximity_px = 256;
constexpr double kLightRange_m = 4.0;  // of ground and steps that cast shadows onto the robot
constexpr double kHighest_m =
    5.0 * static_cast<double>(kProximity_m);  // links above it darken the ground by less than 1 in 255

bool same(const Pose& a, const Pose& b) { return a.p_WL_m == b.p_WL_m && a.q_WL.coeffs() == b.q_WL.coeffs(); }

}  // namespace

Eigen::Vector3d to_light_W() { return Eigen::Vector3d(0.62, 0.25, 1.0).normalized(); }

Shadows::Shadows()
    : depth_("depth", depth_shader()),
      proximity_("proximity", proximity_shader()),
      depth_target_(make_depth_target(kDepth_px)),
      proximity_target_(make_height_target(kProximity_px)) {}

void Shadows::update(const Shapes& shapes, const Picture& picture) {
  if (picture.collisions == drawn_collisions_ && std::ranges::equal(picture.links, drawn_links_, same) &&
      texel_m_ > 0.0F)
    return;
  const RobotBounds robot = shapes.bounds(picture.links);
  place(robot);
  draw_depth(shapes, picture);
  draw_proximity(shapes, picture, robot);
  drawn_links_ = picture.links;
  drawn_collisions_ = picture.collisions;
}

// The map covers the robot's sphere and moves by whole texels, so that the shadow's edges rest.
void Shadows::place(const RobotBounds& robot) {
  const double texel_m = 2.0 * robot.radius_m / kDepth_px;
  const Eigen::Matrix4d turn =
      look_along(Eigen::Vector3d::Zero(), -to_light_W(), Eigen::Vector3d::UnitX()).cast<double>();
  Eigen::Vector3d centre_m = (turn * robot.centre_W_m.homogeneous()).head<3>();
  centre_m = (centre_m / texel_m).array().round() * texel_m;
  Eigen::Matrix4d view = turn;
  view.topRightCorner<3, 1>() -= centre_m;
  world_to_light_ = orthographic(robot.radius_m, -kLightRange_m, kLightRange_m) * view.cast<float>();
  texel_m_ = static_cast<float>(texel_m);
}

void Shadows::draw_depth(const Shapes& shapes, const Picture& picture) {
  glBindFramebuffer(GL_FRAMEBUFFER, depth_target_.framebuffer.name());
  glViewport(0, 0, kDepth_px, kDepth_px);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LESS);
  glDepthMask(GL_TRUE);
  glClear(GL_DEPTH_BUFFER_BIT);
  glEnable(GL_POLYGON_OFFSET_FILL);
  glPolygonOffset(1.5F, 4.0F);
  depth_.use();
  depth_.set("view_projection", world_to_light_);
  Shapes::draw_all(depth_, shapes.outlines(picture.collisions), picture.links);
  Shapes::draw_all(depth_, shapes.ground(), picture.links);
  glDisable(GL_POLYGON_OFFSET_FILL);
}

// Seen from above, the lowest surfaces are the backs.
void Shadows::draw_proximity(const Shapes& shapes, const Picture& picture, const RobotBounds& robot) {
  const double half_m = robot.radius_m;
  proximity_place_ =
      Eigen::Vector4d(robot.centre_W_m.x(), robot.centre_W_m.y(), half_m, robot.lowest_W_m).cast<float>();
  glBindFramebuffer(GL_FRAMEBUFFER, proximity_target_.framebuffer.name());
  glViewport(0, 0, kProximity_px, kProximity_px);
  glDisable(GL_DEPTH_TEST);
  glClearColor(0.0F, 0.0F, 0.0F, 0.0F);
  glClear(GL_COLOR_BUFFER_BIT);
  glEnable(GL_BLEND);
  glBlendEquation(GL_MAX);
  proximity_.use();
  proximity_.set("view_projection", Eigen::Matrix4f(orthographic(half_m, -kLightRange_m, kLightRange_m) *
                                                    look_along(robot.centre_W_m, -Eigen::Vector3d::UnitZ(),
                                                               Eigen::Vector3d::UnitY())));
  proximity_.set("lowest_m", proximity_place_.w());
  for (const Shapes::Part& part : shapes.outlines(picture.collisions)) {
    if (shapes.lowest_W_m(part, picture.links) > robot.lowest_W_m + kHighest_m) continue;
    Shapes::place(proximity_, part, picture.links);
    Shapes::draw(part, GL_FRONT);
  }
  glBlendEquation(GL_FUNC_ADD);
  glDisable(GL_BLEND);
  glActiveTexture(GL_TEXTURE1);
  glBindTexture(GL_TEXTURE_2D, proximity_target_.texture.name());
  glGenerateMipmap(GL_TEXTURE_2D);
}

void Shadows::set_uniforms(const GlProgram& surface) const {
  glActiveTexture(GL_TEXTURE1);
  glBindTexture(GL_TEXTURE_2D, proximity_target_.texture.name());
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, depth_target_.texture.name());
  const Eigen::Matrix4f to_texture = (Eigen::Translation3f(0.5F, 0.5F, 0.5F) * Eigen::Scaling(0.5F)).matrix();
  surface.set("world_to_shadow", Eigen::Matrix4f(to_texture * world_to_light_));
  surface.set("shadow_map", 0);
  surface.set("shadow_texel_m", texel_m_);
  surface.set("proximity_map", 1);
  surface.set("proximity_place", proximity_place_);
}

}  // namespace koboshi::view
