#include "view/render/renderer.h"

#include <Eigen/Geometry>
#include <array>

#include "mechanics/axes.h"
#include "view/render/gl.h"
#include "view/render/shaders.h"
#include "view/render/shadows.h"
#include "view/render/shapes.h"

namespace koboshi::view {
namespace {

constexpr float kHidden = 0.6F;  // opacity of a mark that something hides
constexpr Colour kGroundColour{0.900F, 0.905F, 0.915F};
const Eigen::Vector3f kTop(0.985F, 0.988F, 0.992F);
const Eigen::Vector3f kBottom(0.905F, 0.918F, 0.935F);

constexpr std::array<GLenum, 6> kOff{GL_BLEND,        GL_CULL_FACE,           GL_SCISSOR_TEST,
                                     GL_STENCIL_TEST, GL_POLYGON_OFFSET_FILL, GL_FRAMEBUFFER_SRGB};
constexpr std::array<GLint, 3> kMarkLayout{3, 3, 4};

}  // namespace

class Renderer::Implementation {
 public:
  explicit Implementation(const Scene& scene);
  void draw(const Picture& picture, int width_px, int height_px);

 private:
  void draw_background();
  void draw_ground(const Picture& picture);
  void draw_robot(const Picture& picture);
  void draw_ghosts(const Picture& picture);
  void draw_marks(const Picture& picture, const std::vector<MarkVertex>& vertices, float opacity);
  void draw_solid_marks(const Picture& picture);
  void set_light(const Picture& picture);

  std::vector<Plane> planes_;
  Shapes shapes_;
  Shadows shadows_;
  GlBuffer mark_buffer_ = make_buffer();
  GlVertexArray mark_array_ = make_vertex_array();
  GlProgram background_{"background", background_shader()};
  GlProgram surface_{"surface", surface_shader()};
  GlProgram marks_{"marks", mark_shader()};
  Eigen::Matrix4f view_projection_ = Eigen::Matrix4f::Identity();  // of the picture that is being drawn
};

Renderer::Implementation::Implementation(const Scene& scene) : planes_(scene.planes), shapes_(scene) {
  glBindVertexArray(mark_array_.name());
  glBindBuffer(GL_ARRAY_BUFFER, mark_buffer_.name());
  set_attributes(kMarkLayout);
  check_gl("the upload of the scene");
}

void Renderer::Implementation::draw_background() {
  glDisable(GL_DEPTH_TEST);
  background_.use();
  background_.set("top", kTop);
  background_.set("bottom", kBottom);
  glBindVertexArray(mark_array_.name());
  glDrawArrays(GL_TRIANGLES, 0, 3);  // from the vertices' numbers alone
  shapes_.bind();
}

void Renderer::Implementation::set_light(const Picture& picture) {
  surface_.use();
  surface_.set("view_projection", view_projection_);
  surface_.set("eye", Eigen::Vector3f(picture.camera.eye_W_m().cast<float>()));
  surface_.set("to_light", Eigen::Vector3f(to_light_W().cast<float>()));
  shadows_.set_uniforms(surface_);
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
    Eigen::Affine3d place(Eigen::Translation3d(foot_m) * mechanics::rotation_to_normal(plane.normal_W) *
                          Eigen::Scaling(1.5 * fade_m));
    surface_.set("albedo", linear_light(kGroundColour));
    surface_.set("model", Eigen::Matrix4f(place.matrix().cast<float>()));
    Shapes::draw(shapes_.plane());
  }
  // Patches of the ground may lie in its plane.
  glEnable(GL_POLYGON_OFFSET_FILL);
  glPolygonOffset(-1.0F, -2.0F);
  for (const Shapes::Part& part : shapes_.ground()) {
    surface_.set("albedo", linear_light(part.colour));
    Shapes::place(surface_, part, picture.links);
    Shapes::draw(part);
  }
  glDisable(GL_POLYGON_OFFSET_FILL);
  glDisable(GL_BLEND);
  surface_.set("fade_m", 0.0F);
  surface_.set("is_ground", 0.0F);
}

// A translucent robot shows its outermost surface alone: its depth first, then its colour.
void Renderer::Implementation::draw_robot(const Picture& picture) {
  surface_.use();
  surface_.set("opacity", picture.opacity);
  surface_.set("gloss", 0.16F);
  const bool translucent = picture.opacity < 1.0F;
  if (translucent) {
    glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    Shapes::draw_all(surface_, shapes_.outlines(picture.collisions), picture.links);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    glDepthFunc(GL_EQUAL);
    glEnable(GL_BLEND);
  }
  for (const Shapes::Part& part : shapes_.robot(picture.collisions)) {
    const auto link = static_cast<std::size_t>(part.link);
    surface_.set("albedo",
                 linear_light(part.colour, link < picture.tints.size() ? picture.tints[link] : Tint()));
    Shapes::place(surface_, part, picture.links);
    Shapes::draw(part);
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
  marks_.set("to_light", Eigen::Vector3f(to_light_W().cast<float>()));
  marks_.set("opacity", opacity);
  glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(vertices.size()));
  shapes_.bind();
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
  shapes_.bind();
  shadows_.update(shapes_, picture);

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
