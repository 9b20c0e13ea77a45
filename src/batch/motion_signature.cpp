#include "batch/motion_signature.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "retarget/human_poser.h"

namespace retarget {
namespace {

using Eigen::Vector3d;
using Vectors = std::array<Vector3d, kSignatureVectors>;

constexpr double kFullScale = 127.0;
constexpr double kFastest = 4.0;             // Leg lengths per second, at full scale.
constexpr double kDegreesOfVelocity = 20.0;  // Difference that equals a leg length per second.
constexpr double kFrameRate = 30.0;          // Approximate sampling rate of the frames.
constexpr std::size_t kUp = 8, kVelocity = 9;
constexpr double kBlock = 2.0;  // Seconds per compared block.
constexpr double kShiftStep = 1.0 / 24.0;
// Share of the shorter signature that must overlap.
constexpr double kOverlap = 0.7;

constexpr std::array<std::pair<LimbBone, LimbBone>, 4> kSegments = {
    {{LimbBone::kUpLeg, LimbBone::kLeg},
     {LimbBone::kLeg, LimbBone::kFoot},
     {LimbBone::kArm, LimbBone::kForeArm},
     {LimbBone::kForeArm, LimbBone::kHand}}};

Vector3d unit(const Vector3d& v) {
  const double length = v.norm();
  return length > 1e-9 ? Vector3d(v / length) : Vector3d::Zero();
}

// Limb directions of a body in one frame.
class BodyView {
 public:
  BodyView(const Clip& clip, const Calibration& calibration)
      : poser_(clip, calibration), info_(poser_.info()) {}

  struct Look {
    Vectors vectors;  // All except the velocity.
    Vector3d hips;
    Eigen::Matrix3d world_from_pelvis;
    double leg = 0.0;
  };

  [[nodiscard]] Look look(int frame) {
    poser_.pose(frame, pose_);
    Look look;
    const Vector3d left = at(Bone::kLeftUpLeg), right = at(Bone::kRightUpLeg);
    look.hips = 0.5 * (left + right);
    const Vector3d y = unit(left - right);
    Vector3d z = top() - look.hips;
    z = unit(z - y * y.dot(z));
    look.world_from_pelvis << y.cross(z), y, z;
    for (Vector3d& vector : look.vectors) vector.setZero();
    for (std::size_t i = 0; i < kSegments.size(); ++i) {
      for (std::size_t side = 0; side < 2; ++side) {
        const Bone from = side_bone(kSides[side], kSegments[i].first);
        const Bone to = side_bone(kSides[side], kSegments[i].second);
        if (!info_.has(from) || !info_.has(to)) continue;
        const Vector3d line = at(to) - at(from);
        look.vectors[2 * i + side] = look.world_from_pelvis.transpose() * unit(line);
        if (i < 2) look.leg += 0.5 * line.norm();
      }
    }
    look.vectors[kUp] = look.world_from_pelvis.row(2).transpose();
    return look;
  }

 private:
  [[nodiscard]] Vector3d at(Bone bone) const { return pose_[bone].translation; }

  [[nodiscard]] Vector3d top() const {
    if (info_.has(Bone::kLeftArm) && info_.has(Bone::kRightArm)) {
      return 0.5 * (at(Bone::kLeftArm) + at(Bone::kRightArm));
    }
    for (const Bone bone : {Bone::kNeck, Bone::kSpine2, Bone::kSpine1, Bone::kSpine}) {
      if (info_.has(bone)) return at(bone);
    }
    return pose_[Bone::kHips] * Vector3d::UnitZ();
  }

  HumanPoser poser_;
  HumanClipInfo info_;
  HumanPose pose_;
};

std::int8_t number_of(double value) {
  return static_cast<std::int8_t>(
      std::lround(std::clamp(value * kFullScale, -kFullScale, kFullScale)));
}

// Evenly spaced samples of a body, with its velocity.
struct Looks {
  std::vector<Vectors> vectors;
  double pause = 0.0;  // Seconds between two samples.
};

Looks looks_of(const Clip& clip, const Calibration& calibration, int begin, int end) {
  const double fps = clip.rate().fps();
  const int step = std::max(1, static_cast<int>(std::lround(fps / kFrameRate)));
  const int last = std::min(end, begin + 1 + static_cast<int>(std::ceil(kSignatureMaxTime * fps)));
  BodyView body(clip, calibration);
  Looks looks;
  looks.pause = step / fps;
  std::vector<BodyView::Look> seen;
  for (int frame = begin; frame < last; frame += step) seen.push_back(body.look(frame));
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const std::size_t before = i == 0 ? 0 : i - 1, after = std::min(i + 1, seen.size() - 1);
    if (after > before && seen[i].leg > 0.0) {
      const double time = static_cast<double>(after - before) * looks.pause * seen[i].leg;
      seen[i].vectors[kVelocity] = seen[i].world_from_pelvis.transpose() *
                                   (seen[after].hips - seen[before].hips) / (time * kFastest);
    }
    looks.vectors.push_back(seen[i].vectors);
  }
  return looks;
}

// Appends the weighted mean around a time.
void add_sample(const Looks& looks, double time, std::vector<std::int8_t>& samples) {
  Vectors sum;
  for (Vector3d& vector : sum) vector.setZero();
  double weights = 0.0;
  const double first = std::max(0.0, (time - kSignatureWindow) / looks.pause);
  for (auto i = static_cast<std::size_t>(std::ceil(first)); i < looks.vectors.size(); ++i) {
    const double behind = static_cast<double>(i) * looks.pause - time, away = std::abs(behind);
    if (behind > kSignatureWindow) break;
    // Rounding matters if the window begins exactly at a frame.
    if (away > kSignatureWindow) continue;
    const double weight = kSignatureWindow - away + 1e-3;
    weights += weight;
    for (std::size_t j = 0; j < kSignatureVectors; ++j) sum[j] += weight * looks.vectors[i][j];
  }
  // At low frame rates the window may be empty.
  if (weights == 0.0) {
    const auto nearest = static_cast<std::size_t>(std::lround(time / looks.pause));
    sum = looks.vectors[std::min(nearest, looks.vectors.size() - 1)];
    weights = 1.0;
  }
  for (const Vector3d& vector : sum) {
    for (int axis = 0; axis < 3; ++axis) samples.push_back(number_of(vector[axis] / weights));
  }
}

// Interpolates samples with Catmull-Rom cubics; the end samples are repeated.
class Reader {
 public:
  explicit Reader(const MotionSignature& signature)
      : samples_(signature.samples), last_(static_cast<int>(signature.count()) - 1) {}

  void read(double place, std::array<double, kSignatureNumbers>& numbers) const {
    const int at = std::clamp(static_cast<int>(std::floor(place)), 0, std::max(0, last_ - 1));
    const double t = place - at, t2 = t * t, t3 = t2 * t;
    const std::array<double, 4> weights = {0.5 * (-t3 + 2.0 * t2 - t),
                                           0.5 * (3.0 * t3 - 5.0 * t2 + 2.0),
                                           0.5 * (-3.0 * t3 + 4.0 * t2 + t), 0.5 * (t3 - t2)};
    numbers.fill(0.0);
    for (int i = 0; i < 4; ++i) {
      const auto from =
          static_cast<std::size_t>(std::clamp(at + i - 1, 0, last_)) * kSignatureNumbers;
      for (std::size_t j = 0; j < kSignatureNumbers; ++j) {
        numbers[j] += weights[static_cast<std::size_t>(i)] * samples_[from + j];
      }
    }
  }

  [[nodiscard]] int last() const { return last_; }

 private:
  const std::vector<std::int8_t>& samples_;
  int last_;
};

// Mean square difference of two samples, degrees^2.
double difference(const std::int8_t* a, const std::array<double, kSignatureNumbers>& b) {
  constexpr double kDegrees = 180.0 / std::numbers::pi;
  double limbs = 0.0, velocity = 0.0;
  for (std::size_t j = 0; j < kSignatureNumbers; ++j) {
    const double apart = (a[j] - b[j]) / kFullScale;
    (j < 3 * kVelocity ? limbs : velocity) += apart * apart;
  }
  const double scale = kFastest * kDegreesOfVelocity;
  return limbs * kDegrees * kDegrees / kVelocity + velocity * scale * scale;
}

// Largest mean square difference of a block, with b shifted by a number of samples. Stops once it
// exceeds the bound (degrees^2).
double worst_block(const MotionSignature& a, const Reader& b, double shift, double bound) {
  const int count = static_cast<int>(a.count());
  const auto block = static_cast<int>(kBlock * kSignatureRate);
  constexpr double kEdge = 1e-9;
  double sum = 0.0, worst = 0.0;
  int in_block = 0, beside = 0;
  std::array<double, kSignatureNumbers> numbers{};
  for (int i = 0; i < count; ++i) {
    const double place = i + shift;
    if (place < -kEdge || place > b.last() + kEdge) continue;
    b.read(place, numbers);
    sum += difference(a.samples.data() + static_cast<std::size_t>(i) * kSignatureNumbers, numbers);
    ++beside;
    if (++in_block < block) continue;
    worst = std::max(worst, sum / in_block);
    if (worst > bound) return worst;
    sum = 0.0;
    in_block = 0;
  }
  // A short remainder alone is not significant.
  if (in_block > 0 && (in_block >= block / 2 || beside == in_block)) {
    worst = std::max(worst, sum / in_block);
  }
  const bool enough = beside >= kOverlap * std::min(count, b.last() + 1);
  return enough ? worst : std::numeric_limits<double>::infinity();
}

}  // namespace

std::size_t MotionSignature::count() const {
  return samples.size() / kSignatureNumbers;
}

MotionSignature motion_signature(const Clip& clip, const Calibration& calibration, int begin,
                                 int end) {
  MotionSignature signature;
  if (end <= begin) return signature;
  signature.seconds = (end - begin - 1) / clip.rate().fps();
  const Looks looks = looks_of(clip, calibration, begin, end);
  const double time = std::min(signature.seconds, kSignatureMaxTime);
  // A truncated window at the ends would make the samples depend on where the clip was cut.
  if (time < 4.0 * kSignatureWindow) {
    add_sample(looks, 0.5 * time, signature.samples);
    return signature;
  }
  constexpr double kEdge = 1e-9;
  for (int i = 0; kSignatureWindow + i / kSignatureRate <= time - kSignatureWindow + kEdge; ++i) {
    add_sample(looks, kSignatureWindow + i / kSignatureRate, signature.samples);
  }
  return signature;
}

MotionSignature mirrored(const MotionSignature& signature) {
  MotionSignature image = signature;
  for (std::size_t i = 0; i < signature.samples.size(); ++i) {
    const std::size_t sample = i / kSignatureNumbers, vector = i % kSignatureNumbers / 3;
    const std::size_t mate = vector < kUp ? vector ^ 1U : vector;
    const std::int8_t number = signature.samples[sample * kSignatureNumbers + 3 * mate + i % 3];
    image.samples[i] = i % 3 == 1 ? static_cast<std::int8_t>(-number) : number;
  }
  return image;
}

double signature_tolerance(double seconds) {
  return 0.4 + 0.01 * seconds;
}

double signature_distance(const MotionSignature& a, const MotionSignature& b, double limit) {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  if (a.samples.empty() || b.samples.empty()) return kNever;
  if (std::abs(a.seconds - b.seconds) > signature_tolerance(std::max(a.seconds, b.seconds))) {
    return kNever;
  }
  const Reader reader(b);
  constexpr auto kSteps = static_cast<int>(kSignatureMaxShift / kShiftStep);
  double best = limit * limit;
  std::optional<int> best_step;
  const auto at = [&](double step) {
    return worst_block(a, reader, step * kShiftStep * kSignatureRate, best);
  };
  for (int step = -kSteps; step <= kSteps; ++step) {
    const double found = at(step);
    if (found >= best) continue;
    best = found;
    best_step = step;
  }
  if (!best_step) return kNever;
  double fine = *best_step;
  for (const double finer : {0.5, 0.25}) {
    for (const double step : {fine - finer, fine + finer}) {
      const double found = at(step);
      if (found >= best) continue;
      best = found;
      fine = step;
    }
  }
  return std::sqrt(best);
}

std::string signature_bytes(const MotionSignature& signature) {
  if (signature.samples.empty()) return {};
  // Milliseconds, least significant byte first on every machine.
  auto time = static_cast<std::uint32_t>(std::clamp(
      signature.seconds * 1000.0, 0.0, double{std::numeric_limits<std::uint32_t>::max()}));
  std::string bytes;
  for (int i = 0; i < 4; ++i, time >>= 8U) bytes += static_cast<char>(time & 255U);
  bytes.append(signature.samples.begin(), signature.samples.end());
  return bytes;
}

MotionSignature signature_from_bytes(std::string_view bytes) {
  constexpr std::size_t kTime = 4;
  MotionSignature signature;
  if (bytes.size() <= kTime || (bytes.size() - kTime) % kSignatureNumbers != 0) return signature;
  std::uint32_t time = 0;
  for (std::size_t i = kTime; i-- > 0;) time = time << 8U | static_cast<unsigned char>(bytes[i]);
  signature.seconds = time / 1000.0;
  for (const char byte : bytes.substr(kTime)) {
    signature.samples.push_back(static_cast<std::int8_t>(byte));
  }
  return signature;
}

}  // namespace retarget
