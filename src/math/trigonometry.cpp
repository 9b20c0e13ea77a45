#include "retarget/math/trigonometry.h"

#include <array>

namespace retarget::portable {
namespace {

// an angle whose tangent is known, as a double and what that lacks
struct KnownAngle {
  double high;
  double low;
};

constexpr KnownAngle kAtanHalf = {4.63647609000806093515e-01, 2.26987774529616870924e-17};
constexpr KnownAngle kAtanOne = {7.85398163397448278999e-01, 3.06161699786838301793e-17};

// atan(t) = t - t * excess(t) for |t| <= 7/16
double excess(double t) {
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

// atan(known) + atan(t)
double beyond(const KnownAngle& known, double t) {
  return known.high - ((t * excess(t) - known.low) - t);
}

// atan(y / x) for 0 <= y <= x, x > 0: near a known angle by the tangent of the difference
double octant(double y, double x) {
  if (y < 0.4375 * x) {
    const double t = y / x;
    return t - t * excess(t);
  }
  if (y < 0.6875 * x) return beyond(kAtanHalf, (2.0 * y - x) / (2.0 * x + y));
  return beyond(kAtanOne, (y - x) / (y + x));
}

}  // namespace

double atan2(double y, double x) {
  constexpr double kHalfPi = 1.57079632679489655800e+00;
  constexpr double kHalfPiLow = 6.12323399573676603587e-17;
  double a = std::abs(y), b = std::abs(x);
  if (!std::isfinite(a) || !std::isfinite(b)) return std::nan("");
  // sums and doubles of the largest numbers are no numbers, quotients of the least are inexact
  if (a > 1e300 || b > 1e300) {
    a *= 0x1p-60;
    b *= 0x1p-60;
  } else if (a < 1e-290 && b < 1e-290) {
    a *= 0x1p+600;
    b *= 0x1p+600;
  }
  double angle = 0.0;
  if (a > b) {
    angle = kHalfPi - (octant(b, a) - kHalfPiLow);
  } else if (b > 0.0) {
    angle = octant(a, b);
  }
  if (std::signbit(x)) angle = 2.0 * kHalfPi - (angle - 2.0 * kHalfPiLow);
  return std::copysign(angle, y);
}

}  // namespace retarget::portable
