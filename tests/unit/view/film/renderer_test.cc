#include "view/render/renderer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <vector>

#include "sim_board/world/support_polygon.h"
#include "tests/support/sample_recording.h"
#include "view/film/offscreen.h"
#include "view/render/gl.h"

namespace koboshi::view {
namespace {

constexpr int kWidth_px = 200;
constexpr int kHeight_px = 160;

struct Pixel {
  int red;
  int green;
  int blue;
};

// Pictures of a blue box of 0.1 m that floats over a plane, in a context without a display.
class RendererTest : public testing::Test {
 protected:
  static Scene scene() {
    Scene scene;
    Link box{.name = "box"};
    box.visuals.push_back({.name = "box", .geometry = Box{{0.1, 0.1, 0.1}}, .colour = {0.1F, 0.2F, 0.9F}});
    box.collisions.push_back({.name = "box", .geometry = Box{{0.2, 0.2, 0.1}}, .colour = {0.1F, 0.2F, 0.9F}});
    scene.links = {box};
    scene.planes = {{}};
    return scene;
  }

  static Picture picture_at(float x_m, float y_m, float z_m) {
    Picture picture;
    picture.camera = {
        .target_W_m = {0.0, 0.0, 0.1}, .azimuth_rad = 0.0, .elevation_rad = 0.5, .distance_m = 2.0};
    picture.links = {{.p_WL_m = {x_m, y_m, z_m}}};
    return picture;
  }

  std::vector<std::uint8_t> draw(const Picture& picture) {
    std::vector<std::uint8_t> pixels(4 * kWidth_px * kHeight_px);
    framebuffer_.bind();
    renderer_.draw(picture, kWidth_px, kHeight_px);
    framebuffer_.read(pixels);
    return pixels;
  }

  static Pixel at(const std::vector<std::uint8_t>& pixels, const Eigen::Vector2d& p_px) {
    const auto i =
        4 * static_cast<std::size_t>(static_cast<int>(p_px.y()) * kWidth_px + static_cast<int>(p_px.x()));
    return {pixels[i + 2], pixels[i + 1], pixels[i]};
  }
  static Pixel at(const std::vector<std::uint8_t>& pixels, const Picture& picture,
                  const Eigen::Vector3d& p_W_m) {
    return at(pixels, project(picture.camera, kWidth_px, kHeight_px, p_W_m));
  }

  static bool is_blue(const Pixel& pixel) { return pixel.blue > pixel.red + 40; }

  struct Covered {
    int count = 0;
    Eigen::Vector2d mean_px = Eigen::Vector2d::Zero();
  };
  static Covered covered(const std::vector<std::uint8_t>& pixels) {
    Covered result;
    for (int y = 0; y < kHeight_px; ++y) {
      for (int x = 0; x < kWidth_px; ++x) {
        if (!is_blue(at(pixels, Eigen::Vector2d(x, y)))) continue;
        ++result.count;
        result.mean_px += Eigen::Vector2d(x + 0.5, y + 0.5);
      }
    }
    result.mean_px /= result.count;
    return result;
  }

  OffscreenContext context_;
  Renderer renderer_{scene()};
  OffscreenFramebuffer framebuffer_{kWidth_px, kHeight_px};
};

TEST_F(RendererTest, ShowsABoxWithTheAreaAndThePlaceOfItsProjection) {
  const Picture picture = picture_at(0.0F, 0.1F, 0.1F);
  const Covered box = covered(draw(picture));
  std::vector<Eigen::Vector2d> corners_px;
  for (const double x : {-0.05, 0.05}) {
    for (const double y : {0.05, 0.15}) {
      for (const double z : {0.05, 0.15})
        corners_px.push_back(project(picture.camera, kWidth_px, kHeight_px, {x, y, z}));
    }
  }
  const std::vector<Eigen::Vector2d> outline_px = sim_board::convex_hull(corners_px);
  double expected = 0.0;
  for (std::size_t i = 0; i < outline_px.size(); ++i) {
    const Eigen::Vector2d& a = outline_px[i];
    const Eigen::Vector2d& b = outline_px[(i + 1) % outline_px.size()];
    expected += 0.5 * (a.x() * b.y() - a.y() * b.x());
  }
  EXPECT_NEAR(box.count / expected, 1.0, 0.05);  // pixels at the edge are in part covered
  const Eigen::Vector2d centre_px = project(picture.camera, kWidth_px, kHeight_px, {0.0, 0.1, 0.1});
  EXPECT_LT((box.mean_px - centre_px).norm(), 2.0);
}

TEST_F(RendererTest, MovesWithThePose) {
  const Covered left = covered(draw(picture_at(0.0F, 0.1F, 0.1F)));
  const Covered right = covered(draw(picture_at(0.0F, -0.1F, 0.1F)));
  // Its left, seen from ahead, is the picture's right.
  EXPECT_GT(left.mean_px.x(), right.mean_px.x() + 30.0);
}

TEST_F(RendererTest, DarkensTheGroundInItsShadowAndNearIt) {
  // The light comes from ahead, left and above: the shadow of a box at 0.3 m is 0.19 m behind, 0.08 m right.
  const Picture picture = picture_at(0.0F, 0.0F, 0.3F);
  const auto pixels = draw(picture);
  const Pixel shadow = at(pixels, picture, {-0.186, -0.075, 0.0});
  const Pixel open = at(pixels, picture, {0.186, 0.075, 0.0});
  EXPECT_LT(shadow.green, open.green - 30);
  const Picture standing = picture_at(0.0F, 0.0F, 0.051F);
  const Pixel beside = at(draw(standing), standing, {0.058, 0.0, 0.0});
  EXPECT_LT(beside.green, open.green - 8) << "light from the sky does not reach the corner";
}

TEST_F(RendererTest, ShowsCollisionsOrTranslucenceIfAskedFor) {
  Picture picture = picture_at(0.0F, 0.0F, 0.1F);
  const Covered seen = covered(draw(picture));
  picture.collisions = true;
  EXPECT_GT(covered(draw(picture)).count, 1.8 * seen.count);
  picture.collisions = false;
  const Pixel opaque = at(draw(picture), picture, {0.05, 0.0, 0.1});
  picture.opacity = 0.3F;
  const Pixel translucent = at(draw(picture), picture, {0.05, 0.0, 0.1});
  EXPECT_GT(translucent.red, opaque.red + 30);
}

TEST_F(RendererTest, ShowsMarksAndThemFaintlyBehindTheBox) {
  const Pixel before = at(draw(picture_at(0.0F, 0.0F, 0.1F)), picture_at(0.0F, 0.0F, 0.1F), {0.05, 0.0, 0.1});
  Picture picture = picture_at(0.0F, 0.0F, 0.1F);
  add_sphere(picture.marks, {0.0, 0.0, 0.1}, 0.02, {1.0F, 0.0F, 0.0F});  // in its middle
  add_sphere(picture.marks, {0.0, 0.2, 0.1}, 0.02, {1.0F, 0.0F, 0.0F});
  const auto pixels = draw(picture);
  const Pixel hidden = at(pixels, picture, {0.0, 0.0, 0.1});
  const Pixel free = at(pixels, picture, {0.0, 0.2, 0.1});
  EXPECT_GT(free.red, free.blue + 100);
  EXPECT_GT(hidden.red, before.red + 30);
  EXPECT_GT(hidden.blue, free.blue + 10);
}

TEST_F(RendererTest, LeavesTheStateOfTheContextAlone) {
  framebuffer_.bind();
  GLint bound = 0;
  glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &bound);
  glEnable(GL_CULL_FACE);
  glDisable(GL_DEPTH_TEST);
  glViewport(1, 2, 3, 4);
  glDepthFunc(GL_ALWAYS);
  renderer_.draw(picture_at(0.0F, 0.0F, 0.1F), kWidth_px, kHeight_px);
  GLint value[4] = {};
  glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, value);
  EXPECT_EQ(value[0], bound);
  EXPECT_TRUE(glIsEnabled(GL_CULL_FACE));
  EXPECT_FALSE(glIsEnabled(GL_DEPTH_TEST));
  glGetIntegerv(GL_VIEWPORT, value);
  EXPECT_EQ(value[3], 4);
  glGetIntegerv(GL_DEPTH_FUNC, value);
  EXPECT_EQ(value[0], GL_ALWAYS);
  glGetIntegerv(GL_CURRENT_PROGRAM, value);
  EXPECT_EQ(value[0], 0);
  EXPECT_EQ(glGetError(), static_cast<GLenum>(GL_NO_ERROR));
}

TEST_F(RendererTest, RefusesAFramebufferThatOpenGlCannotMake) {
  EXPECT_THROW(OffscreenFramebuffer(1'000'000, 16), GlError);
}

}  // namespace
}  // namespace koboshi::view
