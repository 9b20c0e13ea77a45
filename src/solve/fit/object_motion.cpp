#include "solve/fit/object_motion.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "base/math/se3.h"
#include "retarget/so3.h"
#include "scene/body_mass.h"
#include "solve/dynamics/scene_supports.h"
#include "solve/fit/shorthand.h"

namespace retarget {
namespace {

using Eigen::Vector3d;

// Displacement of an object's centre of mass (metres), then rotation vector (radians); world axes.
using Move = Vector6d;

// Computes the displacements of one object.
class ObjectFollower {
 public:
  ObjectFollower(const FitModel& model, std::size_t body, double frame_time, FitScene& scene)
      : model_(model),
        body_(body),
        reach_(std::max(1, static_cast<int>(std::lround(kSmoothing / frame_time)))),
        scene_(scene),
        com_(body_mass(scene.world.clip.scene->bodies[body]).com),
        found_(at(scene.world.clip.frame_count)),
        moves_(found_.size(), Move::Zero()) {}

  // Solves for the displacement that brings the object to the parts that hold it in a frame.
  void read(int frame, const TreeState& pose) {
    Matrix6d hessian = Matrix6d::Zero();
    Move gradient = Move::Zero();
    int parts = 0;
    const Vector3d com = scene_.world.clip.pose(frame, body_) * com_;
    for (const SceneGoal& goal : scene_.goals_of(frame)) {
      if (at(goal.body) != body_ || goal.share < 1.0) continue;
      const SupportBody& support = model_.supports[at(goal.support)];
      const auto touch = support.nearest(pose, scene_.world, frame, body_);
      Vector3d apart = touch.distance * touch.normal;
      if (goal.held) {
        const Vector3d off = support.world_middle(pose) - goal.place;
        apart += off - goal.normal.dot(off) * goal.normal;
      }
      Eigen::Matrix<double, 3, 6> jacobian;
      jacobian << Eigen::Matrix3d::Identity(), -skew(touch.place - com);
      hessian += jacobian.transpose() * jacobian;
      gradient += jacobian.transpose() * apart;
      ++parts;
    }
    if (parts == 0) return;
    // Regularises the rotation, which a single part does not determine.
    constexpr double kNoTurn = 0.02;  // Square metres.
    hessian.bottomRightCorner<3, 3>().diagonal().array() += kNoTurn * parts;
    found_[at(frame)] = hessian.ldlt().solve(gradient);
  }

  [[nodiscard]] bool is_held() const {
    return std::ranges::any_of(found_, [](const auto& found) { return found.has_value(); });
  }

  void plan(const SceneSupports& supports) {
    interpolate();
    for (std::size_t t = 0; t < moves_.size(); ++t) {
      lifted_.push_back(supports.lifted(static_cast<int>(t), body_));
    }
    const std::vector<std::pair<std::size_t, Move>> resting = find_rests();
    const auto rest = [&] {
      for (const auto& [t, move] : resting) moves_[t] = move;
    };
    // Smooths the motion between rests.
    constexpr int kPasses = 10;
    for (int pass = 0; pass < kPasses; ++pass) {
      rest();
      smooth();
    }
    rest();
  }

  // @return the largest displacement, metres.
  double apply() {
    double farthest = 0.0;
    SceneClip& clip = scene_.world.clip;
    for (int t = 0; t < clip.frame_count; ++t) {
      const Move& move = moves_[at(t)];
      farthest = std::max(farthest, move.head<3>().norm());
      Pose& pose = clip.world_from_body[at(t) * scene_.world.body_count() + body_];
      const Pose before = pose;
      const Eigen::Quaterniond turn = exp_so3(move.tail<3>());
      const Vector3d com = before * com_;
      pose.rotation = (turn * before.rotation).normalized();
      pose.translation = com + move.head<3>() + turn * (before.translation - com);
      for (std::uint32_t i = scene_.first_goal[at(t)]; i < scene_.first_goal[at(t) + 1]; ++i) {
        SceneGoal& goal = scene_.goals[i];
        if (at(goal.body) != body_) continue;
        goal.place = pose * (before.inverse() * goal.place);
        goal.normal = turn * goal.normal;
      }
    }
    return farthest;
  }

 private:
  static constexpr double kSmoothing = 0.067;  // Half width of the moving average, seconds.

  // Fills the frames without contacts: linearly between contacts, constantly before the first and
  // after the last one.
  void interpolate() {
    std::optional<std::size_t> last;
    for (std::size_t t = 0; t < found_.size(); ++t) {
      if (!found_[t]) continue;
      const std::size_t from = last ? *last + 1 : 0;
      for (std::size_t k = from; k < t; ++k) {
        const double share =
            last ? static_cast<double>(k - *last) / static_cast<double>(t - *last) : 1.0;
        moves_[k] =
            (last ? (1.0 - share) * moves_[*last] : Move(Move::Zero())) + share * *found_[t];
      }
      moves_[t] = *found_[t];
      last = t;
    }
    if (!last) return;
    for (std::size_t k = *last + 1; k < moves_.size(); ++k) moves_[k] = moves_[*last];
  }

  // The frames in which the object lies on its ground, and its displacement. It does not slide, so
  // the displacement is the mean of those at the adjacent lifts.
  [[nodiscard]] std::vector<std::pair<std::size_t, Move>> find_rests() const {
    std::vector<std::pair<std::size_t, Move>> rests;
    for (std::size_t begin = 0; begin < moves_.size();) {
      std::size_t end = begin;
      while (end < moves_.size() && lifted_[end] <= 0.0) ++end;
      if (end > begin) {
        Move sum = Move::Zero();
        int ends = 0;
        if (begin > 0) sum += moves_[begin - 1], ++ends;
        if (end < moves_.size()) sum += moves_[end], ++ends;
        // The displacement of an object that is never lifted is zero.
        if (ends > 0) sum /= ends;
        sum[2] = sum[3] = sum[4] = 0.0;
        for (std::size_t t = begin; t < end; ++t) rests.emplace_back(t, sum);
      }
      begin = end + 1;
    }
    return rests;
  }

  void smooth() {
    const std::vector<Move> before = moves_;
    const int count = static_cast<int>(before.size());
    for (int t = 0; t < count; ++t) {
      const int reach = std::min({reach_, t, count - 1 - t});
      Move sum = Move::Zero();
      for (int k = t - reach; k <= t + reach; ++k) sum += before[at(k)];
      moves_[at(t)] = sum / (2 * reach + 1);
    }
  }

  const FitModel& model_;
  std::size_t body_;
  int reach_;
  FitScene& scene_;
  Vector3d com_;
  std::vector<std::optional<Move>> found_;  // One per frame.
  std::vector<Move> moves_;
  std::vector<double> lifted_;
};

}  // namespace

std::vector<ObjectMove> follow_hands(const FitModel& model, std::span<const double> qpos,
                                     double frame_time, FitScene& scene) {
  const SceneWorld& world = scene.world;
  std::vector<ObjectFollower> followers;
  std::vector<std::size_t> bodies;
  for (std::size_t body = 0; body < world.body_count(); ++body) {
    if (!world.moves(body)) continue;
    followers.emplace_back(model, body, frame_time, scene);
    bodies.push_back(body);
  }
  if (followers.empty()) return {};
  TreeState pose(model.tree);
  for (int frame = 0; frame < world.clip.frame_count; ++frame) {
    if (scene.goals_of(frame).empty()) continue;
    pose.update(
        qpos.subspan(at(frame) * at(model.configuration_size), at(model.configuration_size)));
    for (ObjectFollower& follower : followers) follower.read(frame, pose);
  }
  const SceneSupports supports(world, 0, world.clip.frame_count);
  std::vector<ObjectMove> moved;
  for (std::size_t i = 0; i < followers.size(); ++i) {
    if (!followers[i].is_held()) continue;
    followers[i].plan(supports);
    moved.push_back({world.clip.scene->bodies[bodies[i]].name, followers[i].apply()});
  }
  return moved;
}

}  // namespace retarget
