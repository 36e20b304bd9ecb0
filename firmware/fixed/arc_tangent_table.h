#pragma once

#include <array>
#include <cstdint>

namespace koboshi::fixed {

// Polynomials for atan over [0, 1], one for each of sixteen segments. Segment i has its centre at (2 i + 1) /
// 32; with the distance d in [-1, 1] from the centre in half segments, the row holds the coefficients of d^0
// to d^4 in a quarter of an LSB of Angle (2^-34 turn). Chebyshev fits with an error of 0.25 LSB.
inline constexpr std::array<std::array<std::int32_t, 5>, 16> kArcTangent = {{
    {85417861, 85362293, -83280, -27632, 81},
    {255589927, 84701211, -245986, -26361, 234},
    {423801562, 83409296, -397566, -23964, 361},
    {588844181, 81543665, -531972, -20696, 450},
    {749645397, 79182221, -644923, -16879, 498},
    {905303124, 76416031, -734128, -12844, 505},
    {1055103973, 73341456, -799194, -8885, 480},
    {1198526605, 70053129, -841311, -5231, 431},
    {1335232527, 66638506, -862799, -2031, 368},
    {1465047826, 63174266, -866651, 639, 300},
    {1587939507, 59724477, -856119, 2765, 233},
    {1703989687, 56340218, -834401, 4377, 171},
    {1813370146, 53060253, -804431, 5529, 118},
    {1916318946, 49912355, -768758, 6292, 74},
    {2013120049, 46914937, -729508, 6736, 38},
    {2104086323, 44078769, -688384, 6929, 11},
}};

}  // namespace koboshi::fixed
