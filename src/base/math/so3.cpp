#include "retarget/so3.h"

#include <array>
#include <cmath>

#include "retarget/trigonometry.h"

namespace retarget {
namespace {

// Angle below which series replace the closed forms, rad.
constexpr double kSmallAngle = 1e-4;

// Selects one of q and -q: true if the scalar part is negative or, where it is zero, if the first
// non-zero component is negative.
bool is_lower_half(const Eigen::Quaterniond& q) {
  if (q.w() != 0.0) return q.w() < 0.0;
  if (q.x() != 0.0) return q.x() < 0.0;
  if (q.y() != 0.0) return q.y() < 0.0;
  return q.z() < 0.0;
}

// Computes (1 - x/2 cot(x/2)) / x^2. The difference loses 2e-16 to rounding, which leaves an error
// of 2e-16 / x^2 here; a Jacobian multiplies it by x^2. The first neglected term of the series is
// x^6 / 1209600, 6e-16 at the switch.
double inverse_jacobian_coefficient(double angle) {
  constexpr double kSeriesBelow = 0.03;
  if (angle < kSeriesBelow) {
    const double square = angle * angle;
    double sum = 1.0 / 12.0;
    sum += square / 720.0 + square * square / 30240.0;
    return sum;
  }
  const auto [sine, cosine] = portable::sin_cos(0.5 * angle);
  return (1.0 - 0.5 * angle * cosine / sine) / (angle * angle);
}

// The right Jacobian is 1 - a [w] + b [w]^2 with a = (1 - cos x) / x^2 and b = (x - sin x) / x^3 at
// the angle x. The rates are the derivatives of a and b divided by w . dw/dt.
struct RightJacobianTerms {
  double a, b, a_rate, b_rate;
};

constexpr std::size_t kSeriesTerms = 9;
using Series = std::array<double, kSeriesTerms>;  // Coefficients in powers of x^2.

// a is the sum of (-x^2)^k / (2k + 2)!, and b the same with (2k + 3)!. Their derivatives divided by
// x are the sums of -2 (k + 1) (-x^2)^k / (2k + 4)! and the same with (2k + 5)!.
constexpr Series jacobian_series(int shift, bool rate) {
  Series terms{};
  double factorial = 1.0;
  for (int n = 2; n < shift; ++n) factorial *= n;
  double sign = rate ? -1.0 : 1.0;
  for (std::size_t k = 0; k < kSeriesTerms; ++k) {
    const int last = 2 * static_cast<int>(k) + shift;
    factorial *= k == 0 ? last : last * (last - 1);
    terms[k] = sign * (rate ? 2.0 * static_cast<double>(k + 1) : 1.0) / factorial;
    sign = -sign;
  }
  return terms;
}

double sum_of(const Series& terms, double square) {
  double sum = terms.back();
  for (std::size_t k = kSeriesTerms - 1; k-- > 0;) sum = terms[k] + square * sum;
  return sum;
}

// Above the switch, the differences are accurate to 1e-14 of the size of their terms. Below it, the
// first neglected term of the series is 1 / 20! of the first term.
RightJacobianTerms right_jacobian_terms(double angle) {
  constexpr double kSeriesBelow = 1.0;
  static constexpr Series kA = jacobian_series(2, false), kB = jacobian_series(3, false),
                          kARate = jacobian_series(4, true), kBRate = jacobian_series(5, true);
  const double x2 = angle * angle, x4 = x2 * x2;
  if (angle < kSeriesBelow) {
    return {sum_of(kA, x2), sum_of(kB, x2), sum_of(kARate, x2), sum_of(kBRate, x2)};
  }
  const auto [sine, cosine] = portable::sin_cos(angle);
  return {(1.0 - cosine) / x2, (angle - sine) / (x2 * angle),
          (angle * sine - 2.0 * (1.0 - cosine)) / x4,
          (3.0 * sine - angle * cosine - 2.0 * angle) / (x4 * angle)};
}

}  // namespace

Eigen::Quaterniond exp_so3(const Eigen::Vector3d& w) {
  const double angle = w.norm();
  const auto [sine, cosine] = portable::sin_cos(0.5 * angle);
  const double vector_per_angle = angle < kSmallAngle ? 0.5 - angle * angle / 48.0 : sine / angle;
  const Eigen::Vector3d vector = vector_per_angle * w;
  return {cosine, vector.x(), vector.y(), vector.z()};
}

Eigen::Vector3d log_so3(const Eigen::Quaterniond& q) {
  const double sine = q.vec().norm();
  const double cosine = std::abs(q.w());
  double angle_per_vector = 0.0;
  if (sine < 0.5 * kSmallAngle * cosine) {
    const double tangent = sine / cosine;
    angle_per_vector = 2.0 / cosine * (1.0 - tangent * tangent / 3.0);
  } else {
    angle_per_vector = 2.0 * portable::atan2(sine, cosine) / sine;
  }
  const Eigen::Vector3d w = angle_per_vector * q.vec();
  return is_lower_half(q) ? Eigen::Vector3d(-w) : w;
}

Eigen::Matrix3d skew(const Eigen::Vector3d& a) {
  Eigen::Matrix3d matrix;
  matrix << 0.0, -a.z(), a.y(), a.z(), 0.0, -a.x(), -a.y(), a.x(), 0.0;
  return matrix;
}

Eigen::Matrix3d left_jacobian_inverse_so3(const Eigen::Vector3d& w) {
  const Eigen::Matrix3d cross = skew(w);
  return Eigen::Matrix3d::Identity() - 0.5 * cross +
         inverse_jacobian_coefficient(w.norm()) * (cross * cross);
}

Eigen::Vector3d apply_left_jacobian_inverse_so3(const Eigen::Vector3d& w,
                                                const Eigen::Vector3d& v) {
  const Eigen::Vector3d cross = w.cross(v);
  return v - 0.5 * cross + inverse_jacobian_coefficient(w.norm()) * w.cross(cross);
}

Eigen::Matrix3d right_jacobian_so3(const Eigen::Vector3d& w) {
  const RightJacobianTerms terms = right_jacobian_terms(w.norm());
  const Eigen::Matrix3d cross = skew(w);
  return Eigen::Matrix3d::Identity() - terms.a * cross + terms.b * cross * cross;
}

Eigen::Vector3d right_jacobian_rate_so3(const Eigen::Vector3d& w, const Eigen::Vector3d& rate) {
  const RightJacobianTerms terms = right_jacobian_terms(w.norm());
  const double along = w.dot(rate);
  const Eigen::Vector3d cross = w.cross(rate);
  return -terms.a_rate * along * cross + terms.b_rate * along * w.cross(cross) +
         terms.b * rate.cross(cross);
}

Eigen::Quaterniond rotation_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  // 2.6 degrees from opposite directions. Up to there, Eigen's formula is accurate to 1e-13.
  constexpr double kNearlyOpposite = -0.999;
  const Eigen::Vector3d from = a.normalized(), half_way = from + b.normalized();
  const double length = half_way.norm();
  if (!(0.5 * length * length - 1.0 < kNearlyOpposite)) {
    return Eigen::Quaterniond::FromTwoVectors(a, b);
  }
  if (length == 0.0) {
    // Uses Eigen's axis. Its cosine may be off by 2e-16, which is 1e-8 of the angle.
    Eigen::Quaterniond turn = Eigen::Quaterniond::FromTwoVectors(a, b);
    if (turn.w() == 0.0) return turn;
    turn.w() = 0.0;
    return turn.normalized();
  }
  // Composes half a turn about a with half a turn about the direction half way to b. Only the
  // difference of the directions themselves cancels.
  const Eigen::Vector3d middle = half_way / length;
  const Eigen::Vector3d axis = from.cross(middle);
  return Eigen::Quaterniond(0.5 * length, axis.x(), axis.y(), axis.z()).normalized();
}

Eigen::Quaterniond turn_about_vertical(const Eigen::Quaterniond& rotation) {
  constexpr double kTurned = 1e-9;
  const double norm = std::sqrt(rotation.w() * rotation.w() + rotation.z() * rotation.z());
  if (!(norm > kTurned)) return Eigen::Quaterniond::Identity();
  return {rotation.w() / norm, 0.0, 0.0, rotation.z() / norm};
}

double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return portable::atan2(a.cross(b).norm(), a.dot(b));
}

}  // namespace retarget
