#include "edit/fit_path.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "edit/ground_pose.h"
#include "retarget/filter.h"
#include "retarget/spline.h"
#include "retarget/text.h"

namespace retarget {
namespace {

using Eigen::Matrix2d;
using Eigen::RowVector2d;

// Weights of position and derivative at both ends of a segment.
struct Basis {
  RowVector2d left, right;
};

Basis basis_at(double u, double length) {
  const double v = 1.0 - u;
  return {{v * v * (1.0 + 2.0 * u), length * u * v * v},
          {u * u * (1.0 + 2.0 * v), -length * u * u * v}};
}

// Symmetric block-tridiagonal equations with 2 x 2 blocks.
struct BlockEquations {
  std::vector<Matrix2d> diagonal, above, right_side;

  explicit BlockEquations(std::size_t size)
      : diagonal(size, Matrix2d::Zero()), above(diagonal), right_side(diagonal) {}

  void add(std::size_t piece, const Basis& row, const Eigen::RowVector2d& value, double weight) {
    diagonal[piece] += weight * row.left.transpose() * row.left;
    diagonal[piece + 1] += weight * row.right.transpose() * row.right;
    above[piece] += weight * row.left.transpose() * row.right;
    right_side[piece] += weight * row.left.transpose() * value;
    right_side[piece + 1] += weight * row.right.transpose() * value;
  }

  std::vector<Matrix2d> solve() {
    const std::size_t size = diagonal.size();
    for (std::size_t i = 1; i < size; ++i) {
      const Matrix2d factor = above[i - 1].transpose() * diagonal[i - 1].inverse();
      diagonal[i] -= factor * above[i - 1];
      right_side[i] -= factor * right_side[i - 1];
    }
    std::vector<Matrix2d> result(size);
    for (std::size_t i = size; i-- > 0;) {
      Matrix2d rest = right_side[i];
      if (i + 1 < size) rest -= above[i] * result[i + 1];
      result[i] = diagonal[i].inverse() * rest;
    }
    return result;
  }
};

// Path length of a body that stays in place, metres.
constexpr double kPathOfNoWay = 1e-3;

// Returns the smoothed ground track of the hips.
std::vector<Eigen::Vector2d> ground_track(const std::vector<GroundPose>& hips,
                                          const FrameRate& rate, double cutoff) {
  std::vector<Eigen::Vector3d> points;
  points.reserve(hips.size());
  for (const GroundPose& place : hips) {
    points.emplace_back(place.position.x(), place.position.y(), 0.0);
  }
  // At least one period on each side makes the filter steep enough.
  constexpr double kPeriods = 1.0;
  constexpr double kMaxTaps = 20000.0;
  const double half_width = std::min(kPeriods / cutoff * rate.fps(), kMaxTaps);
  if (cutoff * rate.frame_time() <= 0.5 && half_width >= 1.0) {
    const auto taps =
        design_low_pass(cutoff * rate.frame_time(), static_cast<int>(std::lround(half_width)));
    points = low_pass(points, taps);
  }
  std::vector<Eigen::Vector2d> track;
  track.reserve(points.size());
  for (const Eigen::Vector3d& point : points) track.emplace_back(point.head<2>());
  return track;
}

// The track without the points recorded while standing.
struct ThinTrack {
  std::vector<Eigen::Vector2d> points;
  std::vector<double> chords;  // Distance along the chords from the first point, metres, per point.
  std::vector<double> of_frame;  // The same per frame of the clip.
};

ThinTrack thin_out(const std::vector<Eigen::Vector2d>& track, double step) {
  ThinTrack thin{{track.front()}, {0.0}, {}};
  std::vector<std::size_t> last_point;  // Last point at or before each frame.
  for (const Eigen::Vector2d& place : track) {
    const double distance = (place - thin.points.back()).norm();
    if (distance >= step) {
      thin.points.push_back(place);
      thin.chords.push_back(thin.chords.back() + distance);
    }
    last_point.push_back(thin.points.size() - 1);
  }
  double reached = 0.0;
  for (std::size_t frame = 0; frame < track.size(); ++frame) {
    const std::size_t at = last_point[frame];
    if (at + 1 < thin.points.size()) {
      const Eigen::Vector2d chord = thin.points[at + 1] - thin.points[at];
      const double share = (track[frame] - thin.points[at]).dot(chord) / chord.squaredNorm();
      reached = std::max(reached, thin.chords[at] + std::clamp(share, 0.0, 1.0) * chord.norm());
    } else {
      reached = thin.chords[at];
    }
    thin.of_frame.push_back(reached);
  }
  return thin;
}

struct FittedTrack {
  CubicChain chain;
  double largest_distance = 0.0;
};

// Splits segments that deviate too far from the track; returns true if any were split.
bool refine_knots(const CubicChain& chain, const std::vector<double>& distances,
                  const PathFitOptions& options, std::vector<double>& knots) {
  knots = {chain.knots.front()};
  for (std::size_t piece = 0; piece + 1 < chain.knots.size(); ++piece) {
    const double begin = chain.knots[piece], end = chain.knots[piece + 1];
    if (distances[piece] > options.tolerance && end - begin >= 2.0 * options.min_piece) {
      knots.push_back(0.5 * (begin + end));
    }
    knots.push_back(end);
  }
  return knots.size() > chain.knots.size();
}

// Fits a chain to points at given parameters by weighted least squares.
// @param knots  at least two; their range contains all parameters.
CubicChain fit_cubic_chain(std::vector<double> knots, const std::vector<double>& parameters,
                           const std::vector<Eigen::Vector2d>& points,
                           const std::vector<double>& weights) {
  CubicChain chain{std::move(knots), {}};
  BlockEquations equations(chain.knots.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::size_t piece = chain.piece_of(parameters[i]);
    const double length = chain.knots[piece + 1] - chain.knots[piece];
    equations.add(piece, basis_at((parameters[i] - chain.knots[piece]) / length, length),
                  points[i].transpose(), weights[i]);
  }
  // Weak regularisation: straight and even where there are no points.
  constexpr double kEven = 1e-7;
  for (std::size_t piece = 0; piece + 1 < chain.knots.size(); ++piece) {
    const double length = chain.knots[piece + 1] - chain.knots[piece];
    const RowVector2d none = RowVector2d::Zero();
    equations.add(piece, {{0.0, -1.0}, {0.0, 1.0}}, none, kEven * length);
    equations.add(piece, {{-1.0 / length, -0.5}, {1.0 / length, -0.5}}, none, kEven * length);
  }
  chain.nodes = equations.solve();
  return chain;
}

FittedTrack fit_track(const ThinTrack& thin, const PathFitOptions& options) {
  const double length = thin.chords.back();
  const int pieces = std::max(1, static_cast<int>(std::lround(length / options.first_piece)));
  std::vector<double> knots, weights;
  for (int i = 0; i <= pieces; ++i) knots.push_back(length * i / pieces);
  for (std::size_t i = 0; i < thin.points.size(); ++i) {
    const double before = thin.chords[i == 0 ? 0 : i - 1];
    weights.push_back(0.5 * (thin.chords[std::min(i + 1, thin.points.size() - 1)] - before));
  }
  FittedTrack fitted;
  for (bool split = true; split;) {
    fitted.chain = fit_cubic_chain(knots, thin.chords, thin.points, weights);
    std::vector<double> distances(fitted.chain.knots.size() - 1, 0.0);
    for (std::size_t i = 0; i < thin.points.size(); ++i) {
      double& largest = distances[fitted.chain.piece_of(thin.chords[i])];
      largest = std::max(largest, (fitted.chain.at(thin.chords[i]) - thin.points[i]).norm());
    }
    fitted.largest_distance = *std::ranges::max_element(distances);
    split = refine_knots(fitted.chain, distances, options, knots);
  }
  return fitted;
}

// Converts a parameter of the chain to metres along the path.
double along_path(const GroundPath& path, const CubicChain& chain, double chord) {
  const std::size_t piece = chain.piece_of(chord);
  const double begin = chain.knots[piece];
  return path.length_to(piece, (chord - begin) / (chain.knots[piece + 1] - begin));
}

std::vector<StillPhase> still_phases(const std::vector<double>& along,
                                     const std::vector<GroundPose>& hips, const FrameRate& rate,
                                     double still_speed) {
  const int frames = static_cast<int>(along.size());
  const auto is_still = [&](int frame) {
    const int before = std::max(frame - 1, 0), after = std::min(frame + 1, frames - 1);
    return after == before ||
           (along[after] - along[before]) * rate.fps() / (after - before) < still_speed;
  };
  std::vector<StillPhase> phases;
  for (int frame = 0; frame < frames; ++frame) {
    if (!is_still(frame)) continue;
    if (phases.empty() || phases.back().end != frame) phases.push_back({frame, frame, 0.0});
    phases.back().end = frame + 1;
  }
  for (StillPhase& phase : phases) {
    phase.turn = hips[static_cast<std::size_t>(std::min(phase.end, frames - 1))].heading -
                 hips[static_cast<std::size_t>(std::max(phase.begin - 1, 0))].heading;
  }
  return phases;
}

// Returns the rotation from one heading to another, modulo full turns, that is closest to `like`.
// Prefers the shortest one unless clearly more is needed, so that a nearly straight path does not
// spin.
double turn_like(double from, double to, double like) {
  constexpr double kWhole = 2.0 * std::numbers::pi;
  const double shortest = std::remainder(to - from, kWhole);
  const double more = (like - shortest) / kWhole;
  constexpr double kClearlyMore = 0.75;
  return std::abs(more) < kClearlyMore ? shortest : shortest + kWhole * std::round(more);
}

}  // namespace

std::size_t CubicChain::piece_of(double parameter) const {
  const auto after = std::upper_bound(knots.begin() + 1, knots.end() - 1, parameter);
  return static_cast<std::size_t>(after - knots.begin()) - 1;
}

Eigen::Vector2d CubicChain::at(double parameter) const {
  const std::size_t piece = piece_of(parameter);
  const double length = knots[piece + 1] - knots[piece];
  const Basis basis = basis_at((parameter - knots[piece]) / length, length);
  return (basis.left * nodes[piece] + basis.right * nodes[piece + 1]).transpose();
}

std::vector<Eigen::Vector2d> CubicChain::control_points() const {
  std::vector<Eigen::Vector2d> points{nodes.front().row(0).transpose()};
  for (std::size_t i = 0; i + 1 < nodes.size(); ++i) {
    const double third = (knots[i + 1] - knots[i]) / 3.0;
    points.emplace_back((nodes[i].row(0) + third * nodes[i].row(1)).transpose());
    points.emplace_back((nodes[i + 1].row(0) - third * nodes[i + 1].row(1)).transpose());
    points.emplace_back(nodes[i + 1].row(0).transpose());
  }
  return points;
}

std::string path_text(const GroundPath& path) {
  return number_text(path.length(), 3) + " m in " + count_text(path.segment_count(), "segment");
}

std::string PathMotion::summary() const {
  return path_text(path) + ", within " + number_text(100.0 * largest_distance, 1) +
         " cm of the hips' track";
}

Result<PathMotion> fit_path(const Clip& clip, const Calibration& calibration,
                            const PathFitOptions& options) {
  return fit_path(to_human(clip, calibration), options);
}

Result<PathMotion> fit_path(const HumanClip& human, const PathFitOptions& options) {
  if (human.frame_count == 0)
    return input_failure({}, "the clip has no frames and therefore no path");
  const std::vector<GroundPose> hips = hips_over_ground(human);
  const ThinTrack thin =
      thin_out(ground_track(hips, human.rate, options.low_pass), options.still_step);
  if (thin.points.size() < 2) {
    PathMotion still{line_path({thin.points.front(), hips.front().heading}, kPathOfNoWay),
                     std::vector<double>(hips.size(), 0.0),
                     {{0, human.frame_count, 0.0}},
                     0.0};
    return still;
  }
  const FittedTrack fitted = fit_track(thin, options);
  PathMotion motion{GroundPath(fitted.chain.control_points()), {}, {}, fitted.largest_distance};
  double reached = 0.0;
  for (const double chord : thin.of_frame) {
    reached = std::max(reached, along_path(motion.path, fitted.chain, chord));
    motion.along.push_back(reached);
  }
  motion.still = still_phases(motion.along, hips, human.rate, options.still_speed);
  return motion;
}

std::vector<GroundPose> path_frames(const GroundPath& path, const std::vector<double>& along,
                                    const std::vector<StillPhase>& still,
                                    const std::vector<double>& turns) {
  std::vector<GroundPose> frames;
  frames.reserve(along.size());
  for (const double place : along) frames.push_back(path.at(place));
  const auto count = static_cast<int>(frames.size());
  // Make the headings of moving frames continuous.
  std::size_t next = 0;
  double before = frames.empty() ? 0.0 : frames.front().heading;
  for (int frame = 0; frame < count; ++frame) {
    if (next < still.size() && frame == still[next].begin) {
      const StillPhase& phase = still[next];
      const bool ends = phase.end >= count;
      const double to = frames[std::min(phase.end, count - 1)].heading;
      // A phase at the start or end of the clip has a heading on one side only.
      const double start = frame == 0 && !ends ? to : before;
      const double turn = frame == 0 || ends ? 0.0 : turn_like(start, to, turns[next]);
      for (; frame < phase.end; ++frame) {
        frames[frame].heading = start + turn * smooth_step(phase.begin - 1, phase.end, frame);
      }
      before = start + turn;
      ++next;
      --frame;
      continue;
    }
    before += std::remainder(frames[frame].heading - before, 2.0 * std::numbers::pi);
    frames[frame].heading = before;
  }
  return frames;
}

void spread_turns(std::vector<GroundPose>& frames, const FrameRate& rate) {
  constexpr double kMaxSpeed = 4.0;    // Rad/s, a quick turn on the spot.
  constexpr double kMaxSeconds = 1.0;  // Seconds: a longer turn is not a corner.
  constexpr double kPeakOfEase = 1.5;  // Ratio of peak to mean speed.
  const int count = static_cast<int>(frames.size());
  const auto longest = static_cast<int>(std::lround(kMaxSeconds * rate.fps()));
  const double fastest_step = kMaxSpeed * rate.frame_time();
  const auto step = [&](int frame) { return frames[frame].heading - frames[frame - 1].heading; };
  for (int frame = 1; frame < count; ++frame) {
    if (std::abs(step(frame)) <= fastest_step) continue;
    int begin = frame - 1, end = frame;
    while (end + 1 < count && std::abs(step(end + 1)) > fastest_step) ++end;
    const auto too_fast = [&] {
      return kPeakOfEase * std::abs(frames[end].heading - frames[begin].heading) >
             fastest_step * (end - begin);
    };
    while (too_fast() && end - begin < longest && (begin > 0 || end + 1 < count)) {
      if (begin > 0) --begin;
      if (end + 1 < count) ++end;
    }
    const double from = frames[begin].heading, turn = frames[end].heading - from;
    for (int i = begin + 1; i < end; ++i) {
      frames[i].heading = from + turn * smooth_step(begin, end, i);
    }
    frame = end;
  }
}

}  // namespace retarget
