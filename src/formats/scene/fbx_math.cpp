// The functions of <math.h> that ufbx calls (UFBX_EXTERNAL_MATH). Functions that C libraries round
// differently use our portable implementations, so that a file gives the same motion on every
// machine.

#include <cmath>

#include "retarget/trigonometry.h"

namespace {

using retarget::portable::sin_cos;

// base^exponent for an exponent in [0, 1], with one square root per binary digit of the exponent.
double root_power(double base, double exponent) {
  constexpr int kDigits = 53;
  double power = 1.0;
  for (int digit = 0; digit < kDigits && exponent > 0.0; ++digit) {
    base = std::sqrt(base);
    exponent *= 2.0;
    if (exponent < 1.0) continue;
    exponent -= 1.0;
    power *= base;
  }
  return power;
}

}  // namespace

extern "C" {

double ufbx_sqrt(double x) {
  return std::sqrt(x);
}
double ufbx_sin(double x) {
  return sin_cos(x).sine;
}
double ufbx_cos(double x) {
  return sin_cos(x).cosine;
}
double ufbx_tan(double x) {
  return sin_cos(x).sine / sin_cos(x).cosine;
}
double ufbx_asin(double x) {
  return retarget::portable::atan2(x, std::sqrt((1.0 - x) * (1.0 + x)));
}
double ufbx_acos(double x) {
  return retarget::portable::atan2(std::sqrt((1.0 - x) * (1.0 + x)), x);
}
double ufbx_atan(double x) {
  return retarget::portable::atan2(x, 1.0);
}
double ufbx_atan2(double y, double x) {
  return retarget::portable::atan2(y, x);
}
// ufbx calls this for a layer's weight, which is in [0, 1]; other exponents are clamped.
double ufbx_pow(double base, double exponent) {
  if (!(exponent > 0.0)) return 1.0;
  return exponent < 1.0 ? root_power(base, exponent) : base;
}
double ufbx_fmin(double a, double b) {
  return std::fmin(a, b);
}
double ufbx_fmax(double a, double b) {
  return std::fmax(a, b);
}
double ufbx_fabs(double x) {
  return std::fabs(x);
}
double ufbx_copysign(double x, double y) {
  return std::copysign(x, y);
}
double ufbx_nextafter(double x, double y) {
  return std::nextafter(x, y);
}
double ufbx_rint(double x) {
  return std::rint(x);
}
double ufbx_floor(double x) {
  return std::floor(x);
}
double ufbx_ceil(double x) {
  return std::ceil(x);
}
int ufbx_isnan(double x) {
  return std::isnan(x) ? 1 : 0;
}

}  // extern "C"
