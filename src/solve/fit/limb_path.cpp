#include "solve/fit/limb_path.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>

#include "solve/fit/shorthand.h"

namespace retarget {
namespace {

constexpr double kSpacing = 0.14;          // Largest spacing of the first joint's grid, rad.
constexpr double kLayerTime = 1.0 / 30.0;  // Seconds between two layers.
// Weight of a joint's speed, per rad/s; it approximates the smoothness term.
constexpr double kMoveWeight = 0.2;
// Weight of the excess over a joint's maximum speed, per rad/s.
constexpr double kTooFastWeight = 30.0;
constexpr double kClearlyBetter = 0.8;  // Share of the cost of the current path.

}  // namespace

LimbPathFinder::LimbPathFinder(const FitModel& model, const FitOptions& options,
                               const FitClip& clip, const FitLimb& limb)
    : options_(options),
      frame_time_(clip.frame_time),
      frame_count_(clip.frame_count),
      frame_(model, clip, limb) {
  for (const int link : limb.links) {
    max_speed_.push_back(
        std::min(options.max_joint_speed, model.speed_limit[at(KinematicTree::dof_of(link))]));
  }
  // A joint without limits covers a full turn.
  lowest_ = std::max(frame_.limits().lower[0], -std::numbers::pi);
  const double range = std::min(frame_.limits().upper[0], std::numbers::pi) - lowest_;
  if (!(range > 0.0)) return;
  positions_ = 1 + static_cast<int>(std::ceil(range / kSpacing));
  spacing_ = range / (positions_ - 1);
}

LimbPathFinder::Node LimbPathFinder::own_node(int frame, int frames) {
  frame_.set(frame);
  return {.joints = frame_.joints(), .tracking = frames * frame_.cost()};
}

// Solves the limb with its first joint at a point of the grid and the others inside `range`.
LimbPathFinder::Node LimbPathFinder::solved(const LimbJoints& start, int index, LimbRange range,
                                            int frames) {
  LimbJoints joints = start;
  joints[0] = range.lower[0] = range.upper[0] = position(index);
  frame_.place(joints);
  const double cost = frame_.solve(range);
  return {.joints = frame_.joints(), .tracking = frames * cost};
}

// Solves the limb in a frame at all points of the grid. Each solve starts from the neighbour nearer
// to `start`, so that neighbours stay on the same branch.
LimbPathFinder::Layer LimbPathFinder::solve_grid(int frame, const LimbJoints& start, int frames) {
  frame_.set(frame);
  Layer grid(at(positions_));
  const int nearest =
      spacing_ > 0.0 ? std::clamp(static_cast<int>(std::lround((start[0] - lowest_) / spacing_)), 0,
                                  positions_ - 1)
                     : 0;
  grid[at(nearest)] = solved(start, nearest, frame_.limits(), frames);
  for (int k = nearest + 1; k < positions_; ++k) {
    grid[at(k)] = solved(grid[at(k - 1)].joints, k, frame_.limits(), frames);
  }
  for (int k = nearest - 1; k >= 0; --k) {
    grid[at(k)] = solved(grid[at(k + 1)].joints, k, frame_.limits(), frames);
  }
  return grid;
}

// Follows configurations on other branches through all layers of the interval, in both directions.
// @return the best configurations at the points of the grid, by layer.
std::vector<LimbPathFinder::Layer> LimbPathFinder::follow(std::span<const LimbPlace> others,
                                                          const std::vector<int>& frames) {
  std::vector<Layer> layers(frames.size());
  if (others.empty()) return layers;
  const auto keep_better = [](const Layer& found, Layer& layer) {
    if (layer.empty()) layer = found;
    for (std::size_t k = 0; k < found.size(); ++k) {
      if (found[k].tracking < layer[k].tracking) layer[k] = found[k];
    }
  };
  const auto frames_before = [&](std::size_t i) { return i > 0 ? frames[i] - frames[i - 1] : 1; };
  for (const LimbPlace& other : others) {
    const auto next = std::ranges::lower_bound(frames, other.frame);
    const auto i = std::min(static_cast<std::size_t>(next - frames.begin()), frames.size() - 1);
    keep_better(solve_grid(frames[i], other.joints, frames_before(i)), layers[i]);
  }
  const auto follow_from = [&](const Layer& from, std::size_t i) {
    if (from.empty()) return;
    frame_.set(frames[i]);
    Layer found(from.size());
    for (std::size_t k = 0; k < from.size(); ++k) {
      found[k] = solved(from[k].joints, static_cast<int>(k), frame_.limits(), frames_before(i));
    }
    keep_better(found, layers[i]);
  };
  for (std::size_t i = 1; i < layers.size(); ++i) follow_from(layers[i - 1], i);
  for (std::size_t i = layers.size() - 1; i > 0; --i) follow_from(layers[i], i - 1);
  return layers;
}

// A layer contains the current configuration and, for each position of the first joint, the best
// configuration, the best one on another branch (`other`, may be empty) and the best one within
// reach of the previous layer. The latter allow a path to lag behind targets that are faster than
// the joints.
LimbPathFinder::Layer LimbPathFinder::solve_layer(int frame, const Layer& before,
                                                  const Layer& other, int frames) {
  const Node own = own_node(frame, frames);
  Layer layer{own};
  std::ranges::copy(solve_grid(frame, own.joints, frames), std::back_inserter(layer));
  std::ranges::copy(other, std::back_inserter(layer));
  if (before.empty()) return layer;
  // Almost the largest speed without a cost in the fit. At exactly this speed, rounding would decide
  // about the stiffness of the fit's next step.
  const double reach = 0.99 * options_.soft_joint_speed * frames * frame_time_;
  for (int k = 0; k < positions_; ++k) {
    const Node* from = &before[before.size() > 1 ? at(1 + k) : 0];
    for (std::size_t i = at(1 + k); i < before.size(); i += at(positions_)) {
      if (before[i].total < from->total) from = &before[i];
    }
    layer.push_back(solved(from->joints, k, frame_.within_reach(from->joints, reach), frames));
  }
  return layer;
}

double LimbPathFinder::move_cost(const LimbJoints& from, const LimbJoints& to, int frames) const {
  double cost = 0.0;
  for (std::size_t i = 0; i < count(); ++i) {
    const double speed = std::abs(to[i] - from[i]) / (frames * frame_time_);
    cost += square(kMoveWeight * speed) +
            square(options_.speed_weight * std::max(0.0, speed - options_.soft_joint_speed)) +
            square(kTooFastWeight * std::max(0.0, speed - max_speed_[i]));
  }
  return frames * cost;
}

void LimbPathFinder::connect(const Layer& before, Layer& layer, int frames) const {
  for (Node& node : layer) {
    node.total = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < before.size(); ++i) {
      const double so_far = before[i].total + node.tracking;
      if (!(so_far < node.total)) continue;
      const double total = so_far + move_cost(before[i].joints, node.joints, frames);
      if (!(total < node.total)) continue;
      node.total = total;
      node.before = static_cast<int>(i);
    }
  }
}

LimbBranch LimbPathFinder::best_path(const std::vector<Layer>& layers,
                                     const std::vector<int>& frames) const {
  const int begin = frames.front(), end = frames.back() + 1;
  LimbBranch path{begin, end, std::vector<LimbJoints>(at(end - begin))};
  const Node* node = &*std::ranges::min_element(layers.back(), {}, &Node::total);
  path.joints.back() = node->joints;
  for (std::size_t i = layers.size() - 1; i > 0; --i) {
    const Node* const before = &layers[i - 1][at(node->before)];
    const int steps = frames[i] - frames[i - 1];
    for (int k = 0; k < steps; ++k) {
      LimbJoints& joints = path.joints[at(frames[i - 1] + k - begin)];
      for (std::size_t j = 0; j < count(); ++j) {
        joints[j] = before->joints[j] + (node->joints[j] - before->joints[j]) * k / steps;
      }
    }
    node = before;
  }
  return path;
}

std::optional<LimbBranch> LimbPathFinder::find(int begin, int end,
                                               std::span<const LimbPlace> others) {
  const int every = std::max(1, static_cast<int>(std::lround(kLayerTime / frame_time_)));
  if (end - begin < 3 * every) return std::nullopt;
  std::vector<int> frames;
  for (int frame = begin; frame < end - 1; frame += every) frames.push_back(frame);
  frames.push_back(end - 1);
  const std::vector<Layer> branches = follow(others, frames);
  std::vector<Layer> layers;
  Node own = own_node(begin, 1);
  own.total = own.tracking;
  layers.push_back(begin == 0 ? solve_layer(begin, {}, branches[0], 1) : Layer{own});
  for (Node& node : layers.front()) node.total = node.tracking;
  for (std::size_t i = 1; i < frames.size(); ++i) {
    const int step = frames[i] - frames[i - 1];
    Node next = own_node(frames[i], step);
    next.total = own.total + next.tracking + move_cost(own.joints, next.joints, step);
    own = next;
    const bool is_fixed = i + 1 == frames.size() && end < frame_count_;
    Layer layer = is_fixed ? Layer{own} : solve_layer(frames[i], layers.back(), branches[i], step);
    connect(layers.back(), layer, step);
    layers.push_back(std::move(layer));
  }
  const double best = std::ranges::min(layers.back(), {}, &Node::total).total;
  if (!(best < kClearlyBetter * own.total)) return std::nullopt;
  return best_path(layers, frames);
}

}  // namespace retarget
