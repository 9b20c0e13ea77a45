// The solver's gradient matches its cost, no search finds a lower cost, pinches and fists close and
// open hands open, for hands with three fingers and with six motors.

#include "solve/hands/hand_solver.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "retarget/so3.h"
#include "robot/shipped_robots.h"
#include "solve/hands/hand_target.h"
#include "support/counted_allocations.h"
#include "support/finger_clip.h"
#include "support/hand_robots.h"

namespace retarget {
namespace {

constexpr double kDegree = 0.017453292519943295;

// The left hand of a robot and its solver.
struct Solved {
  std::shared_ptr<const Robot> robot;
  RobotHand hand;
  Eigen::VectorXd lower, upper;

  explicit Solved(std::shared_ptr<const Robot> of)
      : robot(std::move(of)), hand(*find_hands(*robot)[0]) {
    const auto count = static_cast<Eigen::Index>(hand.variables.size());
    lower.resize(count);
    upper.resize(count);
    for (Eigen::Index i = 0; i < count; ++i) {
      lower[i] = robot->model_limits().lower[hand.variables[static_cast<std::size_t>(i)]];
      upper[i] = robot->model_limits().upper[hand.variables[static_cast<std::size_t>(i)]];
    }
  }
  [[nodiscard]] HandSolver solver() const { return HandSolver(hand, lower, upper); }
  [[nodiscard]] HandTarget target(const HandShape& shape) const {
    HandTarget target;
    HandMatch(hand).target(shape, target);
    return target;
  }
};

std::vector<Solved> hands() {
  std::vector<Solved> all;
  all.emplace_back(load_shipped("unitree_g1_with_hands"));
  all.emplace_back(robot_from_text(six_motor_hands()));
  return all;
}

// Distance between the tips of a finger and the thumb.
double gap(const Solved& of, const Eigen::VectorXd& variables, Finger finger) {
  HandPosture posture(of.hand);
  posture.set_variables(variables);
  return posture.gap(*of.hand.find(finger));
}

template <typename Pose>
HandShape left_shape(const Pose& pose) {
  FingerClip source(1);
  pose(source);
  const SourceHands hands = source.hands();
  HandShape shape;
  EXPECT_TRUE(HandPoser(source.clip(), *hands[0]).shape(0, shape));
  return shape;
}

HandShape open_shape() {
  return left_shape([](FingerClip&) {});
}
HandShape fist_shape() {
  return left_shape([](FingerClip& source) { source.make_fist(0, 0); });
}
HandShape pinch_shape(Finger finger) {
  return left_shape([&](FingerClip& source) { source.pinch(0, 0, finger); });
}

Eigen::VectorXd random_variables(const Solved& of, std::mt19937& random) {
  std::uniform_real_distribution<double> share(0.0, 1.0);
  Eigen::VectorXd x(of.lower.size());
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    x[i] = of.lower[i] + share(random) * (of.upper[i] - of.lower[i]);
  }
  return x;
}

TEST(HandSolverTest, GradientMatchesTheCost) {
  std::mt19937 random(5);
  for (const Solved& of : hands()) {
    HandSolver solver = of.solver();
    const auto count = of.lower.size();
    Eigen::VectorXd gradient(count), unused(count);
    Eigen::MatrixXd matrix(count, count);
    for (const HandShape& shape : {fist_shape(), pinch_shape(Finger::kIndex)}) {
      const HandTarget target = of.target(shape);
      for (int i = 0; i < 20; ++i) {
        const Eigen::VectorXd x = random_variables(of, random), last = random_variables(of, random);
        solver.evaluate(target, x, &last, gradient, matrix);
        for (Eigen::Index k = 0; k < count; ++k) {
          constexpr double kStep = 1e-6;
          Eigen::VectorXd moved = x;
          moved[k] += kStep;
          const double after = solver.evaluate(target, moved, &last, unused, matrix);
          moved[k] -= 2.0 * kStep;
          const double before = solver.evaluate(target, moved, &last, unused, matrix);
          EXPECT_NEAR(gradient[k], (after - before) / (2.0 * kStep),
                      1e-6 * (1.0 + gradient.norm()));
        }
      }
    }
  }
}

TEST(HandSolverTest, NoSearchFindsALowerCost) {
  std::mt19937 random(9);
  std::normal_distribution<double> normal;
  for (const Solved& of : hands()) {
    const auto count = of.lower.size();
    Eigen::VectorXd gradient(count);
    Eigen::MatrixXd matrix(count, count);
    for (const HandShape& shape : {open_shape(), fist_shape(), pinch_shape(Finger::kIndex)}) {
      HandSolver solver = of.solver();
      const HandTarget target = of.target(shape);
      const auto cost = [&](const Eigen::VectorXd& x) {
        return solver.evaluate(target, x, nullptr, gradient, matrix);
      };
      const Eigen::VectorXd found = solver.solve(target);
      const double least = cost(found);
      // Samples the whole box, then ever closer to the best point.
      Eigen::VectorXd best = random_variables(of, random);
      double lowest = cost(best);
      for (int i = 0; i < 20000; ++i) {
        Eigen::VectorXd x = random_variables(of, random);
        if (i > 5000) {
          const double reach = std::exp(-static_cast<double>(i - 5000) / 2500.0);
          x = best;
          for (Eigen::Index k = 0; k < count; ++k) {
            x[k] += reach * normal(random) * (of.upper[k] - of.lower[k]);
          }
          x = x.cwiseMax(of.lower).cwiseMin(of.upper);
        }
        const double now = cost(x);
        if (now < lowest) {
          lowest = now;
          best = x;
        }
      }
      EXPECT_LT(least, lowest + 1e-5);
    }
  }
}

TEST(HandSolverTest, PinchesClose) {
  for (const Solved& of : hands()) {
    for (const Finger finger : {Finger::kIndex, Finger::kMiddle}) {
      HandSolver solver = of.solver();
      const HandTarget target = of.target(pinch_shape(finger));
      EXPECT_GT(target.touch[static_cast<std::size_t>(finger)], 0.99);
      const Eigen::VectorXd found = solver.solve(target);
      EXPECT_LT(std::abs(gap(of, found, finger)), 0.005)
          << of.robot->name() << " " << finger_name(finger) << ": " << found.transpose();
      solver.reset();
      const Eigen::VectorXd open = solver.solve(of.target(open_shape()));
      EXPECT_GT(gap(of, open, finger), 0.03);
    }
  }
}

TEST(HandSolverTest, FistsCloseAndOpenHandsOpen) {
  const std::array<HandShape, 2> shapes = {open_shape(), fist_shape()};
  for (const Solved& of : hands()) {
    for (const HandShape& shape : shapes) {
      HandSolver solver = of.solver();
      const HandTarget target = of.target(shape);
      const Eigen::VectorXd found = solver.solve(target);
      EXPECT_TRUE((found.array() >= of.lower.array()).all());
      EXPECT_TRUE((found.array() <= of.upper.array()).all());
      for (const RobotFinger& finger : of.hand.fingers) {
        if (finger.finger == Finger::kThumb) continue;
        HandTarget::Parts parts;
        HandPosture posture(of.hand);
        posture.set_variables(found);
        posture.directions(finger, parts);
        const HandTarget::Parts& wanted = target.parts[static_cast<std::size_t>(finger.finger)];
        ASSERT_EQ(parts.count, 2);
        ASSERT_EQ(wanted.count, 2);
        for (int k = 0; k < 2; ++k) {
          EXPECT_LT(angle_between(parts.directions[k], wanted.directions[k]), 30.0 * kDegree)
              << of.robot->name() << " " << finger_name(finger.finger) << " part " << k;
        }
      }
    }
  }
}

// Fingers of four joints, one of which turns sideways, bend as far as the human's.
TEST(HandSolverTest, FingersOfFourJointsClose) {
  for (const bool thumb_is_named : {true, false}) {
    const Solved of(robot_from_text(leap_like_hands(thumb_is_named)));
    const HandTarget target = of.target(fist_shape());
    HandSolver solver = of.solver();
    HandPosture posture(of.hand);
    posture.set_variables(solver.solve(target));
    for (const RobotFinger& finger : of.hand.fingers) {
      if (finger.finger == Finger::kThumb) continue;
      HandTarget::Parts parts;
      posture.directions(finger, parts);
      const HandTarget::Parts& wanted = target.parts[static_cast<std::size_t>(finger.finger)];
      ASSERT_EQ(parts.count, wanted.count);
      for (int k = 0; k < parts.count; ++k) {
        EXPECT_LT(angle_between(parts.directions[k], wanted.directions[k]), 20.0 * kDegree)
            << finger_name(finger.finger) << " part " << k;
      }
    }
  }
}

TEST(HandSolverTest, LongerHandsCloseAsFar) {
  // The same hand at twice the size gives the same targets.
  HandShape shape = pinch_shape(Finger::kIndex), large = shape;
  for (FingerLine& line : large.fingers) {
    for (Eigen::Vector3d& point : line.points) point *= 2.0;
    line.length *= 2.0;
  }
  const Solved of(load_shipped("unitree_g1_with_hands"));
  const HandTarget a = of.target(shape), b = of.target(large);
  EXPECT_NEAR(a.gap[1], b.gap[1], 1e-12);
  EXPECT_NEAR(a.gap[2], b.gap[2], 1e-12);
  EXPECT_LT((a.parts[1].directions[0] - b.parts[1].directions[0]).norm(), 1e-12);
}

TEST(HandSolverTest, ARelaxedHandIsHalfOpen) {
  for (const Solved& of : hands()) {
    const HandSolver solver = of.solver();
    for (Eigen::Index i = 0; i < of.lower.size(); ++i) {
      const std::string& name =
          of.robot->joints()[of.hand.variables[static_cast<std::size_t>(i)]].name;
      if (name.find("thumb") != std::string::npos) continue;
      // Fingers bend from 0 to one side.
      const double most = std::abs(of.lower[i]) > of.upper[i] ? of.lower[i] : of.upper[i];
      const double share = solver.relaxed()[i] / most;
      EXPECT_GT(share, 0.15) << name;
      EXPECT_LT(share, 0.6) << name;
    }
  }
}

TEST(HandSolverTest, MissingFingersFollowTheirNeighbours) {
  HandShape shape = fist_shape();
  shape.line(Finger::kRing) = FingerLine();
  shape.line(Finger::kThumb) = FingerLine();
  const Solved of(robot_from_text(six_motor_hands()));
  const HandTarget target = of.target(shape);
  EXPECT_EQ(target.parts[0].count, 0) << "nothing leads the thumb";
  EXPECT_FALSE(target.has_gap[1]);
  EXPECT_EQ(target.parts[3].count, 2);
  EXPECT_EQ(target.parts[3].directions[0], target.parts[2].directions[0]) << "as the middle finger";
}

TEST(HandSolverTest, GrippersFollowThumbAndIndexFinger) {
  const Solved of(robot_from_text(grippers()));
  HandSolver solver = of.solver();
  const Eigen::VectorXd open = solver.solve(of.target(open_shape()));
  solver.reset();
  const Eigen::VectorXd closed = solver.solve(of.target(pinch_shape(Finger::kIndex)));
  EXPECT_LT(open[0], 0.01);
  EXPECT_LT(std::abs(gap(of, closed, Finger::kIndex)), 0.005);
}

TEST(HandSolverTest, AllocatesNothingPerFrame) {
  for (const Solved& of : hands()) {
    HandSolver solver = of.solver();
    FingerClip source(20);
    for (int frame = 0; frame < 20; ++frame) {
      const double bend = 0.05 * frame;
      source.bend(frame, 0, Finger::kIndex, {bend, bend, bend});
    }
    const SourceHands found = source.hands();
    HandPoser poser(source.clip(), *found[0]);
    const HandMatch match(of.hand);
    HandShape shape;
    HandTarget target;
    poser.shape(0, shape);
    match.target(shape, target);
    solver.solve(target);
    const long before = allocations;
    for (int frame = 1; frame < 20; ++frame) {
      poser.shape(frame, shape);
      match.target(shape, target);
      solver.solve(target);
    }
    EXPECT_EQ(allocations, before);
  }
}

TEST(HandSolver, KeepsThePreviousFrameForNonFiniteTargets) {
  for (const Solved& of : hands()) {
    HandSolver solver = of.solver();
    HandTarget bad = of.target(fist_shape());
    bad.has_gap.fill(true);
    bad.gap.fill(std::nan(""));
    for (auto& part : bad.parts) part.directions.fill(Eigen::Vector3d::Constant(std::nan("")));
    // The first frame already has the relaxed hand.
    Eigen::VectorXd solved = solver.solve(bad);
    EXPECT_TRUE(solver.has_failed());
    EXPECT_EQ(solved, solver.relaxed());
    solved = solver.solve(of.target(fist_shape()));
    EXPECT_FALSE(solver.has_failed());
    HandSolver fresh = of.solver();
    EXPECT_EQ(solved, fresh.solve(of.target(fist_shape())));
    const Eigen::VectorXd again = solver.solve(bad);
    EXPECT_TRUE(solver.has_failed());
    EXPECT_EQ(again, solved);
  }
}

}  // namespace
}  // namespace retarget
