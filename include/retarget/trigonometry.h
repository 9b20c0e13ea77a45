#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "retarget/export.h"

/// Sine, cosine and arc tangent from a few basic operations, so that results are bitwise identical
/// on every machine. C libraries select code by processor (glibc has a separate version for fused
/// multiply-add), and these versions differ in the last place.
///
/// Errors stay below 2 units in the last place (3 for the sine of angles above 100). Polynomials
/// and constants come from Sun's fdlibm (k_sin.c, k_cos.c, s_atan.c; 1993). Callers must be
/// compiled without contraction of products and sums into fused operations, as the library is.
namespace RETARGET_API retarget {
namespace portable {

struct SineCosine {
  double sine;
  double cosine;
};

/// Sine and cosine of rest + quadrant * pi / 2, with |rest| <= pi / 4 up to rounding. Branch-free,
/// so that compilers vectorise loops over it.
[[nodiscard]] inline SineCosine sin_cos_in_quadrant(double rest, std::uint64_t quadrant) {
  const double square = rest * rest;
  const double sine =
      rest + rest * square *
                 (-1.66666666666666324348e-01 +
                  square * (8.33333333332248946124e-03 +
                            square * (-1.98412698298579493134e-04 +
                                      square * (2.75573137070700676789e-06 +
                                                square * (-2.50507602534068634195e-08 +
                                                          square * 1.58969099521155010221e-10)))));
  const double half = 0.5 * square;
  const double one_less = 1.0 - half;
  // Rounding error of 1 - half.
  const double lost = (1.0 - one_less) - half;
  const double cosine =
      one_less +
      (lost +
       square * square *
           (4.16666666666666019037e-02 +
            square * (-1.38888888888741095749e-03 +
                      square * (2.48015872894767294178e-05 +
                                square * (-2.75573143513906633035e-07 +
                                          square * (2.08757232129817482790e-09 +
                                                    square * -1.13596475577881948265e-11))))));
  const auto sine_bits = std::bit_cast<std::uint64_t>(sine);
  const auto cosine_bits = std::bit_cast<std::uint64_t>(cosine);
  const std::uint64_t swap = (sine_bits ^ cosine_bits) & (0 - (quadrant & 1));
  const std::uint64_t negative_sine = (quadrant & 2) << 62;
  const std::uint64_t negative_cosine = ((quadrant + 1) & 2) << 62;
  return {std::bit_cast<double>((sine_bits ^ swap) ^ negative_sine),
          std::bit_cast<double>((cosine_bits ^ swap) ^ negative_cosine)};
}

/// A double rounded to the nearest integer, ties to even, and this integer modulo 4.
struct Rounded {
  double value;
  std::uint64_t modulo_4;
};

/// @pre |x| < 2^51.
[[nodiscard]] inline Rounded round_to_integer(double x) {
  constexpr double kOneAndAHalfTimes2To52 = 6755399441055744.0;
  const double shifted = x + kOneAndAHalfTimes2To52;
  return {shifted - kOneAndAHalfTimes2To52, std::bit_cast<std::uint64_t>(shifted) & 3};
}

/// Largest angle of sin_cos_of_small, radians.
inline constexpr double kMaxSmallAngle = 1e6;

/// Sine and cosine of an angle in radians. Branch-free, so that compilers vectorise loops over it.
/// @pre |angle| <= kMaxSmallAngle.
[[nodiscard]] inline SineCosine sin_cos_of_small(double angle) {
  // pi / 2 in parts of 33 bits, so that their products with the quadrant are exact.
  constexpr double kFirst = 1.57079632673412561417e+00;
  constexpr double kSecond = 6.07710050630396597660e-11;
  constexpr double kThird = 2.02226624879595063154e-21;
  const auto [quadrant, modulo_4] = round_to_integer(angle * 6.36619772367581382433e-01);
  const double rest = ((angle - quadrant * kFirst) - quadrant * kSecond) - quadrant * kThird;
  return sin_cos_in_quadrant(rest, modulo_4);
}

/// Sine and cosine of an angle in radians. Beyond a million radians, the angle is first reduced by
/// 2 pi rounded to double. NaN if the angle is not finite.
[[nodiscard]] inline SineCosine sin_cos(double angle) {
  if (!(std::abs(angle) <= kMaxSmallAngle)) angle = std::remainder(angle, 6.28318530717958647692);
  if (!(std::abs(angle) <= kMaxSmallAngle)) return {std::nan(""), std::nan("")};
  return sin_cos_of_small(angle);
}

/// Sine and cosine of half an angle in degrees, for rotations of motion files. The reduction is
/// exact.
/// @pre |degrees| < 1e15.
[[nodiscard]] inline SineCosine sin_cos_of_half_degrees(double degrees) {
  constexpr double kRadiansPerHalfDegree = 8.72664625997164788462e-03;
  const auto [quadrant, modulo_4] = round_to_integer(degrees * (1.0 / 180.0));
  return sin_cos_in_quadrant((degrees - 180.0 * quadrant) * kRadiansPerHalfDegree, modulo_4);
}

namespace internal {

// An angle with a known tangent, as a double and its rounding error.
struct KnownAngle {
  double high;
  double low;
};

inline constexpr KnownAngle kAtanHalf = {4.63647609000806093515e-01, 2.26987774529616870924e-17};
inline constexpr KnownAngle kAtanOne = {7.85398163397448278999e-01, 3.06161699786838301793e-17};

// The series atan(t) = t - t * excess(t), for |t| <= 7/16.
inline double excess(double t) {
  constexpr std::array<double, 11> kCoefficients = {
      3.33333333333329318027e-01,  -1.99999999998764832476e-01, 1.42857142725034663711e-01,
      -1.11111104054623557880e-01, 9.09088713343650656196e-02,  -7.69187620504482999495e-02,
      6.66107313738753120669e-02,  -5.83357013379057348645e-02, 4.97687799461593236017e-02,
      -3.65315727442169155270e-02, 1.62858201153657823623e-02};
  const double square = t * t;
  double sum = kCoefficients.back();
  for (std::size_t i = kCoefficients.size() - 1; i > 0; --i) {
    sum = kCoefficients[i - 1] + square * sum;
  }
  return square * sum;
}

// Computes atan(y / x) for 0 <= y <= x, x > 0, as a known angle plus the atan of the tangent of the
// difference.
inline double octant(double y, double x) {
  const bool near_zero = y < 0.4375 * x, near_half = y < 0.6875 * x;
  const double top = near_half ? 2.0 * y - x : y - x;
  const double bottom = near_half ? 2.0 * x + y : y + x;
  const double high = near_half ? kAtanHalf.high : kAtanOne.high;
  const double low = near_half ? kAtanHalf.low : kAtanOne.low;
  const double t = (near_zero ? y : top) / (near_zero ? x : bottom);
  return (near_zero ? 0.0 : high) - ((t * excess(t) - (near_zero ? 0.0 : low)) - t);
}

inline constexpr double kHalfPi = 1.57079632679489655800e+00;
inline constexpr double kHalfPiLow = 6.12323399573676603587e-17;

}  // namespace internal

/// Angle of the point (x, y) from the x axis, radians. Branch-free, so that compilers vectorise
/// loops over it.
/// @pre 0 <= x, y; both in [1e-290, 1e300] or one of them 0.
[[nodiscard]] inline double first_quadrant_angle(double y, double x) {
  const bool steep = y > x;
  const double angle = internal::octant(steep ? x : y, steep ? y : x);
  const double from_y = internal::kHalfPi - (angle - internal::kHalfPiLow);
  return steep ? from_y : angle;
}

/// Angle of the point (x, y) from the x axis, radians, in [-pi, pi]; signs of zeros as in
/// std::atan2. NaN unless both arguments are finite.
[[nodiscard]] inline double atan2(double y, double x) {
  double a = std::abs(y), b = std::abs(x);
  if (!std::isfinite(a) || !std::isfinite(b)) return std::nan("");
  // Sums and doubles of the largest values overflow, and quotients of the smallest values are
  // inexact.
  if (a > 1e300 || b > 1e300) {
    a *= 0x1p-60;
    b *= 0x1p-60;
  } else if (a < 1e-290 && b < 1e-290) {
    a *= 0x1p+600;
    b *= 0x1p+600;
  }
  double angle = a > 0.0 ? first_quadrant_angle(a, b) : 0.0;
  if (std::signbit(x)) angle = 2.0 * internal::kHalfPi - (angle - 2.0 * internal::kHalfPiLow);
  return std::copysign(angle, y);
}

}  // namespace portable
}  // namespace retarget
