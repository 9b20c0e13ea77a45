#include "formats/smpl/places_layout.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <utility>

#include "formats/smpl/joint_motion.h"
#include "retarget/statistics.h"
#include "retarget/text.h"

namespace retarget {
namespace {

// In order of precedence.
constexpr const char* kUsualPlaces[] = {"global_joint_positions",
                                        "posed_joints",
                                        "joint_positions",
                                        "new_joints",
                                        "joints3d",
                                        "joints",
                                        "positions",
                                        "keypoints3d",
                                        "keypoints_3d",
                                        "motion"};
// Other names, in lower case without separators, in order of precedence.
constexpr std::string_view kOfHolosoma = "globaljointpositions";
constexpr std::string_view kPlaces[] = {
    kOfHolosoma,
    "posedjoints",
    "jointpositions",
    "newjoints",
    "joints3d",
    "joint3d",
    "joints",
    "positions",
    "positions3d",
    "keypoints3d",
    "predkeypoints3d",
    "predjoints3d",
    "kpts3d",
    "kp3d",
    "poses3d",
    "pose3d",
    "predxyz24struct",
    "predxyz17",
    "keypoints",
    "poseworldlandmarks",
    "worldlandmarks",
    "landmarks",
    "xyz",
    "motion",
};

std::string without_separators(std::string_view name) {
  std::string letters = lower_case(std::string(name));
  std::erase_if(letters, [](char c) { return c == '_' || c == '-' || c == ' '; });
  return letters;
}

bool is_known_count(std::size_t joints) {
  return std::ranges::any_of(
      joint_orders(), [&](const JointOrder& order) { return order.joint_count() == joints; });
}

// Distances between neighbours along an axis: their median and the largest one.
struct Steps {
  double usual, most;
};

// Steps along one of the first two axes of (a, b, joints, 3); empty without present neighbours.
std::optional<Steps> steps_along(const std::vector<double>& values, const PlacesLayout& layout,
                                 bool first_axis) {
  constexpr std::size_t kMostSteps = 20'000;
  const std::size_t row = 3 * layout.joints, block = layout.frames * row;
  const std::size_t reach = first_axis ? block : row;
  std::size_t stride = 1 + values.size() / 3 / kMostSteps;
  while (std::gcd(stride, layout.joints) > 1) ++stride;  // Visits all joints.
  std::vector<double> steps;
  for (std::size_t at = 0; at < values.size(); at += 3 * stride) {
    const bool is_last = first_axis ? at + reach >= values.size() : at % block + reach >= block;
    if (is_last) continue;
    const Eigen::Vector3d from(&values[at]), to(&values[at + reach]);
    if (!is_tracked(from) || !is_tracked(to)) continue;
    const double step = (to - from).norm();
    if (std::isfinite(step)) steps.push_back(step);
  }
  if (steps.empty()) return std::nullopt;
  const double most = std::ranges::max(steps);
  return Steps{median(std::move(steps)), most};
}

}  // namespace

std::string places_of(const ArraySource& file) {
  // Usual names come first: other arrays beside them are often 2-D points or text.
  for (const char* name : kUsualPlaces) {
    if (file.has(name)) return name;
  }
  std::string found;
  auto best = std::ranges::end(kPlaces);
  for (std::string& name : file.names()) {
    const auto at = std::ranges::find(kPlaces, without_separators(name));
    if (at >= best) continue;
    best = at;
    found = std::move(name);
  }
  return found;
}

bool is_of_holosoma(std::string_view name) {
  return without_separators(name) == kOfHolosoma;
}

std::optional<PlacesLayout> layout_of(const std::vector<std::size_t>& shape,
                                      std::size_t named_joints) {
  PlacesLayout layout;
  const std::size_t n = shape.size();
  // A 2-D table with x, y, z of successive joints is ambiguous without joint names.
  if (n == 2 && named_joints > 0 && shape[1] == 3 * named_joints) {
    layout.frames = shape[0];
    layout.joints = named_joints;
    return layout;
  }
  if (n != 3 && n != 4) return std::nullopt;
  if (n == 4) layout.samples = shape[0];
  const std::size_t a = shape[n - 3], b = shape[n - 2], c = shape[n - 1];
  const auto is_meant = [&](std::size_t joints) {
    return named_joints > 0 ? joints == named_joints : is_known_count(joints);
  };
  layout.frames_last = b == 3 && (c != 3 || (is_meant(a) && !is_meant(b)));
  if (!layout.frames_last && c != 3) return std::nullopt;
  layout.frames = layout.frames_last ? c : a;
  layout.joints = layout.frames_last ? a : b;
  // Two axes of size 3 are ambiguous unless the number of joints is known.
  if (layout.frames_last && !is_meant(layout.joints)) return std::nullopt;
  return layout;
}

std::optional<PlacesLayout> settle_people(const PlacesLayout& layout,
                                          const std::vector<double>& values) {
  constexpr std::size_t kMostPeople = 10;
  constexpr double kMuchLess = 0.5;
  if (layout.frames_last || layout.samples <= layout.frames) return layout;
  PlacesLayout people = layout;
  std::swap(people.samples, people.frames);
  people.are_people = true;
  if (people.samples == 1) return people;
  const auto first = steps_along(values, layout, true);
  const auto second = steps_along(values, layout, false);
  // Copies of one motion do not move, and an absent person has no present neighbour.
  const bool first_moves = first && first->most > 0.0, second_moves = second && second->most > 0.0;
  if (first_moves) {
    if (!second_moves || first->usual < kMuchLess * second->usual) return people;
    if (second->usual < kMuchLess * first->usual) return layout;
  }
  const bool may_be_people = layout.frames <= kMostPeople && layout.samples > kMostPeople;
  return may_be_people ? std::nullopt : std::optional(layout);
}

bool is_absent_sample(const PlacesLayout& layout, std::size_t sample,
                      const std::vector<double>& values) {
  for (std::size_t frame = 0; frame < layout.frames; ++frame) {
    for (std::size_t joint = 0; joint < layout.joints; ++joint) {
      const auto value = [&](std::size_t axis) {
        return values[layout.index(sample, frame, joint, axis)];
      };
      if (is_tracked({value(0), value(1), value(2)})) return false;
    }
  }
  return true;
}

}  // namespace retarget
