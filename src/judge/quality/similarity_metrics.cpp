#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "judge/quality/report_parts.h"
#include "judge/quality/similarity_metrics.h"
#include "retarget/filter.h"
#include "retarget/kinematic_tree.h"
#include "retarget/pose.h"
#include "retarget/robot.h"
#include "retarget/so3.h"
#include "retarget/statistics.h"

namespace retarget {
namespace {

using Eigen::Vector3d;
using Rates = std::vector<std::vector<Vector3d>>;  // By limb and frame.

// Rate of change of the unit vectors along a limb, 1/s.
std::vector<Vector3d> turning(const std::vector<Vector3d>& directions, double fps) {
  std::vector<Vector3d> rates;
  rates.reserve(directions.size());
  for (std::size_t i = 1; i < directions.size(); ++i) {
    rates.push_back(fps *
                    (directions[i].stableNormalized() - directions[i - 1].stableNormalized()));
  }
  return rates;
}

// Correlation of the robot's rates with the human's rates `lag` frames earlier, over the frames
// that both have.
double correlation(const Rates& robot, const Rates& human, int lag) {
  double both = 0.0, of_robot = 0.0, of_human = 0.0;
  for (std::size_t limb = 0; limb < robot.size(); ++limb) {
    const int frames = static_cast<int>(robot[limb].size());
    for (int frame = std::max(lag, 0); frame < frames + std::min(lag, 0); ++frame) {
      const Vector3d& have = robot[limb][static_cast<std::size_t>(frame)];
      const Vector3d& want = human[limb][static_cast<std::size_t>(frame - lag)];
      both += have.dot(want);
      of_robot += have.squaredNorm();
      of_human += want.squaredNorm();
    }
  }
  const double size = std::sqrt(of_robot * of_human);
  return size > 0.0 ? both / size : 0.0;
}

// Root mean square, 1/s.
double mean_rate(const Rates& rates) {
  double sum = 0.0, count = 0.0;
  for (const auto& limb : rates) {
    for (const Vector3d& rate : limb) sum += rate.squaredNorm();
    count += static_cast<double>(limb.size());
  }
  return count > 0.0 ? std::sqrt(sum / count) : 0.0;
}

// The lag of the highest peak. Among nearly equal peaks, which periodic motions have, the lag
// nearest to 0.
int best_lag(const std::vector<double>& correlations, int reach) {
  constexpr double kNearlyAsHigh = 0.02;
  const auto at = [&](int lag) { return correlations[static_cast<std::size_t>(lag + reach)]; };
  const double highest = *std::max_element(correlations.begin(), correlations.end());
  for (int away = 0; away < reach; ++away) {
    for (const int lag : {away, -away}) {
      const bool peak = at(lag) >= at(lag - 1) && at(lag) >= at(lag + 1);
      if (peak && at(lag) >= highest - kNearlyAsHigh) return lag;
    }
  }
  return at(reach) >= at(-reach) ? reach : -reach;
}

// Root mean square of the vertical motion between two frequencies, metres.
double band_rms(std::span<const Eigen::Vector3d> points, double low, double high, double fps) {
  constexpr double kPeriods = 2.0;  // Half width of the filters, in periods of the cutoff.
  const auto filtered = [&](double hertz) {
    const int half_width = static_cast<int>(std::ceil(kPeriods * fps / hertz));
    return low_pass(points, design_low_pass(hertz / fps, half_width));
  };
  const auto below_high = filtered(high), below_low = filtered(low);
  double sum = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double band = below_high[i].z() - below_low[i].z();
    sum += band * band;
  }
  return std::sqrt(sum / static_cast<double>(points.size()));
}

}  // namespace

std::optional<double> limb_lag(const std::vector<LimbDirections>& limbs, double fps) {
  constexpr double kReach = 0.5, kShortest = 1.0;  // seconds
  constexpr double kStill = 0.05, kMoving = 0.3;   // rad/s
  constexpr double kAlike = 0.3;                   // Minimum correlation.
  if (limbs.empty() || static_cast<double>(limbs.front().human.size()) < kShortest * fps) {
    return std::nullopt;
  }
  Rates robot, human;
  for (const LimbDirections& limb : limbs) {
    robot.push_back(turning(limb.robot, fps));
    human.push_back(turning(limb.human, fps));
  }
  const double moving = mean_rate(human);
  if (moving < kStill) return std::nullopt;
  const int reach = std::max(1, static_cast<int>(std::lround(kReach * fps)));
  std::vector<double> correlations;
  for (int lag = -reach; lag <= reach; ++lag) {
    correlations.push_back(correlation(robot, human, lag));
  }
  const int lag = best_lag(correlations, reach);
  const auto at = static_cast<std::size_t>(lag + reach);
  // Limbs that clearly move but never like the human's are as wrong as limbs that are late.
  if (!(correlations[at] >= kAlike)) {
    return moving >= kMoving ? std::optional(reach / fps) : std::nullopt;
  }
  if (std::abs(lag) == reach) return lag / fps;
  // Vertex of the parabola through three values.
  const double before = correlations[at - 1], after = correlations[at + 1];
  const double bend = before - 2.0 * correlations[at] + after;
  const double part = bend < 0.0 ? 0.5 * (before - after) / bend : 0.0;
  return (lag + part) / fps;
}

namespace {

// @param side   kNone: both.
// @param least  time with fast limbs, seconds; less is chance.
std::optional<double> fast_speed_of_side(std::span<const LimbDirections> limbs, bool of_legs,
                                         Side side, double least, double fps) {
  // Longer than the snap of a marker or of a wrong pose, which a robot need not follow.
  constexpr double kStepSeconds = 0.1, kShortest = 1.0;
  constexpr double kFastShare = 0.02;
  constexpr double kSlow = 2.0;  // rad/s
  const auto step = static_cast<std::size_t>(std::max(1L, std::lround(kStepSeconds * fps)));
  double of_human = 0.0, of_robot = 0.0;
  int fast = 0;
  std::vector<std::pair<double, double>> speeds;  // Human, robot.
  for (const LimbDirections& limb : limbs) {
    const bool counts =
        limb.rank > 0 && limb.of_legs == of_legs && (side == Side::kNone || limb.side == side);
    if (!counts || static_cast<double>(limb.human.size()) < kShortest * fps) continue;
    speeds.clear();
    for (std::size_t i = step; i < limb.human.size(); ++i) {
      if (!limb.is_free(i) || !limb.is_free(i - step)) continue;
      const double per_second = fps / static_cast<double>(step);
      speeds.emplace_back(per_second * angle_between(limb.human[i - step], limb.human[i]),
                          per_second * angle_between(limb.robot[i - step], limb.robot[i]));
    }
    const auto count =
        static_cast<std::ptrdiff_t>(std::ceil(kFastShare * static_cast<double>(speeds.size())));
    std::ranges::partial_sort(speeds, speeds.begin() + count, std::greater());
    for (const auto& [human, robot] : std::span(speeds).first(static_cast<std::size_t>(count))) {
      if (human < kSlow) continue;
      of_human += human;
      of_robot += robot;
      ++fast;
    }
  }
  if (fast == 0 || fast < least * fps) return std::nullopt;
  return of_robot / of_human;
}

}  // namespace

std::optional<double> fast_speed_kept(std::span<const LimbDirections> limbs, bool of_legs,
                                      double fps) {
  constexpr double kOfBoth = 0.1, kOfOne = 0.2;  // Seconds.
  auto lowest = fast_speed_of_side(limbs, of_legs, Side::kNone, kOfBoth, fps);
  for (const Side side : kSides) {
    const auto kept = fast_speed_of_side(limbs, of_legs, side, kOfOne, fps);
    if (kept && lowest) lowest = std::min(*kept, *lowest);
  }
  return lowest;
}

std::optional<double> root_slide(const std::vector<Eigen::Vector3d>& found,
                                 const std::vector<Eigen::Vector3d>& wanted, double fps) {
  constexpr double kTime = 2.0;  // seconds
  const std::size_t frames = std::min(found.size(), wanted.size());
  if (frames < 2) return std::nullopt;
  const auto step =
      std::clamp<std::size_t>(static_cast<std::size_t>(std::lround(kTime * fps)), 1, frames - 1);
  double sum = 0.0;
  for (std::size_t i = 0; i + step < frames; ++i) {
    const Eigen::Vector3d left = (found[i + step] - wanted[i + step]) - (found[i] - wanted[i]);
    sum += left.head<2>().norm();
  }
  return sum / static_cast<double>(frames - step) * fps / static_cast<double>(step);
}

std::optional<double> bounce_kept(std::span<const Eigen::Vector3d> found,
                                  std::span<const Eigen::Vector3d> wanted, double fps) {
  constexpr double kLow = 2.5, kHigh = 8.0;  // Hz
  constexpr double kLeast = 0.001;           // Noise level of motion capture, metres.
  constexpr double kSeconds = 1.0;
  const std::size_t frames = std::min(found.size(), wanted.size());
  if (static_cast<double>(frames) < kSeconds * fps || fps < 2.5 * kHigh) return std::nullopt;
  const double of_target = band_rms(wanted.first(frames), kLow, kHigh, fps);
  if (!(of_target > kLeast)) return 1.0;
  return band_rms(found.first(frames), kLow, kHigh, fps) / of_target;
}

void measure_source_slide(const ReportBuilder& draft, const HumanClip& human, int frames) {
  // Long enough that the noise of motion capture has little effect.
  constexpr double kStepSeconds = 1.0 / 30.0;
  const double fps = human.rate.fps();
  const int step = std::max(1, static_cast<int>(std::lround(kStepSeconds * fps)));
  std::vector<Bone> feet;
  for (const Side side : kSides) {
    for (const LimbBone part : {LimbBone::kFoot, LimbBone::kToe}) {
      if (human.has(side_bone(side, part))) feet.push_back(side_bone(side, part));
    }
  }
  const bool has_hips = human.has(Bone::kLeftUpLeg) && human.has(Bone::kRightUpLeg);
  if (feet.empty() || !has_hips || frames <= step) return;
  double sum = 0.0;
  for (int frame = step; frame < frames; ++frame) {
    const HumanPose &before = human.frame(frame - step), &now = human.frame(frame);
    const auto way = [&](Bone bone) -> Eigen::Vector3d {
      return now[bone].translation - before[bone].translation;
    };
    double least = std::numeric_limits<double>::infinity();
    for (const Bone foot : feet) least = std::min(least, way(foot).norm());
    const Eigen::Vector3d hips = 0.5 * (way(Bone::kLeftUpLeg) + way(Bone::kRightUpLeg));
    sum += std::max(0.0, least - hips.norm()) * fps / step;
  }
  draft.set("source_slide_mean", sum / (frames - step));
}

namespace {

// Angle from the vertical, degrees.
double lean_of(const Eigen::Vector3d& up) {
  return kDegreesPerRadian * angle_between(up, Eigen::Vector3d::UnitZ());
}

// @param pose_of  returns world_from_body by index among the kept bodies
template <typename PoseOf>
TrunkLines lines_of(const TrunkBodies& trunk, const PoseOf& pose_of) {
  const auto at = [&](std::size_t i) -> Eigen::Vector3d {
    return pose_of(trunk.bodies[i]) * trunk.body_from_joint[i];
  };
  return {0.5 * (at(2) + at(3) - at(0) - at(1)), at(2) - at(3)};
}

std::optional<Eigen::Matrix3d> standing_trunk(const Robot& robot, const BodyTracks& tracks,
                                              const TrunkBodies& trunk) {
  const TreeState posed(robot.tree(), robot.zero_configuration());
  return trunk_frame(
      lines_of(trunk, [&](int body) { return posed.world_from_body(tracks.kept_bodies[body]); }));
}

// By frame, degrees; as in TrunkLean.
struct Leans {
  std::vector<double> human, robot, human_line, robot_line, between;
};

}  // namespace

std::optional<Eigen::Matrix3d> standing_trunk(const HumanClip& human) {
  if (!has_trunk(human)) return std::nullopt;
  return trunk_frame(standing_trunk_lines(human, poses_of(human)));
}

void measure_trunk_lean(const ReportBuilder& draft, const BodyTracks& tracks,
                        const TrunkBodies& trunk, const HumanClip& human,
                        const Eigen::Quaterniond& robot_from_human, const Posture& posture,
                        int frames) {
  constexpr double kFarOff = 15.0;  // degrees
  const auto human_standing = standing_trunk(human);
  const auto robot_standing = standing_trunk(draft.clip.robot(), tracks, trunk);
  if (!human_standing || !robot_standing) return;
  FaultList faults("trunk_lean_error_deg", "deg");
  Leans leans;
  std::vector<double> errors;
  for (int frame = 0; frame < frames; ++frame) {
    if (!posture.is_upright(frame)) continue;
    const TrunkLines of_human = trunk_lines(human.frame(frame));
    const TrunkLines of_robot =
        lines_of(trunk, [&](int body) -> const Pose& { return tracks.kept(frame, body); });
    const auto human_axes = trunk_frame(of_human), robot_axes = trunk_frame(of_robot);
    if (!human_axes || !robot_axes) continue;
    const Eigen::Vector3d human_up = trunk_up(*human_axes, *human_standing);
    const Eigen::Vector3d robot_up = trunk_up(*robot_axes, *robot_standing);
    leans.human.push_back(lean_of(human_up));
    leans.robot.push_back(lean_of(robot_up));
    leans.human_line.push_back(lean_of(of_human.chord));
    leans.robot_line.push_back(lean_of(of_robot.chord));
    leans.between.push_back(kDegreesPerRadian *
                            angle_between(robot_from_human * human_up, robot_up));
    errors.push_back(std::abs(leans.robot.back() - leans.human.back()));
    if (errors.back() > kFarOff) faults.add("trunk", frame, errors.back());
  }
  if (errors.empty()) return;
  draft.report.trunk_lean = {mean(leans.human),
                             mean(leans.robot),
                             mean(leans.human_line),
                             mean(leans.robot_line),
                             mean(leans.between),
                             lean_of(human_standing->col(2)),
                             lean_of(robot_standing->col(2))};
  draft.set("trunk_lean_error_deg", mean(errors), percentile(errors, 95.0));
  faults.move_to(draft.report, draft.options.faults_per_metric);
}

}  // namespace retarget
