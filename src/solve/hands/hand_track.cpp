#include "solve/hands/hand_track.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/math/step_bounds.h"
#include "retarget/so3.h"
#include "solve/hands/hand_solver.h"
#include "solve/hands/hand_target.h"

namespace retarget {
namespace {

// Speed limit of hinges, rad/s: a hand closes in 0.2 s. Where a minimum of the solver ends, it
// changes to another one within a frame.
constexpr double kFingerSpeed = 9.0;

// Bounds of the variables of a hand: range, and largest step between two frames. They result from
// the bounds of the leading joint and of the joints coupled to it.
struct VariableBounds {
  Eigen::VectorXd lower, upper, step;
};

VariableBounds bounds_of(const Robot& robot, const RobotHand& hand, const LimitSet& limits,
                         double frame_time, const HandBounds& bounds) {
  const auto count = static_cast<Eigen::Index>(hand.variables.size());
  VariableBounds found{Eigen::VectorXd::Constant(count, -HUGE_VAL),
                       Eigen::VectorXd::Constant(count, HUGE_VAL),
                       Eigen::VectorXd::Constant(count, HUGE_VAL)};
  for (const HandJoint& joint : hand.joints) {
    double step = robot.speed_limit(joint.joint) * frame_time;
    const double speed = std::min(bounds.max_speed, kFingerSpeed);
    if (!joint.slides) step = std::min({step, speed * frame_time, bounds.max_step});
    if (joint.ratio == 0.0) continue;
    const StepBounds rounded =
        bounds_for_printing({limits.lower[joint.joint], limits.upper[joint.joint], step},
                            bounds.decimals, joint.slides, bounds.printed);
    double first = (rounded.lower - joint.offset) / joint.ratio;
    double last = (rounded.upper - joint.offset) / joint.ratio;
    if (first > last) std::swap(first, last);
    const Eigen::Index v = joint.variable;
    // If the ranges of coupled joints are incompatible, that of the leading joint has priority.
    const bool leads = hand.variables[joint.variable] == joint.joint;
    if (leads || (first <= found.upper[v] && last >= found.lower[v])) {
      found.lower[v] = std::max(found.lower[v], first);
      found.upper[v] = std::min(found.upper[v], last);
    }
    if (found.lower[v] > found.upper[v]) {
      found.lower[v] = first;
      found.upper[v] = last;
    }
    found.step[v] = std::min(found.step[v], rounded.step / std::abs(joint.ratio));
  }
  return found;
}

// Smooths with binomial filters. Their width in time is that of three taps at 30 frames per second.
// The ends stay fixed.
void smooth(std::vector<double>& values, double fps) {
  constexpr double kTime = 0.0236;  // Standard deviation of the filter, seconds.
  const int passes = static_cast<int>(std::lround(2.0 * kTime * kTime * fps * fps));
  if (values.size() < 3) return;
  constexpr int kMostPasses = 400;
  for (int pass = 0; pass < std::min(passes, kMostPasses); ++pass) {
    double before = values.front();
    for (std::size_t i = 1; i + 1 < values.size(); ++i) {
      const double here = values[i];
      values[i] = 0.25 * (before + 2.0 * here + values[i + 1]);
      before = here;
    }
  }
}

// The solver follows a minimum from one step to the next. After larger changes of the target, it may
// leave for another minimum, and the result would depend on the frame rate.
int solver_steps(double frame_time) {
  constexpr double kLongestStep = 1.0 / 120.0;
  constexpr double kTolerance = 0.01;
  return std::max(1, static_cast<int>(std::ceil(frame_time / kLongestStep - kTolerance)));
}

// The shape at a share of the way between two shapes of one hand.
HandShape shape_between(const HandShape& from, const HandShape& to, double share) {
  HandShape shape = to;
  for (const Finger finger : kFingers) {
    const FingerLine& before = from.line(finger);
    FingerLine& line = shape.line(finger);
    if (before.point_count != line.point_count) continue;
    for (int i = 0; i < line.point_count; ++i) {
      line.points[i] = (1.0 - share) * before.points[i] + share * line.points[i];
    }
    line.length = (1.0 - share) * before.length + share * line.length;
  }
  return shape;
}

}  // namespace

HandsRule hands_rule(HandsRule rule, Method method) {
  // The published method ignores fingers.
  return rule == HandsRule::kAuto && method == Method::kGmr ? HandsRule::kOff : rule;
}

SourceHands followed_hands(const Clip& clip, const BoneMap& map, const RobotHands& robot,
                           HandsRule rule, const FrameRange& part) {
  if (rule != HandsRule::kAuto && rule != HandsRule::kFollow) return {};
  if (part.begin >= part.end) return {};
  const auto holds_pose = [&](const SourceHand& hand) {
    return fingers_are_closed(clip, hand, part.begin) ||
           (rule == HandsRule::kFollow && fingers_leave_rest(clip, hand, part.begin));
  };
  SourceHands hands = find_source_hands(clip.skeleton(), map);
  for (std::size_t side = 0; side < hands.size(); ++side) {
    const bool follows = robot[side] && hands[side] &&
                         (fingers_move(clip, *hands[side], part) || holds_pose(*hands[side]));
    if (!follows) hands[side].reset();
  }
  return hands;
}

HandTrack::HandTrack(const Clip& source, const SourceHands& followed, const Robot& robot,
                     const RobotHands& hands, const LimitSet& limits, const HandBounds& bounds) {
  for (std::size_t side = 0; side < hands.size(); ++side) {
    if (!hands[side]) continue;
    add(source, followed[side] ? &*followed[side] : nullptr, robot, *hands[side], limits, bounds);
  }
}

void HandTrack::add(const Clip& source, const SourceHand* followed, const Robot& robot,
                    const RobotHand& hand, const LimitSet& limits, const HandBounds& bounds) {
  const auto frames = static_cast<std::size_t>(source.frame_count());
  const VariableBounds may = bounds_of(robot, hand, limits, source.rate().frame_time(), bounds);
  HandSolver solver(hand, may.lower, may.upper);
  std::vector<std::vector<double>> variables(hand.variables.size());
  for (std::size_t v = 0; v < variables.size(); ++v) {
    variables[v].assign(frames, solver.relaxed()[static_cast<Eigen::Index>(v)]);
  }
  if (followed != nullptr) {
    const HandMatch match(hand);
    HandPoser poser(source, *followed);
    HandShape shape = relaxed_hand();
    HandTarget target;
    const int steps = solver_steps(source.rate().frame_time());
    for (std::size_t frame = 0; frame < frames; ++frame) {
      const HandShape before = shape;
      poser.shape(static_cast<int>(frame), shape);
      bool has_failed = false;
      for (int step = frame == 0 ? steps : 1; step <= steps; ++step) {
        match.target(shape_between(before, shape, static_cast<double>(step) / steps), target);
        solver.solve(target);
        has_failed |= solver.has_failed();
      }
      if (has_failed) note_failure(hand.side, static_cast<int>(frame));
      for (std::size_t v = 0; v < variables.size(); ++v) {
        variables[v][frame] = solver.solution()[static_cast<Eigen::Index>(v)];
      }
    }
  }
  for (std::size_t v = 0; v < variables.size(); ++v) {
    const auto i = static_cast<Eigen::Index>(v);
    if (followed != nullptr) smooth(variables[v], source.rate().fps());
    bound_steps(variables[v], may.lower[i], may.upper[i], may.step[i]);
  }
  for (const HandJoint& joint : hand.joints) {
    addresses_.push_back(robot.joints()[joint.joint].qpos_address);
    std::vector<double>& positions =
        positions_.emplace_back(variables[static_cast<std::size_t>(joint.variable)]);
    if (joint.ratio == 1.0 && joint.offset == 0.0) continue;
    for (double& position : positions) position = joint.ratio * position + joint.offset;
  }
}

void HandTrack::note_failure(Side side, int frame) {
  const char* const hand = side == Side::kLeft ? "left hand" : "right hand";
  if (!failures_.empty() && failures_.back().end == frame && failures_.back().solver == hand) {
    failures_.back().end = frame + 1;
  } else {
    failures_.push_back({hand, frame, frame + 1});
  }
}

void HandTrack::write(int frame, std::span<double> qpos) const {
  for (std::size_t i = 0; i < addresses_.size(); ++i) {
    qpos[static_cast<std::size_t>(addresses_[i])] = positions_[i][static_cast<std::size_t>(frame)];
  }
}

namespace {

void measure_hand(const Clip& source, const SourceHand& followed, const RobotClip& motion,
                  const RobotHand& hand, HandErrors& errors) {
  const HandMatch match(hand);
  HandPosture posture(hand);
  HandPoser poser(source, followed);
  HandShape shape;
  HandTarget target;
  HandTarget::Parts parts;
  Eigen::VectorXd positions(static_cast<Eigen::Index>(hand.joints.size()));
  const int frames = std::min(source.frame_count(), motion.frame_count());
  for (int frame = 0; frame < frames; ++frame) {
    if (!poser.shape(frame, shape)) continue;
    match.target(shape, target);
    const auto qpos = motion.qpos(frame);
    for (std::size_t j = 0; j < hand.joints.size(); ++j) {
      const RobotJoint& joint = motion.robot().joints()[hand.joints[j].joint];
      positions[static_cast<Eigen::Index>(j)] = qpos[joint.qpos_address];
    }
    posture.set(positions);
    for (const RobotFinger& finger : hand.fingers) {
      const auto f = static_cast<std::size_t>(finger.finger);
      if (finger.finger == Finger::kThumb) continue;
      posture.directions(finger, parts);
      for (int k = 0; !hand.is_gripper && k < target.parts[f].count; ++k) {
        errors.angles.push_back(
            angle_between(parts.directions[static_cast<std::size_t>(k)],
                          target.parts[f].directions[static_cast<std::size_t>(k)]));
      }
      if (!target.has_gap[f] || target.gap[f] > kTouchingGap * finger.length) continue;
      errors.touching_gaps.push_back(std::abs(posture.gap(finger)));
    }
  }
}

}  // namespace

HandErrors measure_hands(const Clip& source, const BoneMap& map, const RobotClip& motion) {
  HandErrors errors;
  const RobotHands hands = find_hands(motion.robot());
  const SourceHands followed =
      followed_hands(source, map, hands, HandsRule::kAuto, {0, source.frame_count()});
  for (std::size_t side = 0; side < hands.size(); ++side) {
    if (!followed[side]) continue;
    measure_hand(source, *followed[side], motion, *hands[side], errors);
  }
  return errors;
}

}  // namespace retarget
