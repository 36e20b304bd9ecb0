#include "view/render/gl.h"

#include <vector>

namespace koboshi::view {
namespace {

template <typename Object, typename Generate>
Object generate(Generate function) {
  GLuint name = 0;
  function(1, &name);
  return Object(name);
}

void delete_shader(GLuint name) { glDeleteShader(name); }

template <typename Get>
std::string first_line_of_log(GLuint name, Get get) {
  std::vector<char> log(1024, '\0');
  get(name, static_cast<GLsizei>(log.size()) - 1, nullptr, log.data());
  const std::string text(log.data());
  return text.substr(0, text.find('\n'));
}

GlObject<delete_shader> compile(const std::string& name, GLenum kind, const std::string& text) {
  GlObject<delete_shader> shader(glCreateShader(kind));
  const char* source = text.c_str();
  glShaderSource(shader.name(), 1, &source, nullptr);
  glCompileShader(shader.name());
  GLint compiled = 0;
  glGetShaderiv(shader.name(), GL_COMPILE_STATUS, &compiled);
  if (compiled == 0)
    throw GlError("the shader " + name +
                  " does not compile: " + first_line_of_log(shader.name(), glGetShaderInfoLog));
  return shader;
}

void switch_to(GLenum capability, GLboolean on) {
  if (on == GL_TRUE) {
    glEnable(capability);
  } else {
    glDisable(capability);
  }
}

void set_filter(GLint smaller, GLint larger) {
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, smaller);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, larger);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
}

void check_framebuffer() {
  if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
    throw GlError("OpenGL: a framebuffer of the renderer is not supported");
}

}  // namespace

void check_gl(const std::string& what) {
  const GLenum error = glGetError();
  if (error != GL_NO_ERROR) throw GlError("OpenGL: " + what + " failed with error " + std::to_string(error));
}

GlBuffer make_buffer() { return generate<GlBuffer>(glGenBuffers); }
GlVertexArray make_vertex_array() { return generate<GlVertexArray>(glGenVertexArrays); }
GlTexture make_texture() { return generate<GlTexture>(glGenTextures); }
GlFramebuffer make_framebuffer() { return generate<GlFramebuffer>(glGenFramebuffers); }
GlRenderbuffer make_renderbuffer() { return generate<GlRenderbuffer>(glGenRenderbuffers); }

GlTarget make_depth_target(GLsizei side_px) {
  GlTarget target;
  glBindTexture(GL_TEXTURE_2D, target.texture.name());
  glTexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT24, side_px, side_px, 0, GL_DEPTH_COMPONENT,
               GL_UNSIGNED_INT, nullptr);
  set_filter(GL_LINEAR, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
  glBindFramebuffer(GL_FRAMEBUFFER, target.framebuffer.name());
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, target.texture.name(), 0);
  glDrawBuffer(GL_NONE);
  glReadBuffer(GL_NONE);
  check_framebuffer();
  return target;
}

GlTarget make_height_target(GLsizei side_px) {
  GlTarget target;
  glBindTexture(GL_TEXTURE_2D, target.texture.name());
  glTexImage2D(GL_TEXTURE_2D, 0, GL_R16F, side_px, side_px, 0, GL_RED, GL_FLOAT, nullptr);
  set_filter(GL_LINEAR_MIPMAP_LINEAR, GL_LINEAR);
  glGenerateMipmap(GL_TEXTURE_2D);
  glBindFramebuffer(GL_FRAMEBUFFER, target.framebuffer.name());
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, target.texture.name(), 0);
  check_framebuffer();
  return target;
}

void read_pixels(GLsizei width_px, GLsizei height_px, std::span<std::uint8_t> pixels) {
  glPixelStorei(GL_PACK_ALIGNMENT, 4);
  glReadPixels(0, 0, width_px, height_px, GL_BGRA, GL_UNSIGNED_BYTE, pixels.data());
  check_gl("reading a picture");
}

void set_attributes(std::span<const GLint> sizes) {
  GLsizei stride_bytes = 0;
  for (const GLint size : sizes) stride_bytes += size * static_cast<GLsizei>(sizeof(float));
  std::uintptr_t offset_bytes = 0;
  GLuint location = 0;
  for (const GLint size : sizes) {
    glEnableVertexAttribArray(location);
    glVertexAttribPointer(location, size, GL_FLOAT, GL_FALSE, stride_bytes,
                          reinterpret_cast<const void*>(offset_bytes));
    offset_bytes += static_cast<std::uintptr_t>(size) * sizeof(float);
    ++location;
  }
}

GlProgram::GlProgram(const std::string& name, const ShaderSources& sources) : program_(glCreateProgram()) {
  const auto vertex = compile(name, GL_VERTEX_SHADER, sources.vertex);
  const auto fragment = compile(name, GL_FRAGMENT_SHADER, sources.fragment);
  glAttachShader(program_.name(), vertex.name());
  glAttachShader(program_.name(), fragment.name());
  glLinkProgram(program_.name());
  GLint linked = 0;
  glGetProgramiv(program_.name(), GL_LINK_STATUS, &linked);
  if (linked == 0)
    throw GlError("the shader " + name +
                  " does not link: " + first_line_of_log(program_.name(), glGetProgramInfoLog));
}

void GlProgram::set(const char* uniform, int value) const { glUniform1i(location(uniform), value); }
void GlProgram::set(const char* uniform, float value) const { glUniform1f(location(uniform), value); }
void GlProgram::set(const char* uniform, const Eigen::Vector2f& value) const {
  glUniform2fv(location(uniform), 1, value.data());
}
void GlProgram::set(const char* uniform, const Eigen::Vector3f& value) const {
  glUniform3fv(location(uniform), 1, value.data());
}
void GlProgram::set(const char* uniform, const Eigen::Vector4f& value) const {
  glUniform4fv(location(uniform), 1, value.data());
}
void GlProgram::set(const char* uniform, const Eigen::Matrix4f& value) const {
  glUniformMatrix4fv(location(uniform), 1, GL_FALSE, value.data());  // Eigen stores columns, as OpenGL does
}

GlStateGuard::GlStateGuard() {
  for (std::size_t i = 0; i < kSwitches.size(); ++i) switches_[i] = glIsEnabled(kSwitches[i]);
  glGetIntegerv(GL_ACTIVE_TEXTURE, &active_texture_);
  for (std::size_t i = 0; i < kUnits; ++i) {
    glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(i));
    glGetIntegerv(GL_TEXTURE_BINDING_2D, &textures_[i]);
  }
  glGetIntegerv(GL_VIEWPORT, viewport_.data());
  const GLenum blend[] = {GL_BLEND_SRC_RGB,   GL_BLEND_DST_RGB,      GL_BLEND_SRC_ALPHA,
                          GL_BLEND_DST_ALPHA, GL_BLEND_EQUATION_RGB, GL_BLEND_EQUATION_ALPHA};
  for (std::size_t i = 0; i < blend_.size(); ++i) glGetIntegerv(blend[i], &blend_[i]);
  glGetFloatv(GL_COLOR_CLEAR_VALUE, clear_colour_.data());
  glGetFloatv(GL_POLYGON_OFFSET_FACTOR, &polygon_offset_[0]);
  glGetFloatv(GL_POLYGON_OFFSET_UNITS, &polygon_offset_[1]);
  glGetBooleanv(GL_COLOR_WRITEMASK, colour_mask_.data());
  glGetBooleanv(GL_DEPTH_WRITEMASK, &depth_mask_);
  glGetIntegerv(GL_DEPTH_FUNC, &depth_function_);
  glGetIntegerv(GL_CULL_FACE_MODE, &hidden_face_);
  glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &draw_framebuffer_);
  glGetIntegerv(GL_READ_FRAMEBUFFER_BINDING, &read_framebuffer_);
  glGetIntegerv(GL_VERTEX_ARRAY_BINDING, &vertex_array_);
  glGetIntegerv(GL_ARRAY_BUFFER_BINDING, &array_buffer_);
  glGetIntegerv(GL_CURRENT_PROGRAM, &program_);
}

GlStateGuard::~GlStateGuard() {
  for (std::size_t i = 0; i < kSwitches.size(); ++i) switch_to(kSwitches[i], switches_[i]);
  for (std::size_t i = 0; i < kUnits; ++i) {
    glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(i));
    glBindTexture(GL_TEXTURE_2D, static_cast<GLuint>(textures_[i]));
  }
  glActiveTexture(static_cast<GLenum>(active_texture_));
  glViewport(viewport_[0], viewport_[1], viewport_[2], viewport_[3]);
  glBlendFuncSeparate(static_cast<GLenum>(blend_[0]), static_cast<GLenum>(blend_[1]),
                      static_cast<GLenum>(blend_[2]), static_cast<GLenum>(blend_[3]));
  glBlendEquationSeparate(static_cast<GLenum>(blend_[4]), static_cast<GLenum>(blend_[5]));
  glClearColor(clear_colour_[0], clear_colour_[1], clear_colour_[2], clear_colour_[3]);
  glPolygonOffset(polygon_offset_[0], polygon_offset_[1]);
  glColorMask(colour_mask_[0], colour_mask_[1], colour_mask_[2], colour_mask_[3]);
  glDepthMask(depth_mask_);
  glDepthFunc(static_cast<GLenum>(depth_function_));
  glCullFace(static_cast<GLenum>(hidden_face_));
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, static_cast<GLuint>(draw_framebuffer_));
  glBindFramebuffer(GL_READ_FRAMEBUFFER, static_cast<GLuint>(read_framebuffer_));
  glBindVertexArray(static_cast<GLuint>(vertex_array_));
  glBindBuffer(GL_ARRAY_BUFFER, static_cast<GLuint>(array_buffer_));
  glUseProgram(static_cast<GLuint>(program_));
}

}  // namespace koboshi::view
