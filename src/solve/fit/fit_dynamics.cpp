#include "solve/fit/fit_dynamics.h"

#include <algorithm>
#include <cmath>

#include "retarget/so3.h"
#include "solve/dynamics/ankle_reach.h"
#include "solve/fit/shorthand.h"

namespace retarget {
namespace {

using Eigen::Vector3d;

// Length that makes torques comparable with forces, for a G1; metres. It scales with the leg
// length.
constexpr double kLength = 0.3;
constexpr double kUsualMass = 35.0;  // Mass of a G1, kilograms.
// Share of an ankle's torque limit that the fit plans with in frames with overloaded ankles. The
// rest covers the foot's own motion and the difference between the robot's motion and the plan. An
// ankle is overloaded only above its full limit: with a threshold of 80 %, the G1's foot slip in
// dance1_subject2 rises from 0.98 to 1.07 mm/s.
constexpr double kAnkleShare = 0.7;
// Dead zone of the unexplained wrench where ankle torques limit the pressure, share of the weight.
constexpr double kAnkleDeadZone = 0.004;
// Unexplained wrench above which contacts may be unknown, in body weights.
constexpr double kDoubtful = 0.1;

// By frame: mean over the frames at a distance of at most `reach`. @param sum  zero.
template <typename T>
std::vector<T> means_around(const std::vector<T>& values, int reach, T sum) {
  const auto count = static_cast<int>(values.size());
  std::vector<T> means;
  means.reserve(values.size());
  int frames = 0;
  for (int t = -reach; t < count; ++t) {
    if (t + reach < count) {
      sum += values[at(t + reach)];
      ++frames;
    }
    if (t - reach - 1 >= 0) {
      sum -= values[at(t - reach - 1)];
      --frames;
    }
    if (t >= 0) means.push_back(sum / static_cast<double>(frames));
  }
  return means;
}

}  // namespace

FitDynamics::FitDynamics(const FitModel& model, const FitOptions& options, const FitWindow& window,
                         const FitClip& clip)
    : model_(model),
      options_(options),
      window_(window),
      count_(window.end - window.begin),
      scale_{model.inertias.mass, kLength * model.leg / kUsualLeg, clip.frame_time},
      contacts_(model, options, window, clip),
      inverse_(model.tree, model.inertias),
      map_(model.tree, model.inertias),
      pose_(model.tree),
      frames_(at(count_)),
      headings_(at(count_), Vector3d::UnitX()),
      overload_(at(count_), 0.0),
      com_(at(count_), Vector3d::Zero()),
      first_com_(com_),
      goals_(at(count_), Vector6d::Zero()),
      rest_before_(at(count_), 0.0),
      share_(at(count_), 1.0),
      spin_rows_(3, count_ * model.dof_count()) {
  for (const FitFoot& foot : model.feet) {
    const Vector3d length = foot.ends[1].middle - foot.ends[0].middle;
    sole_normals_.push_back(length.cross(foot.sideways).normalized());
  }
  for (const double limit : model.torque_limit) ankle_torques_.push_back(kAnkleShare * limit);
}

double FitDynamics::begin(const FitClip& clip) {
  read_frames(clip);
  find_trust();
  begun_ = true;
  find_overloaded_ankles();
  return missing_share();
}

double FitDynamics::measure(const FitClip& clip) {
  read_frames(clip);
  return missing_share();
}

bool FitDynamics::is_needed() const {
  for (std::size_t t = 0; t < frames_.size(); ++t) {
    const CentroidalFrame& frame = frames_[t];
    if (frame.trust > 0.0 && step_.unexplained()[t].norm() > frame.dead_zone) return true;
  }
  return false;
}

double FitDynamics::missing_share() const {
  double sum = 0.0;
  for (std::size_t t = 0; t < frames_.size(); ++t) {
    // std::min would hide NaN.
    double missing = step_.unexplained()[t].norm();
    if (missing > 1.0) missing = 1.0;
    sum += frames_[t].trust * missing;
  }
  return sum / count_;
}

bool FitDynamics::plan(const FitClip& clip) {
  constexpr int kFirstSteps = 4, kLaterSteps = 2;  // Iterations of the centroidal step.
  if (planned_) {
    read_frames(clip);
    find_overloaded_ankles();
  }
  std::vector<Vector6d> moves = step_.solve(frames_, scale_, planned_ ? kLaterSteps : kFirstSteps);
  if (step_.has_failed()) return false;
  restrain(moves);
  for (int t = 0; t < count_; ++t) {
    goals_[at(t)].head<3>() = com_[at(t)] + moves[at(t)].head<3>();
    goals_[at(t)].tail<3>() = moves[at(t)].tail<3>();
  }
  planned_ = true;
  return true;
}

bool FitDynamics::has_helped(double before, double now) const {
  constexpr double kWorse = 1.02, kNoise = 1e-3;  // A ratio; a share of the robot's weight.
  constexpr double kMostRemoved = 0.4;            // Share of the unexplained wrench that remains.
  if (now > kWorse * before + kNoise) return false;
  return now <= kMostRemoved * before || !is_mostly_unexplained();
}

// Whether most frames have unknown contacts or a doubtful unexplained wrench.
bool FitDynamics::is_mostly_unexplained() const {
  constexpr double kMost = 0.55;  // Share of the frames.
  int unexplained = 0;
  for (std::size_t t = 0; t < frames_.size(); ++t) {
    if (frames_[t].trust <= 0.0 || step_.unexplained()[t].norm() > kDoubtful) ++unexplained;
  }
  return unexplained > kMost * count_;
}

int FitDynamics::distrusted_frames() const {
  return static_cast<int>(std::ranges::count_if(
      frames_, [](const CentroidalFrame& frame) { return frame.trust <= 0.0; }));
}

// Computes the wrenches, the contacts and the unexplained wrench of the current clip.
void FitDynamics::read_frames(const FitClip& clip) {
  // Reads no frame beyond the smoothing context, because a concurrent seam may change it.
  constexpr int kContext = 10;
  const int margin = window_.fixed_ends ? std::min(kContext, window_.context) : 0;
  const int first = std::max(window_.begin - margin, 0);
  const int last = std::min(window_.end + margin, clip.frame_count);
  const auto size = at(model_.configuration_size);
  const MotionSpline spline(model_.tree,
                            std::span(clip.qpos).subspan(at(first) * size, at(last - first) * size),
                            model_.configuration_size, 1.0 / clip.frame_time);
  const auto begin = clip.frame(first, model_.configuration_size);
  MotionState state(model_.tree, {begin.begin(), begin.end()});
  for (int t = 0; t < count_; ++t) {
    const int index = window_.begin + t - first;
    const bool at_end = index + 1 == last - first && index > 0;
    spline.sample(at_end ? index - 1 : index, at_end ? 1.0 : 0.0, state);
    read_frame(state, t, clip);
  }
  constexpr double kBetweenFrames = 1.0 / 30.0;  // Seconds.
  if (!begun_) {
    first_com_ = com_;
    contacts_.lend(frames_within(kBetweenFrames));
  }
  // In begin(), overload_ is still 0, because trust must not depend on the strength of the ankles.
  for (int t = 0; t < count_; ++t) fill_cone(t, &FitContactPlace::to_reach, overload_[at(t)]);
  step_.find_unexplained(frames_, scale_);
}

// @return the additional squared unexplained wrench if no ankle may exceed its torque limit, in
//     squared body weights.
double FitDynamics::beyond_ankles(int t) {
  const auto stays = [](const FitContactPlace& place) { return place.to_limit.isZero(0.0); };
  if (std::ranges::all_of(contacts_.places(t), stays)) return 0.0;
  const auto missing = [&](double share) {
    fill_cone(t, &FitContactPlace::to_limit, share);
    return projector_.project(frames_[at(t)].cone, frames_[at(t)].needed).squaredNorm();
  };
  const double with_limits = missing(1.0);
  return std::max(0.0, with_limits - missing(0.0));
}

// Finds the frames in which the wrench requires more torque than the ankles have, and limits the
// pressure on the soles in these frames and in frames nearby. Earlier limits stay in force.
void FitDynamics::find_overloaded_ankles() {
  constexpr double kReach = 0.1;  // Seconds.
  // Unexplained share of the weight at which the limit is full. Its square is compared: a square
  // root would turn the last bits of a small difference into a visible limit.
  constexpr double kFully = 0.0075;
  const int reach = frames_within(kReach);
  std::vector<double> found(overload_.size(), 0.0);
  for (int t = 0; t < count_; ++t) {
    const double overload = std::min(1.0, beyond_ankles(t) / square(kFully));
    if (!(overload > 0.0)) continue;
    for (int k = std::max(0, t - reach); k <= std::min(count_ - 1, t + reach); ++k) {
      found[at(k)] = std::max(found[at(k)], overload);
    }
  }
  found = means_around(found, reach, 0.0);
  bool changes = false;
  for (int t = 0; t < count_; ++t) {
    if (found[at(t)] > overload_[at(t)]) {
      overload_[at(t)] = found[at(t)];
      changes = true;
    }
    fill_cone(t, &FitContactPlace::to_reach, overload_[at(t)]);
  }
  if (changes) step_.project_needed(frames_);
}

void FitDynamics::read_frame(const MotionState& state, int t, const FitClip& clip) {
  pose_.update(state.qpos);
  inverse_.compute(pose_, state.velocity, state.acceleration, contacts_.loads(t, pose_));
  CentroidalFrame& frame = frames_[at(t)];
  const double weight = scale_.mass * kGravity;
  frame.needed.head<3>() = inverse_.needed().force / weight;
  frame.needed.tail<3>() = inverse_.needed().torque / (weight * scale_.length);
  com_[at(t)] = inverse_.com();
  headings_[at(t)] =
      turn_about_vertical(pose_.world_from_link.front().rotation) * Vector3d::UnitX();
  if (!begun_) {
    contacts_.find(t, clip, {pose_, inverse_, headings_[at(t)], frame.needed.z()});
    frame.moved.setZero();
  } else {
    frame.moved.head<3>() = com_[at(t)] - first_com_[at(t)];
  }
  contacts_.place(t, pose_);
  find_reach(t);
}

// Finds the points of the soles at which the ankle torques can balance the current load.
void FitDynamics::find_reach(int t) {
  const Vector3d force = inverse_.needed().force;
  constexpr double kLeast = 0.05;  // Of the weight.
  if (!(force.norm() > kLeast * scale_.mass * kGravity)) return;
  int measured = -1;
  double load = 1.0;
  for (FitContactPlace& place : contacts_.places(t)) {
    if (place.foot < 0) continue;
    if (place.foot != measured) load = load_on(t, place.foot);
    measured = place.foot;
    const int link = model_.feet[at(place.foot)].link;
    const Pose& world = pose_.world_from_link[at(link)];
    const Vector3d in_link = world.inverse() * place.position;
    const Vector3d on_foot = world.rotation.conjugate() * (load * force);
    const auto way_within = [&](const std::vector<double>& torques) -> Vector3d {
      return world.rotation * (within_ankle_reach(model_.tree, torques, link,
                                                  sole_normals_[at(place.foot)], on_foot, in_link) -
                               in_link);
    };
    place.to_limit = way_within(model_.torque_limit);
    place.to_reach = way_within(ankle_torques_);
  }
}

// Share of the contact force on a foot: 1 if only this foot has contacts. Two feet share the force
// like the supports of a beam that is loaded at the zero-moment point.
double FitDynamics::load_on(int t, int foot) const {
  // Bounds for an uncertain estimate: the centres of pressure are not in the middle of the feet.
  constexpr double kMore = 0.1, kLeast = 0.2;
  Vector3d own = Vector3d::Zero(), other = own;
  int own_count = 0, other_count = 0;
  for (const FitContactPlace& place : contacts_.places(t)) {
    (place.foot == foot ? own : other) += place.position;
    ++(place.foot == foot ? own_count : other_count);
  }
  if (other_count == 0) return 1.0;
  own /= own_count;
  other /= other_count;
  const Wrench& needed = inverse_.needed();
  constexpr double kSteep = 0.1;
  if (!(needed.force.z() > kSteep * needed.force.norm())) return 1.0;
  const Eigen::Vector2d zmp =
      zero_moment_point(needed, inverse_.com(), inverse_.com().z() - own.z());
  const Eigen::Vector2d way = (own - other).head<2>();
  const double square = way.squaredNorm();
  if (!(square > 0.0)) return 1.0;
  return std::clamp((zmp - other.head<2>()).dot(way) / square + kMore, kLeast, 1.0);
}

// Sets the friction cones and the dead zone of a frame. The dead zone is smaller where ankles limit
// the pressure, because the usual one can exceed half of an ankle's torque limit.
// @param towards  displacement of the contact points, scaled by `share`.
void FitDynamics::fill_cone(int t, Vector3d FitContactPlace::*towards, double share) {
  CentroidalFrame& frame = frames_[at(t)];
  frame.cone.clear();
  for (const FitContactPlace& place : contacts_.places(t)) {
    const Vector3d lever = place.position + share * place.*towards - com_[at(t)];
    frame.cone.add_point(lever / scale_.length, options_.support_friction, place.normal,
                         headings_[at(t)]);
  }
  frame.dead_zone = std::lerp(CentroidalFrame::kDeadZone, kAnkleDeadZone, share);
}

// Sets each frame's trust from the mean unexplained wrench around it. A human's motion is
// physically possible. A brief unexplained wrench is due to differences between robot and human,
// and the fit can remove it. A lasting one is due to an unknown contact, such as a box or a hand on
// a wall, and must not change the motion.
void FitDynamics::find_trust() {
  constexpr double kReach = 0.3;  // Seconds.
  constexpr double kWrong = 0.3;  // Mean unexplained wrench, share of body weight.
  const std::vector<Vector6d> mean =
      means_around(step_.unexplained(), frames_within(kReach), Vector6d(Vector6d::Zero()));
  for (std::size_t t = 0; t < frames_.size(); ++t) {
    frames_[t].trust = std::clamp((kWrong - mean[t].norm()) / (kWrong - kDoubtful), 0.0, 1.0);
  }
}

int FitDynamics::frames_within(double seconds) const {
  return std::max(1, static_cast<int>(std::lround(seconds / scale_.frame_time)));
}

// Shortens the step of frames around which the last step increased the unexplained wrench. Without
// this, fast motions diverge.
void FitDynamics::restrain(std::vector<Vector6d>& moves) {
  constexpr double kWorse = 1.02, kNoise = 1e-5, kShorter = 0.4, kReach = 0.3;  // kReach: s.
  std::vector<double> now;
  for (std::size_t t = 0; t < frames_.size(); ++t) {
    now.push_back(std::min(1.0, frames_[t].trust * step_.unexplained()[t].norm()));
  }
  if (planned_) {
    const int reach = frames_within(kReach);
    const std::vector<double> before = means_around(rest_before_, reach, 0.0);
    const std::vector<double> after = means_around(now, reach, 0.0);
    std::vector<double> share(now.size(), 1.0);
    for (std::size_t t = 0; t < now.size(); ++t) {
      if (after[t] > kWorse * before[t] + kNoise) share[t] = kShorter;
    }
    // Averages the factors over the same time, so that they have no jumps.
    share = means_around(share, reach, 0.0);
    for (std::size_t t = 0; t < now.size(); ++t) share_[t] *= share[t];
  }
  rest_before_ = now;
  for (std::size_t t = 0; t < moves.size(); ++t) moves[t] *= share_[t];
}

double FitDynamics::add_rows(int frame, const TreeState& pose, double* gradient, double* hessian,
                             int stride) {
  const int t = frame - window_.begin, dofs = model_.dof_count();
  map_.update(pose);
  const CentroidalMap::Rows& rows = map_.rows();
  spin_rows_.middleCols(t * dofs, dofs) = rows.bottomRows<3>();
  const double com = options_.com_weight * kLength / scale_.length;
  const double spin = options_.spin_weight * kUsualMass * kLength * kLength /
                      (scale_.mass * scale_.length * scale_.length);
  Vector6d weights, residual;
  weights << Vector3d::Constant(com * com), Vector3d::Constant(spin * spin);
  weights *= frames_[at(t)].trust;
  residual << map_.com() - goals_[at(t)].head<3>(), -goals_[at(t)].tail<3>();
  for (int i = 0; i < dofs; ++i) {
    const Vector6d weighted = weights.cwiseProduct(rows.col(i));
    gradient[i] += weighted.dot(residual);
    double* const row = hessian + static_cast<std::ptrdiff_t>(i) * stride;
    for (int j = 0; j <= i; ++j) row[j] += weighted.dot(rows.col(j));
  }
  return weights.dot(residual.cwiseAbs2());
}

void FitDynamics::moved(int frame, std::span<const double> step) {
  const int t = frame - window_.begin, dofs = model_.dof_count();
  const Eigen::Map<const Eigen::VectorXd> by(step.data(), dofs);
  frames_[at(t)].moved.tail<3>() += spin_rows_.middleCols(t * dofs, dofs) * by;
}

}  // namespace retarget
