#include "solve/ik/task_batch.h"

#include <cmath>
#include <cstddef>

#include "base/math/simd.h"
#include "retarget/trigonometry.h"

namespace retarget {
namespace {

constexpr int kTasksTogether = TaskBatch::kLanes;
// Small-angle thresholds of the published method; see published_jacobian_inverse().
constexpr double kSmallAngleSquared = 1e-10;
constexpr double kNoRotation = 1e-10;
// Angle (0.02 rad, squared) above which the sine and cosine may come from the quaternion. Below it,
// the rounding error of the closed forms depends on the last bit of the sine, so that both engines
// must compute it in the same way.
constexpr double kPlainAngleSquared = 4e-4;

// Vectors without Eigen, whose expressions do not vectorise over tasks.
struct Triple {
  double x, y, z;
};

RETARGET_INLINE Triple operator+(const Triple& a, const Triple& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
RETARGET_INLINE Triple operator-(const Triple& a, const Triple& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
RETARGET_INLINE Triple operator*(double s, const Triple& a) {
  return {s * a.x, s * a.y, s * a.z};
}
RETARGET_INLINE double dot(const Triple& a, const Triple& b) {
  return a.x * b.x + (a.y * b.y + a.z * b.z);
}
RETARGET_INLINE Triple cross(const Triple& a, const Triple& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

struct Quaternion {
  Triple vec;
  double w;
};

RETARGET_INLINE Quaternion operator*(const Quaternion& a, const Quaternion& b) {
  return {a.w * b.vec + b.w * a.vec + cross(a.vec, b.vec), a.w * b.w - dot(a.vec, b.vec)};
}
RETARGET_INLINE Triple rotated(const Quaternion& q, const Triple& v) {
  const Triple twice = 2.0 * cross(q.vec, v);
  return v + q.w * twice + cross(q.vec, twice);
}

// A 3x3 matrix by columns.
struct Columns {
  Triple x, y, z;
};

RETARGET_INLINE Columns operator+(const Columns& a, const Columns& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
RETARGET_INLINE Columns operator*(double s, const Columns& a) {
  return {s * a.x, s * a.y, s * a.z};
}
RETARGET_INLINE Triple operator*(const Columns& a, const Triple& v) {
  return v.x * a.x + v.y * a.y + v.z * a.z;
}
RETARGET_INLINE Triple transposed_times(const Columns& a, const Triple& v) {
  return {dot(a.x, v), dot(a.y, v), dot(a.z, v)};
}
RETARGET_INLINE Columns outer(const Triple& a, const Triple& b) {
  return {b.x * a, b.y * a, b.z * a};
}
RETARGET_INLINE Columns skew_columns(const Triple& a) {
  return {{0.0, a.z, -a.y}, {-a.z, 0.0, a.x}, {a.y, -a.x, 0.0}};
}
RETARGET_INLINE Columns diagonal(double s) {
  return {{s, 0.0, 0.0}, {0.0, s, 0.0}, {0.0, 0.0, s}};
}

// One task of a block.
struct Lane {
  double* first;

  RETARGET_INLINE double get(int row) const { return first[row * kTasksTogether]; }
  RETARGET_INLINE Triple triple(int row) const { return {get(row), get(row + 1), get(row + 2)}; }
  RETARGET_INLINE Quaternion quaternion(int row) const { return {triple(row), get(row + 3)}; }
  RETARGET_INLINE void set(int row, double value) const { first[row * kTasksTogether] = value; }
  RETARGET_INLINE void set(int row, const Triple& value) const {
    set(row, value.x);
    set(row + 1, value.y);
    set(row + 2, value.z);
  }
  RETARGET_INLINE void set(int row, const Columns& value) const {
    set(row, value.x);
    set(row + 3, value.y);
    set(row + 6, value.z);
  }
  RETARGET_INLINE void set_symmetric(int row, const Columns& value) const {
    set(row, value.x);
    set(row + 3, value.y.y);
    set(row + 4, value.y.z);
    set(row + 5, value.z.z);
  }
};

// The error of a task, without branches. The rotation from the body to the target in world axes is
// the quaternion of q and -q with w >= 0.
RETARGET_INLINE void measure_lane(const Lane& lane, const Triple& origin) {
  using Row = TaskBatch::Row;
  const Quaternion link = lane.quaternion(Row::kLink);
  const Quaternion body = link * lane.quaternion(Row::kBody);
  const Triple place = lane.triple(Row::kLink + 4) + rotated(link, lane.triple(Row::kBody + 4));
  lane.set(Row::kLever, place - origin);

  const Triple offset = lane.triple(Row::kTarget + 4) - place;
  const Quaternion turn = lane.quaternion(Row::kTarget) * Quaternion{-1.0 * body.vec, body.w};
  const double w = std::abs(turn.w);
  const double n = std::sqrt(dot(turn.vec, turn.vec));
  const bool turned = n >= kNoRotation;
  const double whole_angle = 2.0 * portable::first_quadrant_angle(n, w);
  const double angle = turned ? whole_angle : 0.0;
  const double angular_scale = std::copysign(angle, turn.w) / n;
  const Triple angular = (turned ? angular_scale : 0.0) * turn.vec;
  const double squared = angle * angle;
  // V^-1 of the logarithm. Sine and cosine of half the angle are n and w.
  const double second_beyond = (1.0 - 0.5 * angle * w / n) / squared;
  const double second = squared < kSmallAngleSquared ? 1.0 / 12.0 : second_beyond;
  const Triple once = cross(angular, offset);
  const Triple linear = offset - 0.5 * once + second * cross(angular, once);

  lane.set(Row::kLinear, linear);
  lane.set(Row::kAngular, angular);
  lane.set(Row::kSquaredAngle, squared);
  lane.set(Row::kHalfSine, turned ? n : 0.0);
  lane.set(Row::kHalfCosine, turned ? w : 1.0);
  const double squared_linear = dot(linear, linear);
  lane.set(Row::kSquaredLinear, squared_linear);
  lane.set(Row::kSquaredError, squared_linear + squared);
}

// Functions of the angle: A = I - half W + beta W^2 and A'A = I + gamma (w w' - |w|^2 I) with
// W = skew(w); b, c and d are those of coupling(). Below the small angle, A is I and Q is 0.
struct AngleTerms {
  double half, beta, gamma, b, c, d;
};

RETARGET_INLINE AngleTerms angle_terms(double squared, double half_sine, double half_cosine) {
  const double angle = std::sqrt(squared);
  const portable::SineCosine computed = portable::sin_cos_of_small(angle);
  const bool plain = squared > kPlainAngleSquared;
  const double sine = plain ? 2.0 * half_sine * half_cosine : computed.sine;
  const double cosine = plain ? 1.0 - 2.0 * half_sine * half_sine : computed.cosine;
  const double fourth = squared * squared;
  const double beta = (1.0 - angle * sine / (2.0 * (1.0 - cosine))) / squared;
  const double gamma = 2.0 * beta - 0.25 - beta * beta * squared;
  const double b = (angle - sine) / (squared * angle);
  const double c = (1.0 - 0.5 * squared - cosine) / fourth;
  const double d = (2.0 * angle - 3.0 * sine + angle * cosine) / (2.0 * fourth * angle);
  const bool small = squared < kSmallAngleSquared;
  return {small ? 0.0 : 0.5, small ? 0.0 : beta, small ? 0.0 : gamma,
          small ? 0.0 : b,   small ? 0.0 : c,    small ? 0.0 : d};
}

// The matrix Q A. Let s = v.w and V = skew(v). With V W = w v' - s I and W V W = -s W, Barfoot's
// Q(v, w) simplifies to
//   Q = (1/2 + c theta^2) V - s (b + 2c) W + b (v w' + w v') - 2 d s w w' + 2 s (d theta^2 - b) I
//   b = (theta - sin)/theta^3, c = (1 - theta^2/2 - cos)/theta^4,
//   d = (2 theta - 3 sin + theta cos)/(2 theta^5)
// and Q A = Q - 1/2 Q W + beta (Q w w' - theta^2 Q).
RETARGET_INLINE Columns coupling(const AngleTerms& of, double squared, const Triple& v,
                                 const Triple& w) {
  const double s = dot(v, w);
  const Triple turned = (of.half + of.c * squared) * v - (s * (of.b + 2.0 * of.c)) * w;
  const Triple left = of.b * v - (2.0 * of.d * s) * w;
  const Columns q = outer(left, w) + outer(of.b * w, v) + skew_columns(turned) +
                    diagonal(2.0 * s * (of.d * squared - of.b));
  // Q W by columns: its rows are q x w.
  const Columns qw_cross = {w.z * q.y - w.y * q.z, w.x * q.z - w.z * q.x, w.y * q.x - w.x * q.y};
  return (1.0 - of.beta * squared) * q + outer(of.beta * (q * w), w) + (-0.5) * qw_cross;
}

RETARGET_INLINE void build_lane(const Lane& lane, double position_weight, double rotation_weight) {
  using Row = TaskBatch::Row;
  const Triple v = lane.triple(Row::kLinear), w = lane.triple(Row::kAngular);
  const double squared = lane.get(Row::kSquaredAngle);
  const AngleTerms of = angle_terms(squared, lane.get(Row::kHalfSine), lane.get(Row::kHalfCosine));
  const Columns G = outer(of.gamma * w, w) + diagonal(1.0 - of.gamma * squared);

  // The rate of the linear part of the error is -A (v - K u), where K = skew(lever) + Q A, and v
  // and u are the linear velocity at the base's origin and the angular velocity of the link.
  const Columns K = skew_columns(lane.triple(Row::kLever)) + coupling(of, squared, v, w);
  const Columns GK = {G * K.x, G * K.y, G * K.z};
  const Columns KtGK = {transposed_times(K, GK.x), transposed_times(K, GK.y),
                        transposed_times(K, GK.z)};
  const Triple once = cross(w, v);
  const Triple pull = position_weight * (v + of.half * once + of.beta * cross(w, once));

  lane.set_symmetric(Row::kFormLinear, position_weight * G);
  lane.set(Row::kFormMixed, -position_weight * GK);
  lane.set_symmetric(Row::kFormAngular, rotation_weight * G + position_weight * KtGK);
  lane.set(Row::kForce, -1.0 * pull);
  lane.set(Row::kTorque, transposed_times(K, pull) - rotation_weight * w);
}

RETARGET_INLINE void measure_blocks_plain(TaskBatch::Block* blocks, std::size_t count,
                                          Triple origin) {
  for (std::size_t block = 0; block < count; ++block) {
    double* const values = blocks[block].data();
    for (int lane = 0; lane < kTasksTogether; ++lane) measure_lane({values + lane}, origin);
  }
}
RETARGET_AVX2(measure_blocks)

RETARGET_INLINE void build_blocks_plain(TaskBatch::Block* blocks, std::size_t count,
                                        const double* __restrict position_weights,
                                        const double* __restrict rotation_weights) {
  for (std::size_t block = 0; block < count; ++block) {
    double* const values = blocks[block].data();
    const std::size_t first = block * kTasksTogether;
    for (int lane = 0; lane < kTasksTogether; ++lane) {
      build_lane({values + lane}, position_weights[first + lane], rotation_weights[first + lane]);
    }
  }
}
RETARGET_AVX2(build_blocks)

}  // namespace

TaskBatch::TaskBatch(std::span<const Pose> link_from_body)
    : blocks_((link_from_body.size() + kTasksTogether - 1) / kTasksTogether, Block{}) {
  for (int task = 0; task < static_cast<int>(blocks_.size()) * kTasksTogether; ++task) {
    set_link(task, Pose{});
    set_target(task, Pose{});
    const bool used = task < static_cast<int>(link_from_body.size());
    set_pose(kBody, task, used ? link_from_body[task] : Pose{});
  }
}

TaskBatch::Weights TaskBatch::zero_weights() const {
  const std::vector<double> none(blocks_.size() * kTasksTogether, 0.0);
  return {none, none};
}

void TaskBatch::set_pose(int first_row, int task, const Pose& pose) {
  double* const first =
      &blocks_[task / kTasksTogether][first_row * kTasksTogether + task % kTasksTogether];
  for (int i = 0; i < 4; ++i) first[i * kTasksTogether] = pose.rotation.coeffs()[i];
  for (int i = 0; i < 3; ++i) first[(4 + i) * kTasksTogether] = pose.translation[i];
}

void TaskBatch::set_target(int task, const Pose& world_from_target) {
  set_pose(kTarget, task, world_from_target);
}

void TaskBatch::set_link(int task, const Pose& world_from_link) {
  set_pose(kLink, task, world_from_link);
}

void TaskBatch::measure(const Eigen::Vector3d& origin) {
  const Triple about{origin.x(), origin.y(), origin.z()};
  measure_blocks(has_avx2(), blocks_.data(), blocks_.size(), about);
}

void TaskBatch::build_forms(const Weights& weights) {
  build_blocks(has_avx2(), blocks_.data(), blocks_.size(), weights.position.data(),
               weights.rotation.data());
}

void TaskBatch::add_form(int task, Composite& composite) const {
  const double* const first = &blocks_[task / kTasksTogether][task % kTasksTogether];
  const auto add_symmetric = [first](int row, Eigen::Matrix3d& matrix) {
    for (int column = 0, entry = row; column < 3; ++column) {
      for (int i = column; i < 3; ++i, ++entry) {
        const double value = first[entry * kTasksTogether];
        matrix(i, column) += value;
        if (i != column) matrix(column, i) += value;
      }
    }
  };
  add_symmetric(kFormLinear, composite.linear);
  add_symmetric(kFormAngular, composite.angular);
  for (int i = 0; i < 9; ++i) composite.mixed.data()[i] += first[(kFormMixed + i) * kTasksTogether];
  for (int i = 0; i < 3; ++i) {
    composite.force[i] += first[(kForce + i) * kTasksTogether];
    composite.torque[i] += first[(kTorque + i) * kTasksTogether];
  }
}

}  // namespace retarget
