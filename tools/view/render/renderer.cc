#include "tools/view/render/renderer.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "tools/view/render/gl.h"
#include "tools/view/render/shaders.h"
#include "tools/view/render/surface.h"

namespace koboshi::view {
namespace {

constexpr GLsizei kShadow_px = 1024;
constexpr GLsizei kProximity_px = 256;
constexpr double kLightRange_m = 4.0;  // of ground and steps that cast shadows onto the robot
constexpr double kRadiusStep_m = 0.1;  // the shadow's resolution changes in steps, so that its edges rest
const Eigen::Vector3d kToLight = Eigen::Vector3d(0.62, 0.25, 1.0).normalized();

constexpr float kHidden = 0.6F;  // opacity of a mark that something hides
constexpr Colour kGroundColour{0.900F, 0.905F, 0.915F};
const Eigen::Vector3f kTop(0.985F, 0.988F, 0.992F);
const Eigen::Vector3f kBottom(0.905F, 0.918F, 0.935F);

constexpr std::array<GLenum, 6> kOff{GL_BLEND,        GL_CULL_FACE,           GL_SCISSOR_TEST,
                                     GL_STENCIL_TEST, GL_POLYGON_OFFSET_FILL, GL_FRAMEBUFFER_SRGB};
constexpr std::array<GLint, 2> kSurfaceLayout{3, 3};
constexpr std::array<GLint, 3> kMarkLayout{3, 3, 4};

Eigen::Matrix4f matrix_of(const Pose& pose) {
  Eigen::Matrix4f matrix = Eigen::Matrix4f::Identity();
  matrix.topLeftCorner<3, 3>() = pose.q_WL.toRotationMatrix();
  matrix.topRightCorner<3, 1>() = pose.p_WL_m;
  return matrix;
}

GlProgram make_program(const std::string& name, const ShaderSources& sources) {
  return GlProgram(name, sources.vertex, sources.fragment);
}

}  // namespace

class Renderer::Implementation {
 public:
  explicit Implementation(const Scene& scene);
  void draw(const Picture& picture, int width_px, int height_px);

 private:
  // A range of the vertex buffer: a shape.
  struct Part {
    GLint first = 0;
    GLsizei count = 0;
    int link = -1;  // -1: the ground
    Eigen::Matrix4f X_LG = Eigen::Matrix4f::Identity();
    Colour colour;
  };

  // A sphere that holds the robot.
  struct Bounds {
    Eigen::Vector3d centre_m = Eigen::Vector3d::Zero();
    double radius_m = 0.0;
    double lowest_m = 0.0;
  };

  void add_shape(Surface& all, const Shape& shape, int link, std::vector<Part>& parts);
  Bounds bounds(const Picture& picture) const;
  void place_shadow(const Bounds& robot);
  void draw_shadow(const Picture& picture);
  void draw_proximity(const Picture& picture, const Bounds& robot);
  void draw_background();
  void draw_ground(const Picture& picture);
  void draw_robot(const Picture& picture);
  void draw_ghosts(const Picture& picture);
  void draw_marks(const Picture& picture, const std::vector<MarkVertex>& vertices, float opacity);
  void draw_solid_marks(const Picture& picture);
  void draw_part(const GlProgram& program, const Part& part, const Picture& picture);
  static Eigen::Vector3f albedo(const Part& part, const Picture& picture);
  void set_light(const Picture& picture);
  const std::vector<Part>& robot_parts(const Picture& picture) const {
    return picture.collisions ? collisions_ : visuals_;
  }

  std::vector<Part> visuals_;
  std::vector<Part> collisions_;
  std::vector<Part> ground_;
  std::vector<float> radii_m_;  // of each link about its origin
  std::vector<Plane> planes_;
  Part plane_;

  GlBuffer surface_buffer_ = make_buffer();
  GlVertexArray surface_array_ = make_vertex_array();
  GlBuffer mark_buffer_ = make_buffer();
  GlVertexArray mark_array_ = make_vertex_array();
  GlProgram background_ = make_program("background", background_shader());
  GlProgram surface_ = make_program("surface", surface_shader());
  GlProgram depth_ = make_program("depth", depth_shader());
  GlProgram proximity_ = make_program("proximity", proximity_shader());
  GlProgram marks_ = make_program("marks", mark_shader());
  GlTarget shadow_target_ = make_depth_target(kShadow_px);
  GlTarget proximity_target_ = make_height_target(kProximity_px);

  // Of the picture that is being drawn.
  Eigen::Matrix4f view_projection_ = Eigen::Matrix4f::Identity();
  Eigen::Matrix4f world_to_light_ = Eigen::Matrix4f::Identity();
  float shadow_texel_m_ = 0.0F;
  Eigen::Vector4f proximity_place_ = Eigen::Vector4f::Zero();
};

Renderer::Implementation::Implementation(const Scene& scene) : planes_(scene.planes) {
  Surface all;
  radii_m_.assign(scene.links.size(), 0.0F);
  for (std::size_t i = 0; i < scene.links.size(); ++i) {
    for (const Shape& shape : scene.links[i].visuals) add_shape(all, shape, static_cast<int>(i), visuals_);
    for (const Shape& shape : scene.links[i].collisions)
      add_shape(all, shape, static_cast<int>(i), collisions_);
  }
  for (const Shape& shape : scene.ground) add_shape(all, shape, -1, ground_);
  plane_ = {static_cast<GLint>(all.size()), 6, -1, Eigen::Matrix4f::Identity(), kGroundColour};
  for (const auto& [x, y] : {std::pair{-1, -1}, std::pair{1, -1}, std::pair{1, 1}, std::pair{-1, -1},
                             std::pair{1, 1}, std::pair{-1, 1}}) {
    all.push_back({{static_cast<float>(x), static_cast<float>(y), 0.0F}, Eigen::Vector3f::UnitZ()});
  }
  glBindVertexArray(surface_array_.name());
  glBindBuffer(GL_ARRAY_BUFFER, surface_buffer_.name());
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(all.size() * sizeof(Vertex)), all.data(),
               GL_STATIC_DRAW);
  set_attributes(kSurfaceLayout);
  glBindVertexArray(mark_array_.name());
  glBindBuffer(GL_ARRAY_BUFFER, mark_buffer_.name());
  set_attributes(kMarkLayout);
  check_gl("the upload of the scene");
}

void Renderer::Implementation::add_shape(Surface& all, const Shape& shape, int link,
                                         std::vector<Part>& parts) {
  const Surface surface = surface_of(shape);
  parts.push_back({static_cast<GLint>(all.size()), static_cast<GLsizei>(surface.size()), link,
                   shape.X_LG.matrix().cast<float>(), shape.colour});
  all.insert(all.end(), surface.begin(), surface.end());
  if (link < 0) return;
  float& radius = radii_m_[static_cast<std::size_t>(link)];
  radius = std::max(radius, radius_m(surface) + shape.X_LG.translation().cast<float>().norm());
}

Renderer::Implementation::Bounds Renderer::Implementation::bounds(const Picture& picture) const {
  Eigen::AlignedBox3d box;
  for (std::size_t i = 0; i < picture.links.size(); ++i) {
    const Eigen::Vector3d p_m = picture.links[i].p_WL_m.cast<double>();
    const Eigen::Vector3d reach_m = Eigen::Vector3d::Constant(static_cast<double>(radii_m_[i]));
    box.extend(Eigen::AlignedBox3d(p_m - reach_m, p_m + reach_m));
  }
  if (box.isEmpty()) return {};
  const double radius_m = kRadiusStep_m * std::ceil(0.5 * box.diagonal().norm() / kRadiusStep_m);
  return {box.center(), radius_m, box.min().z()};
}

// The shadow map covers the robot's sphere and moves by whole texels.
void Renderer::Implementation::place_shadow(const Bounds& robot) {
  const double half_m = std::max(robot.radius_m, kRadiusStep_m);
  const double texel_m = 2.0 * half_m / kShadow_px;
  const Eigen::Matrix4d turn =
      look_along(Eigen::Vector3d::Zero(), -kToLight, Eigen::Vector3d::UnitX()).cast<double>();
  Eigen::Vector3d centre_m = (turn * robot.centre_m.homogeneous()).head<3>();
  centre_m = (centre_m / texel_m).array().round() * texel_m;
  Eigen::Matrix4d view = turn;
  view.topRightCorner<3, 1>() -= centre_m;
  world_to_light_ = orthographic(half_m, -kLightRange_m, kLightRange_m) * view.cast<float>();
  shadow_texel_m_ = static_cast<float>(texel_m);
}

void Renderer::Implementation::draw_part(const GlProgram& program, const Part& part, const Picture& picture) {
  program.set("model", part.link < 0
                           ? part.X_LG
                           : Eigen::Matrix4f(matrix_of(picture.links[static_cast<std::size_t>(part.link)]) *
                                             part.X_LG));
  glDrawArrays(GL_TRIANGLES, part.first, part.count);
}

void Renderer::Implementation::draw_shadow(const Picture& picture) {
  glBindFramebuffer(GL_FRAMEBUFFER, shadow_target_.framebuffer.name());
  glViewport(0, 0, kShadow_px, kShadow_px);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LESS);
  glDepthMask(GL_TRUE);
  glClear(GL_DEPTH_BUFFER_BIT);
  glEnable(GL_POLYGON_OFFSET_FILL);
  glPolygonOffset(1.5F, 4.0F);
  depth_.use();
  depth_.set("view_projection", world_to_light_);
  for (const Part& part : robot_parts(picture)) draw_part(depth_, part, picture);
  for (const Part& part : ground_) draw_part(depth_, part, picture);
  glDisable(GL_POLYGON_OFFSET_FILL);
}

void Renderer::Implementation::draw_proximity(const Picture& picture, const Bounds& robot) {
  const double half_m = std::max(robot.radius_m, kRadiusStep_m);
  proximity_place_ =
      Eigen::Vector4d(robot.centre_m.x(), robot.centre_m.y(), half_m, robot.lowest_m).cast<float>();
  glBindFramebuffer(GL_FRAMEBUFFER, proximity_target_.framebuffer.name());
  glViewport(0, 0, kProximity_px, kProximity_px);
  glDisable(GL_DEPTH_TEST);
  glClearColor(0.0F, 0.0F, 0.0F, 0.0F);
  glClear(GL_COLOR_BUFFER_BIT);
  glEnable(GL_BLEND);
  glBlendEquation(GL_MAX);
  proximity_.use();
  proximity_.set("view_projection", Eigen::Matrix4f(orthographic(half_m, -kLightRange_m, kLightRange_m) *
                                                    look_along(robot.centre_m, -Eigen::Vector3d::UnitZ(),
                                                               Eigen::Vector3d::UnitY())));
  proximity_.set("lowest_m", proximity_place_.w());
  for (const Part& part : robot_parts(picture)) draw_part(proximity_, part, picture);
  glBlendEquation(GL_FUNC_ADD);
  glDisable(GL_BLEND);
  glActiveTexture(GL_TEXTURE1);
  glBindTexture(GL_TEXTURE_2D, proximity_target_.texture.name());
  glGenerateMipmap(GL_TEXTURE_2D);
}

void Renderer::Implementation::draw_background() {
  glDisable(GL_DEPTH_TEST);
  background_.use();
  background_.set("top", kTop);
  background_.set("bottom", kBottom);
  glBindVertexArray(mark_array_.name());
  glDrawArrays(GL_TRIANGLES, 0, 3);  // from the vertices' numbers alone
  glBindVertexArray(surface_array_.name());
}

void Renderer::Implementation::set_light(const Picture& picture) {
  const Eigen::Matrix4f to_texture = (Eigen::Translation3f(0.5F, 0.5F, 0.5F) * Eigen::Scaling(0.5F)).matrix();
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, shadow_target_.texture.name());
  surface_.use();
  surface_.set("view_projection", view_projection_);
  surface_.set("eye", Eigen::Vector3f(picture.camera.eye_W_m().cast<float>()));
  surface_.set("to_light", Eigen::Vector3f(kToLight.cast<float>()));
  surface_.set("world_to_shadow", Eigen::Matrix4f(to_texture * world_to_light_));
  surface_.set("shadow_map", 0);
  surface_.set("shadow_texel_m", shadow_texel_m_);
  surface_.set("proximity_map", 1);
  surface_.set("proximity_place", proximity_place_);
}

void Renderer::Implementation::draw_ground(const Picture& picture) {
  const double fade_m = 1.5 + 2.2 * picture.camera.distance_m;
  surface_.set("is_ground", 1.0F);
  surface_.set("opacity", 1.0F);
  surface_.set("gloss", 0.0F);
  surface_.set("fade_m", static_cast<float>(fade_m));
  surface_.set("fade_centre", Eigen::Vector2f(picture.camera.target_W_m.head<2>().cast<float>()));
  glEnable(GL_BLEND);
  for (const Plane& plane : planes_) {
    const Eigen::Vector3d target_m = picture.camera.target_W_m;
    const Eigen::Vector3d foot_m =
        target_m - (plane.normal_W.dot(target_m) - plane.offset_m) * plane.normal_W;
    Eigen::Affine3d place(Eigen::Translation3d(foot_m) *
                          Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), plane.normal_W) *
                          Eigen::Scaling(1.5 * fade_m));
    Part part = plane_;
    part.X_LG = place.matrix().cast<float>();
    surface_.set("albedo", linear_light(part.colour));
    draw_part(surface_, part, picture);
  }
  // Patches of the ground may lie in its plane.
  glEnable(GL_POLYGON_OFFSET_FILL);
  glPolygonOffset(-1.0F, -2.0F);
  for (const Part& part : ground_) {
    surface_.set("albedo", linear_light(part.colour));
    draw_part(surface_, part, picture);
  }
  glDisable(GL_POLYGON_OFFSET_FILL);
  glDisable(GL_BLEND);
  surface_.set("fade_m", 0.0F);
  surface_.set("is_ground", 0.0F);
}

// The linear colour of a link's shape with its tint.
Eigen::Vector3f Renderer::Implementation::albedo(const Part& part, const Picture& picture) {
  const auto link = static_cast<std::size_t>(part.link);
  return linear_light(part.colour, link < picture.tints.size() ? picture.tints[link] : Tint());
}

// A translucent robot shows its outermost surface alone: its depth first, then its colour.
void Renderer::Implementation::draw_robot(const Picture& picture) {
  surface_.use();
  surface_.set("opacity", picture.opacity);
  surface_.set("gloss", 0.16F);
  const bool translucent = picture.opacity < 1.0F;
  if (translucent) {
    glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    for (const Part& part : robot_parts(picture)) draw_part(surface_, part, picture);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    glDepthFunc(GL_EQUAL);
    glEnable(GL_BLEND);
  }
  for (const Part& part : robot_parts(picture)) {
    surface_.set("albedo", albedo(part, picture));
    draw_part(surface_, part, picture);
  }
  glDepthFunc(GL_LESS);
  glDisable(GL_BLEND);
}

// Where surfaces coincide, such as those of feet that have not moved, the earlier one shows.
void Renderer::Implementation::draw_ghosts(const Picture& picture) {
  glEnable(GL_POLYGON_OFFSET_FILL);
  float offset = 0.0F;
  for (const Ghost& ghost : picture.ghosts) {
    offset += 1.0F;
    glPolygonOffset(offset, 8.0F * offset);
    draw_robot({.camera = picture.camera,
                .links = ghost.links,
                .collisions = picture.collisions,
                .opacity = ghost.opacity,
                .tints = ghost.tints});
  }
  glDisable(GL_POLYGON_OFFSET_FILL);
}

void Renderer::Implementation::draw_marks(const Picture& picture, const std::vector<MarkVertex>& vertices,
                                          float opacity) {
  glBindVertexArray(mark_array_.name());
  glBindBuffer(GL_ARRAY_BUFFER, mark_buffer_.name());
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vertices.size() * sizeof(MarkVertex)),
               vertices.data(), GL_STREAM_DRAW);
  marks_.use();
  marks_.set("view_projection", view_projection_);
  marks_.set("eye", Eigen::Vector3f(picture.camera.eye_W_m().cast<float>()));
  marks_.set("to_light", Eigen::Vector3f(kToLight.cast<float>()));
  marks_.set("opacity", opacity);
  glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(vertices.size()));
  glBindVertexArray(surface_array_.name());
}

void Renderer::Implementation::draw_solid_marks(const Picture& picture) {
  if (picture.opacity >= 1.0F) {
    glEnable(GL_BLEND);
    glDepthMask(GL_FALSE);
    glDepthFunc(GL_GREATER);
    draw_marks(picture, picture.marks.solid, kHidden);
    glDepthFunc(GL_LESS);
    glDepthMask(GL_TRUE);
    glDisable(GL_BLEND);
  }
  draw_marks(picture, picture.marks.solid, 1.0F);
}

void Renderer::Implementation::draw(const Picture& picture, int width_px, int height_px) {
  GLint framebuffer = 0;
  glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &framebuffer);
  for (const GLenum off : kOff) glDisable(off);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glBlendEquation(GL_FUNC_ADD);
  glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  glBindVertexArray(surface_array_.name());
  const Bounds robot = bounds(picture);
  place_shadow(robot);
  draw_shadow(picture);
  draw_proximity(picture, robot);

  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, static_cast<GLuint>(framebuffer));
  glViewport(0, 0, width_px, height_px);
  const double aspect = static_cast<double>(width_px) / height_px;
  view_projection_ = picture.camera.projection(aspect) * picture.camera.view();
  draw_background();
  glEnable(GL_DEPTH_TEST);
  glClear(GL_DEPTH_BUFFER_BIT);
  set_light(picture);
  draw_ground(picture);
  glEnable(GL_BLEND);
  glDepthMask(GL_FALSE);
  glEnable(GL_POLYGON_OFFSET_FILL);
  glPolygonOffset(-2.0F, -8.0F);
  draw_marks(picture, picture.marks.flat, 1.0F);
  glDisable(GL_POLYGON_OFFSET_FILL);
  glDepthMask(GL_TRUE);
  glDisable(GL_BLEND);
  if (picture.opacity < 1.0F) draw_solid_marks(picture);  // seen through the robot
  draw_robot(picture);
  draw_ghosts(picture);
  if (picture.opacity >= 1.0F) draw_solid_marks(picture);
  check_gl("drawing");
}

Renderer::Renderer(const Scene& scene) {
  const GlStateGuard guard;
  implementation_ = std::make_unique<Implementation>(scene);
}

Renderer::~Renderer() = default;

void Renderer::draw(const Picture& picture, int width_px, int height_px) {
  const GlStateGuard guard;
  implementation_->draw(picture, width_px, height_px);
}

}  // namespace koboshi::view
