#include "studio/controls/terrain.h"

#include <QtGlobal>

#include <fmt/format.h>

#include "firmware/fixed/contract.h"

namespace koboshi::studio {
namespace {

using Kind = Terrain::Kind;

constexpr std::array<Terrain, 7> kTerrains{{
    {.name = QT_TRANSLATE_NOOP("Terrain", "of the scenario")},
    {.kind = Kind::kPlane, .name = QT_TRANSLATE_NOOP("Terrain", "plane")},
    {.kind = Kind::kMat,
     .name = QT_TRANSLATE_NOOP("Terrain", "mat"),
     .value = QT_TRANSLATE_NOOP("Terrain", "Height"),
     .unit = "mm",
     .lowest = 0.5,
     .highest = 50.0,
     .usual = 2.0,
     .decimals = 1},
    {.kind = Kind::kSteps,
     .name = QT_TRANSLATE_NOOP("Terrain", "steps"),
     .value = QT_TRANSLATE_NOOP("Terrain", "Rise"),
     .unit = "mm",
     .lowest = 0.5,
     .highest = 50.0,
     .usual = 2.0,
     .decimals = 1},
    {.kind = Kind::kRamp,
     .name = QT_TRANSLATE_NOOP("Terrain", "ramp"),
     .value = QT_TRANSLATE_NOOP("Terrain", "Angle"),
     .unit = "°",
     .lowest = 0.5,
     .highest = 20.0,
     .usual = 2.0,
     .decimals = 1},
    {.kind = Kind::kSlippery,
     .name = QT_TRANSLATE_NOOP("Terrain", "slippery patch"),
     .value = QT_TRANSLATE_NOOP("Terrain", "Its friction"),
     .unit = "",
     .lowest = 0.05,
     .highest = 1.0,
     .usual = 0.3,
     .decimals = 2},
    {.kind = Kind::kRough,
     .name = QT_TRANSLATE_NOOP("Terrain", "rough"),
     .value = QT_TRANSLATE_NOOP("Terrain", "Height"),
     .unit = "mm",
     .lowest = 0.5,
     .highest = 30.0,
     .usual = 2.0,
     .decimals = 1},
}};

constexpr double kStart_m = 0.3;
constexpr double kWidth_m = 1.0;

}  // namespace

const std::array<Terrain, 7>& terrains() { return kTerrains; }

std::string terrain_shapes(Kind kind, double value) {
  switch (kind) {
    case Kind::kPlane:
      return "[]";
    case Kind::kMat:
      return fmt::format("[{{box: {{position_m: [{}, 0], size_m: [1, {}, {:.5f}]}}}}]", kStart_m + 0.5,
                         kWidth_m, 1e-3 * value);
    case Kind::kSteps:
      return fmt::format(
          "[{{steps: {{position_m: [{}, 0], count: 4, rise_m: {:.5f}, run_m: 0.2, width_m: {}}}}}]", kStart_m,
          1e-3 * value, kWidth_m);
    case Kind::kRamp:
      return fmt::format("[{{ramp: {{position_m: [{}, 0], length_m: 1, width_m: {}, angle_deg: {:.2f}}}}}]",
                         kStart_m, kWidth_m, value);
    case Kind::kSlippery:
      return fmt::format("[{{patch: {{position_m: [{}, 0], size_m: [0.5, {}], friction: {:.3f}}}}}]",
                         kStart_m + 0.25, kWidth_m, value);
    case Kind::kRough:
      return fmt::format(
          "[{{height_field: {{position_m: [{}, 0], size_m: [1, {}], height_m: {:.5f}, wavelength_m: 0.1}}}}]",
          kStart_m + 0.5, kWidth_m, 1e-3 * value);
    case Kind::kScenario:
      break;
  }
  KOBOSHI_ASSERT(false);
  return {};
}

}  // namespace koboshi::studio
