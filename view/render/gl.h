#pragma once

// The functions of OpenGL 4.5 core, of which 3.3 are used; libOpenGL passes them to the current context.
#define GL_GLEXT_PROTOTYPES 1
#include <GL/glcorearb.h>

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>

namespace koboshi::view {

// OpenGL refused something. `what()` is one line.
class GlError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// Throws GlError with this text if a call since the last check has failed.
void check_gl(const std::string& what);

// An object of OpenGL that this owns. Its context must be current when it is made, used and destroyed.
template <void (*kDelete)(GLuint)>
class GlObject {
 public:
  GlObject() = default;
  explicit GlObject(GLuint name) : name_(name) {}
  ~GlObject() {
    if (name_ != 0) kDelete(name_);
  }
  GlObject(GlObject&& other) noexcept : name_(std::exchange(other.name_, 0)) {}
  GlObject& operator=(GlObject&& other) noexcept {
    std::swap(name_, other.name_);
    return *this;
  }
  GLuint name() const { return name_; }

 private:
  GLuint name_ = 0;
};

inline void delete_buffer(GLuint name) { glDeleteBuffers(1, &name); }
inline void delete_vertex_array(GLuint name) { glDeleteVertexArrays(1, &name); }
inline void delete_texture(GLuint name) { glDeleteTextures(1, &name); }
inline void delete_framebuffer(GLuint name) { glDeleteFramebuffers(1, &name); }
inline void delete_renderbuffer(GLuint name) { glDeleteRenderbuffers(1, &name); }
inline void delete_program(GLuint name) { glDeleteProgram(name); }

using GlBuffer = GlObject<delete_buffer>;
using GlVertexArray = GlObject<delete_vertex_array>;
using GlTexture = GlObject<delete_texture>;
using GlFramebuffer = GlObject<delete_framebuffer>;
using GlRenderbuffer = GlObject<delete_renderbuffer>;

GlBuffer make_buffer();
GlVertexArray make_vertex_array();
GlTexture make_texture();
GlFramebuffer make_framebuffer();
GlRenderbuffer make_renderbuffer();

// A texture to draw into.
struct GlTarget {
  GlTexture texture = make_texture();
  GlFramebuffer framebuffer = make_framebuffer();
};

// A square of depths that samplers compare (sampler2DShadow), and one of 16-bit floats with mipmaps. Both
// bind their framebuffer, and throw GlError if the driver does not support it.
GlTarget make_depth_target(GLsizei side_px);
GlTarget make_height_target(GLsizei side_px);

// Reads a picture of this size from the framebuffer that is bound for reading: rows from the bottom, four
// bytes a pixel: blue, green, red, opacity. Throws GlError.
void read_pixels(GLsizei width_px, GLsizei height_px, std::span<std::uint8_t> pixels);

// Attributes of vertices that are rows of floats: their sizes, in order of location from 0.
void set_attributes(std::span<const GLint> sizes);

struct ShaderSources {
  std::string vertex;
  std::string fragment;
};

// A linked program. Uniforms are set while it is in use; one that the compiler has dropped is ignored.
class GlProgram {
 public:
  // Throws GlError with the compiler's first line. `name` is for that message.
  GlProgram(const std::string& name, const ShaderSources& sources);
  void use() const { glUseProgram(program_.name()); }
  void set(const char* uniform, int value) const;
  void set(const char* uniform, float value) const;
  void set(const char* uniform, const Eigen::Vector2f& value) const;
  void set(const char* uniform, const Eigen::Vector3f& value) const;
  void set(const char* uniform, const Eigen::Vector4f& value) const;
  void set(const char* uniform, const Eigen::Matrix4f& value) const;

 private:
  GLint location(const char* uniform) const { return glGetUniformLocation(program_.name(), uniform); }

  GlObject<delete_program> program_;
};

// Keeps the state of the context that the renderer changes, and puts it back: a window's toolkit has its own.
class GlStateGuard {
 public:
  GlStateGuard();
  ~GlStateGuard();
  GlStateGuard(const GlStateGuard&) = delete;
  GlStateGuard& operator=(const GlStateGuard&) = delete;

 private:
  static constexpr std::array<GLenum, 7> kSwitches{
      GL_BLEND,        GL_CULL_FACE,           GL_DEPTH_TEST,      GL_SCISSOR_TEST,
      GL_STENCIL_TEST, GL_POLYGON_OFFSET_FILL, GL_FRAMEBUFFER_SRGB};
  static constexpr std::size_t kUnits = 2;

  std::array<GLboolean, kSwitches.size()> switches_{};
  std::array<GLint, kUnits> textures_{};
  std::array<GLint, 4> viewport_{};
  std::array<GLint, 6> blend_{};  // source, destination: colour, alpha; equations
  std::array<GLfloat, 4> clear_colour_{};
  std::array<GLfloat, 2> polygon_offset_{};
  std::array<GLboolean, 4> colour_mask_{};
  GLboolean depth_mask_ = GL_TRUE;
  GLint depth_function_ = GL_LESS;
  GLint hidden_face_ = GL_BACK;
  GLint draw_framebuffer_ = 0;
  GLint read_framebuffer_ = 0;
  GLint vertex_array_ = 0;
  GLint array_buffer_ = 0;
  GLint program_ = 0;
  GLint active_texture_ = 0;
};

}  // namespace koboshi::view
