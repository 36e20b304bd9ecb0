#include "view/render/shaders.h"

#include <fmt/format.h>

namespace koboshi::view {
namespace {

constexpr const char* kVersion = "#version 330 core\n";

constexpr const char* kColours = R"(
vec3 linear(vec3 srgb) {
  return mix(srgb / 12.92, pow((srgb + 0.055) / 1.055, vec3(2.4)), step(0.04045, srgb));
}
vec3 srgb(vec3 colour) {
  vec3 c = clamp(colour, 0.0, 1.0);
  return mix(12.92 * c, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, c));
}
)";

constexpr const char* kModelVertex = R"(
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
uniform mat4 model;
uniform mat4 view_projection;
out vec3 world;
out vec3 world_normal;
void main() {
  vec4 p = model * vec4(position, 1.0);
  world = p.xyz;
  world_normal = mat3(model) * normal;
  gl_Position = view_projection * p;
}
)";

constexpr const char* kBackgroundVertex = R"(
out vec2 place;
void main() {
  place = vec2((gl_VertexID << 1) & 2, gl_VertexID & 2);
  gl_Position = vec4(2.0 * place - 1.0, 0.0, 1.0);
}
)";

constexpr const char* kBackgroundFragment = R"(
in vec2 place;
out vec4 colour;
uniform vec3 top;
uniform vec3 bottom;
void main() { colour = vec4(mix(bottom, top, smoothstep(0.0, 1.0, place.y)), 1.0); }
)";

constexpr const char* kSurfaceFragment = R"(
in vec3 world;
in vec3 world_normal;
out vec4 colour;
uniform vec3 albedo;       // linear
uniform float opacity;
uniform float gloss;
uniform vec3 eye;
uniform vec3 to_light;
uniform mat4 world_to_shadow;
uniform sampler2DShadow shadow_map;
uniform float shadow_texel_m;
uniform sampler2D proximity_map;
uniform vec4 proximity_place;  // centre x, y; half width; height of the reference
uniform float is_ground;       // 1: grid, darkness under links
uniform vec2 fade_centre;
uniform float fade_m;          // distance at which the ground has vanished; 0: never

const vec3 kKey = vec3(0.80, 0.77, 0.72);
const vec3 kSky = vec3(0.40, 0.42, 0.46);
const vec3 kBounce = vec3(0.21, 0.20, 0.19);
const float kCamera = 0.10;

// The share of the key light that arrives: a tent over 5 x 5 texels, in nine samples, because a sample adds two
// neighbours in each direction: of a row of six texels with the weights 1 - f, 2 - f, 3 - f, 2 + f, 1 + f and f.
// The loop ends at once where nothing can be in shadow; a software renderer runs both sides of a branch.
float lit(vec3 normal, float facing) {
  vec3 p = world + normal * shadow_texel_m * mix(3.5, 1.0, facing);
  vec3 at = (world_to_shadow * vec4(p, 1.0)).xyz;
  bool covered = facing > 0.0 && all(greaterThan(at, vec3(0.0))) && all(lessThan(at, vec3(1.0)));
  vec2 size = vec2(textureSize(shadow_map, 0));
  vec2 first = floor(at.xy * size - 0.5);
  vec2 f = at.xy * size - 0.5 - first;
  vec2 left = first - 1.5 + (2.0 - f) / (3.0 - 2.0 * f);
  vec2 middle = first + 0.5 + (2.0 + f) / 5.0;
  vec2 right = first + 2.5 + f / (1.0 + 2.0 * f);
  float sum = 0.0;
  int rows = covered ? 3 : 0;
  for (int row = 0; row < rows; ++row) {
    float y = row == 0 ? left.y : row == 1 ? middle.y : right.y;
    float weight = row == 0 ? 3.0 - 2.0 * f.y : row == 1 ? 5.0 : 1.0 + 2.0 * f.y;
    sum += weight * ((3.0 - 2.0 * f.x) * textureLod(shadow_map, vec3(vec2(left.x, y) / size, at.z), 0.0) +
                     5.0 * textureLod(shadow_map, vec3(vec2(middle.x, y) / size, at.z), 0.0) +
                     (1.0 + 2.0 * f.x) * textureLod(shadow_map, vec3(vec2(right.x, y) / size, at.z), 0.0));
  }
  vec2 edge = smoothstep(vec2(0.0), vec2(0.05), at.xy) * smoothstep(vec2(0.0), vec2(0.05), 1.0 - at.xy);
  return covered ? mix(1.0, sum / 81.0, edge.x * edge.y) : 1.0;
}

// The share of the sky that near links hide from the ground.
float hidden() {
  vec2 at = 0.5 + 0.5 * (world.xy - proximity_place.xy) / proximity_place.z;
  bool covered = is_ground > 0.5 && all(greaterThan(at, vec2(0.0))) && all(lessThan(at, vec2(1.0)));
  float sum = 0.0;
  vec2 step_size = vec2(0.011) / (2.0 * proximity_place.z);
  int rows = covered ? 3 : 0;
  for (int row = 0; row < rows; ++row) {
    float y = float(row) - 1.0;
    for (float x = -1.0; x <= 1.0; ++x) {
      float weight = (2.0 - abs(x)) * (2.0 - abs(y));
      sum += weight * textureLod(proximity_map, at + vec2(x, y) * step_size, 2.0).r;
    }
  }
  float height_m = max(world.z - proximity_place.w, 0.0);
  return clamp(sum / 16.0 * exp(height_m / kProximity_m), 0.0, 1.0);
}

float power16(float x) {
  float x4 = x * x * x * x;
  return x4 * x4 * x4 * x4;
}

float line(vec2 p, float spacing_m, float width_px) {
  vec2 q = p / spacing_m;
  vec2 per_pixel = fwidth(q);
  vec2 distance_px = abs(fract(q - 0.5) - 0.5) / per_pixel;
  vec2 share = clamp(0.5 * width_px + 0.5 - distance_px, 0.0, 1.0) * (1.0 - smoothstep(0.1, 0.35, per_pixel));
  return max(share.x, share.y);
}

void main() {
  vec3 to_eye = normalize(eye - world);
  vec3 normal = normalize(world_normal);
  if (dot(normal, to_eye) < 0.0) normal = -normal;
  float facing = dot(normal, to_light);
  float key = max(facing, 0.0) * lit(normal, facing);
  vec3 base = albedo;
  float open_sky = 1.0;
  if (is_ground > 0.5) {
    base *= 1.0 - 0.10 * line(world.xy, 0.1, 1.2) - 0.22 * line(world.xy, 1.0, 2.0);
    open_sky = 1.0 - 0.7 * hidden();
  }
  vec3 ambient = mix(kBounce, kSky, 0.5 + 0.5 * normal.z) * open_sky;
  vec3 light = ambient + kKey * key * mix(1.0, open_sky, 0.3) + kCamera * dot(normal, to_eye);
  vec3 half_way = normalize(to_light + to_eye);
  float mirrored = max(dot(normal, half_way), 0.0);
  float cubed = mirrored * mirrored * mirrored;
  float shine = gloss * power16(cubed) * key;
  float away = 1.0 - dot(normal, to_eye);
  float rim = gloss * 0.35 * away * away * away * away;
  float visible = opacity;
  if (fade_m > 0.0) visible *= 1.0 - smoothstep(0.3 * fade_m, fade_m, distance(world.xy, fade_centre));
  colour = vec4(srgb(base * light + shine * kKey + rim * kSky), visible);
}
)";

constexpr const char* kDepthFragment = "void main() {}\n";

constexpr const char* kProximityFragment = R"(
in vec3 world;
out float nearness;
uniform float lowest_m;
void main() { nearness = exp(-max(world.z - lowest_m, 0.0) / kProximity_m); }
)";

constexpr const char* kMarkVertex = R"(
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec4 paint;
uniform mat4 view_projection;
out vec3 mark_normal;
out vec4 mark_paint;
out vec3 world;
void main() {
  mark_normal = normal;
  mark_paint = paint;
  world = position;
  gl_Position = view_projection * vec4(position, 1.0);
}
)";

constexpr const char* kMarkFragment = R"(
in vec3 mark_normal;
in vec4 mark_paint;
in vec3 world;
out vec4 colour;
uniform vec3 eye;
uniform vec3 to_light;
uniform float opacity;
void main() {
  vec3 base = linear(mark_paint.rgb);
  if (dot(mark_normal, mark_normal) > 0.0) {
    vec3 normal = normalize(mark_normal);
    float key = max(dot(normal, to_light), 0.0);
    base = base * (0.62 + 0.4 * key + 0.1 * normal.z) +
           0.12 * pow(max(dot(normal, normalize(to_light + normalize(eye - world))), 0.0), 40.0);
  }
  colour = vec4(srgb(base), mark_paint.a * opacity);
}
)";

std::string proximity_constant() { return fmt::format("const float kProximity_m = {:.6f};\n", kProximity_m); }

}  // namespace

ShaderSources background_shader() {
  return {std::string(kVersion) + kBackgroundVertex, std::string(kVersion) + kBackgroundFragment};
}

ShaderSources surface_shader() {
  return {std::string(kVersion) + kModelVertex,
          kVersion + proximity_constant() + kColours + kSurfaceFragment};
}

ShaderSources depth_shader() {
  return {std::string(kVersion) + kModelVertex, std::string(kVersion) + kDepthFragment};
}

ShaderSources proximity_shader() {
  return {std::string(kVersion) + kModelVertex, kVersion + proximity_constant() + kProximityFragment};
}

ShaderSources mark_shader() {
  return {std::string(kVersion) + kMarkVertex, std::string(kVersion) + kColours + kMarkFragment};
}

}  // namespace koboshi::view
