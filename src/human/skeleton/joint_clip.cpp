#include "human/skeleton/joint_clip.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <set>
#include <utility>

#include "base/option_name.h"
#include "base/try.h"
#include "human/skeleton/calibrate.h"
#include "human/skeleton/exchanged_sides.h"
#include "human/skeleton/joint_names.h"
#include "human/skeleton/joint_tree.h"
#include "human/skeleton/limb_directions.h"
#include "human/skeleton/posed_body.h"
#include "human/skeleton/recognise.h"
#include "retarget/clip_arrays.h"
#include "retarget/human_skeleton.h"
#include "retarget/so3.h"
#include "retarget/statistics.h"
#include "retarget/text.h"
#include "retarget/trigonometry.h"

namespace retarget {
namespace {

using enum LimbBone;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kFixedOffset = 1e-5;

// A tree and the name of its known joint order; the order is empty if the file has joint names.
struct FoundTree {
  JointTree tree;
  std::string order;
  bool is_exchanged = false;  // The sides of the named joints were exchanged.
};

Result<FoundTree> tree_of_names(const JointMotion& motion, const std::string& name) {
  std::set<std::string_view> known;
  for (const std::string& joint : motion.names) {
    if (joint.empty()) return input_failure(name, "a joint name is empty");
    if (known.insert(joint).second) continue;
    return input_failure(name, fmt::format("two joints are called \"{}\"", joint),
                         "give every joint a unique name");
  }
  auto tree = joint_tree(motion, motion.names);
  if (tree && motion.rotations.empty() && sides_are_exchanged(*tree)) {
    tree = joint_tree(with_exchanged_sides(motion), motion.names);
    if (tree && !sides_are_exchanged(*tree)) return FoundTree{*std::move(tree), {}, true};
    tree = joint_tree(motion, motion.names);
  }
  if (tree) return FoundTree{*std::move(tree), {}};
  return input_failure(
      name, "no human found in the joints " + list_names(motion.names, 8),
      "use names such as left_hip, left_knee, left_ankle, left_shoulder, left_elbow, left_wrist");
}

// Returns the tree of the only known joint order that fits the positions.
Result<FoundTree> tree_of_known_order(const JointMotion& motion, const std::string& name) {
  const std::string hint =
      OPTION("joint-names") " FILE gives the joint names in the file's order, one per line";
  std::optional<FoundTree> found;
  std::vector<std::string> fitting, tried;
  for (const JointOrder& order : joint_orders()) {
    if (order.joint_count() != static_cast<std::size_t>(motion.joint_count)) continue;
    tried.emplace_back(order.name);
    const std::vector<std::string> names = order.names();
    JointMotion read;
    read.frame_count = motion.frame_count;
    read.joint_count = static_cast<int>(names.size());
    for (int frame = 0; frame < motion.frame_count; ++frame) {
      const auto* const first = &motion.position(frame, 0);
      read.positions.insert(read.positions.end(), first, first + read.joint_count);
    }
    auto tree = joint_tree(read, names);
    if (!tree || !misfit_of_body(*tree)) continue;
    fitting.emplace_back(order.name);
    found = FoundTree{*std::move(tree), std::string(order.name)};
  }
  if (fitting.size() == 1) return *std::move(found);
  const std::string joints = count_text(motion.joint_count, "joint");
  if (fitting.size() > 1) {
    return input_failure(
        name,
        fmt::format("the {} match more than one joint order: {}", joints, list_names(fitting)),
        hint);
  }
  if (tried.empty()) {
    return input_failure(name, fmt::format("no known joint order has {}", joints), hint);
  }
  return input_failure(
      name,
      fmt::format("the positions of the {} do not form a human in the joint order of {}", joints,
                  list_names(tried)),
      hint);
}

// The foot's joint if the foot has no toes, otherwise -1.
int foot_without_toes(const JointTree& tree, Side side) {
  const bool has_toes = tree.joint_of_bone[side_bone(side, kToe)] >= 0;
  return has_toes ? -1 : tree.joint_of_bone[side_bone(side, kFoot)];
}

// World rotations of all joints; each joint has one per frame.
using WorldRotations = std::vector<std::vector<Matrix3d>>;

class RotationMaker {
 public:
  explicit RotationMaker(const JointTree& tree) : tree_(tree) {}

  // Returns rotations that are identity in the T-pose. @param origin  of the positions
  WorldRotations make(FrameRate rate, const ClipOrigin& origin) {
    Clip raw = raw_clip(rate);
    raw.set_origin(origin);
    BoneMap map;
    map.profile = "names";
    map.joint_of_bone = tree_.joint_of_bone;
    for (int& joint : map.joint_of_bone) joint = joint < 0 ? -1 : place_[joint];
    map.partial = true;
    make_rotations_from_directions(raw, map, StraightLimbs::kTurnWithTrunk);
    CalibrationOptions options;
    options.unit_optional = true;
    const auto calibration = calibrate(raw, map, options);
    const Matrix3d human_from_file =
        calibration ? calibration->human_from_source : Matrix3d(Matrix3d::Identity());
    std::vector<std::optional<Matrix3d>> turns(tree_.names.size());
    for (const Bone bone : kMappedBones) {
      const int joint = map.joint(bone);
      if (joint < 0) continue;
      Matrix3d joint_from_bone = Matrix3d::Identity();
      if (calibration) {
        const BoneSource& source = calibration->bones[bone];
        if (source.rotation_joint == joint && source.joint_from_bone) {
          joint_from_bone = source.joint_from_bone->toRotationMatrix();
        }
      }
      turns[joint] = joint_from_bone * canonical_t_pose(bone).transpose() * human_from_file;
    }
    WorldRotations world(tree_.names.size());
    for (int frame = 0; frame < raw.frame_count(); ++frame) {
      const JointPoses poses = frame_pose(raw, frame);
      for (int at = 0; at < raw.skeleton().joint_count(); ++at) {
        const int parent = raw.skeleton().joint(at).parent;
        world[order_[at]].push_back(
            turns[at]    ? Matrix3d(poses[at].rotation.toRotationMatrix() * *turns[at])
            : parent < 0 ? Matrix3d(Matrix3d::Identity())
                         : world[order_[parent]].back());
      }
    }
    for (const Side side : kSides) {
      turn_hand(side, human_from_file, world);
      if (!calibration) continue;
      level_foot_without_toes(side, raw.rate(), human_from_file, world);
      bend_toes(side, raw.rate(), human_from_file, world);
    }
    return world;
  }

  // Joints with unknown rotations, by name: hands without knuckles, feet without toes, and the
  // head.
  [[nodiscard]] std::vector<std::string> unknown() const {
    std::vector<std::string> names;
    const auto add = [&](Bone bone) {
      const int joint = tree_.joint_of_bone[bone];
      if (joint >= 0) names.push_back(tree_.names[joint]);
    };
    for (const Side side : kSides) {
      if (!knuckles(side)) add(side_bone(side, kHand));
      if (foot_without_toes(tree_, side) >= 0) add(side_bone(side, kFoot));
    }
    add(Bone::kHead);
    return names;
  }

 private:
  // Builds a clip with joints in depth-first order, with translations and identity rotations.
  Clip raw_clip(FrameRate rate) {
    const auto count = static_cast<int>(tree_.names.size());
    std::vector<std::vector<int>> children(tree_.names.size());
    std::vector<int> waiting;
    for (int joint = count - 1; joint >= 0; --joint) {
      if (tree_.parents[joint] >= 0) {
        children[tree_.parents[joint]].push_back(joint);
      } else {
        waiting.push_back(joint);
      }
    }
    place_.assign(tree_.names.size(), -1);
    std::vector<Joint> joints;
    while (!waiting.empty()) {
      const int joint = waiting.back();
      waiting.pop_back();
      place_[joint] = static_cast<int>(joints.size());
      order_.push_back(joint);
      const int parent = tree_.parents[joint];
      joints.push_back({tree_.names[joint],
                        parent < 0 ? -1 : place_[parent],
                        Vector3d::Zero(),
                        {},
                        {Channel::kXPosition, Channel::kYPosition, Channel::kZPosition,
                         Channel::kZRotation, Channel::kYRotation, Channel::kXRotation}});
      waiting.insert(waiting.end(), children[joint].begin(), children[joint].end());
    }
    Clip clip(std::make_shared<const Skeleton>(std::move(joints)), rate, tree_.frame_count());
    for (int frame = 0; frame < clip.frame_count(); ++frame) {
      for (int at = 0; at < count; ++at) {
        const int joint = order_[at], parent = tree_.parents[joint];
        const Vector3d& place = tree_.tracks[joint][frame];
        clip.translations(frame)[at] =
            parent < 0 ? place : Vector3d(place - tree_.tracks[parent][frame]);
      }
    }
    return clip;
  }

  // First joints of the index, middle and little finger.
  struct Knuckles {
    int index = -1, middle = -1, little = -1;
  };
  [[nodiscard]] std::optional<Knuckles> knuckles(Side side) const {
    if (tree_.joint_of_bone[side_bone(side, kHand)] < 0) return std::nullopt;
    const std::vector<JointName> words = normalise_joint_names(tree_.names);
    Knuckles found;
    for (std::size_t joint = 0; joint < words.size(); ++joint) {
      if (words[joint].side != side) continue;
      const std::string& base = words[joint].base;
      if (base.ends_with("index1")) found.index = static_cast<int>(joint);
      if (base.ends_with("middle1")) found.middle = static_cast<int>(joint);
      if (base.ends_with("pinky1") || base.ends_with("little1")) {
        found.little = static_cast<int>(joint);
      }
    }
    if (found.index < 0 || found.little < 0 || found.middle < 0) return std::nullopt;
    return found;
  }

  // The palm plane contains the wrist and the knuckles. The direction from the index to
  // the little finger is backwards in the T-pose.
  void turn_hand(Side side, const Matrix3d& human_from_file, WorldRotations& world) const {
    const auto found = knuckles(side);
    if (!found) return;
    const Bone bone = side_bone(side, kHand);
    const int hand = tree_.joint_of_bone[bone];
    const Matrix3d bone_from_file = canonical_t_pose(bone).transpose() * human_from_file;
    for (int frame = 0; frame < tree_.frame_count(); ++frame) {
      const Vector3d x =
          (tree_.tracks[found->middle][frame] - tree_.tracks[hand][frame]).normalized();
      const Vector3d back = tree_.tracks[found->little][frame] - tree_.tracks[found->index][frame];
      const Vector3d y = (back - back.dot(x) * x).normalized();
      if (!(x.cross(y).norm() > 0.5)) continue;
      Matrix3d axes;
      axes << x, y, x.cross(y);
      world[hand][frame] = axes * bone_from_file;
      for (std::size_t joint = 0; joint < tree_.names.size(); ++joint) {
        if (is_below(static_cast<int>(joint), hand)) {
          world[joint][frame] = world[hand][frame];
        }
      }
    }
  }

  // A foot without toes turns with its shin. Removes its tilt while it may stand: its ankle rests,
  // and the shin is not far from the vertical.
  void level_foot_without_toes(Side side, FrameRate rate, const Matrix3d& human_from_file,
                               WorldRotations& world) const {
    constexpr double kStands = 0.6, kLies = 1.05;  // Tilt of the shin, rad.
    const int foot = foot_without_toes(tree_, side);
    if (foot < 0) return;
    const Vector3d up = human_from_file.row(2);
    for (int frame = 0; frame < tree_.frame_count(); ++frame) {
      const double leg = leg_length(side, frame);
      if (!(leg > 0.0)) continue;
      Matrix3d& rotation = world[foot][frame];
      // Rotations are identity in the T-pose, in which feet are level.
      const Vector3d tilted = rotation * up;
      const double tilt = portable::atan2(up.cross(tilted).norm(), up.dot(tilted));
      const double upright = std::clamp((kLies - tilt) / (kLies - kStands), 0.0, 1.0);
      const double removed = upright * rests(foot, frame, rate, leg) * tilt;
      if (removed == 0.0) continue;
      const Vector3d axis = up.cross(tilted).normalized();
      rotation = exp_so3(-removed * axis) * rotation;
    }
  }

  // Speed around a frame in leg lengths per second.
  [[nodiscard]] double speed(int joint, int frame, FrameRate rate, double leg) const {
    const int reach = std::max(1, static_cast<int>(std::lround(0.05 * rate.fps())));
    const int first = std::max(0, frame - reach);
    const int last = std::min(tree_.frame_count() - 1, frame + reach);
    if (last == first) return 0.0;
    const double way = (tree_.tracks[joint][last] - tree_.tracks[joint][first]).norm();
    return way * rate.fps() / (leg * (last - first));
  }

  // 1 for a resting joint, 0 for a swinging one.
  [[nodiscard]] double rests(int joint, int frame, FrameRate rate, double leg) const {
    constexpr double kRests = 0.5, kSwings = 1.5;  // Legs/s.
    return std::clamp((kSwings - speed(joint, frame, rate, leg)) / (kSwings - kRests), 0.0, 1.0);
  }

  // Of the bones of a leg in a frame; 0 if a joint is missing.
  [[nodiscard]] double leg_length(Side side, int frame) const {
    const int hip = tree_.joint_of_bone[side_bone(side, kUpLeg)];
    const int knee = tree_.joint_of_bone[side_bone(side, kLeg)];
    const int foot = tree_.joint_of_bone[side_bone(side, kFoot)];
    if (hip < 0 || knee < 0 || foot < 0) return 0.0;
    return (tree_.tracks[hip][frame] - tree_.tracks[knee][frame]).norm() +
           (tree_.tracks[knee][frame] - tree_.tracks[foot][frame]).norm();
  }

  // Levels the toes if the ball of the foot rests while the heel is raised.
  void bend_toes(Side side, FrameRate rate, const Matrix3d& human_from_file,
                 WorldRotations& world) const {
    const Bone bone = side_bone(side, kToe);
    const int toe = tree_.joint_of_bone[bone];
    if (toe < 0) return;
    // The largest bend, and the slope of the foot above which the toes do not bend (rad).
    constexpr double kMost = 0.8, kFar = 1.5;
    const Matrix3d bone_from_file = canonical_t_pose(bone).transpose() * human_from_file;
    const Vector3d up = human_from_file.row(2);
    for (int frame = 0; frame < tree_.frame_count(); ++frame) {
      const double leg = leg_length(side, frame);
      if (!(leg > 0.0)) continue;
      const Matrix3d world_from_bone = world[toe][frame] * bone_from_file.transpose();
      const double down =
          portable::atan2(-world_from_bone.col(0).dot(up), world_from_bone.col(1).dot(up));
      const double bends = std::clamp((kFar - down) / (kFar - kMost), 0.0, 1.0);
      if (!(down > 0.0)) continue;
      const double angle = rests(toe, frame, rate, leg) * bends * std::min(down, kMost);
      world[toe][frame] = world_from_bone * exp_so3(angle * Vector3d::UnitZ()) * bone_from_file;
    }
  }

  [[nodiscard]] bool is_below(int joint, int upper) const {
    for (int at = tree_.parents[joint]; at >= 0; at = tree_.parents[at]) {
      if (at == upper) return true;
    }
    return false;
  }

  const JointTree& tree_;
  std::vector<int> place_, order_;  // Joint of the tree to joint of the clip, and the inverse.
};

WorldRotations rotations_of_file(const JointMotion& motion) {
  WorldRotations world(static_cast<std::size_t>(motion.joint_count));
  for (int frame = 0; frame < motion.frame_count; ++frame) {
    for (int joint = 0; joint < motion.joint_count; ++joint) {
      world[joint].push_back(motion.rotations[motion.index(frame, joint)].toRotationMatrix());
    }
  }
  return world;
}

Result<Clip> clip_of_poses(const JointTree& tree, const WorldRotations& world, FrameRate rate) {
  std::vector<double> positions, rotations;
  positions.reserve(3 * tree.tracks.size() * tree.tracks.front().size());
  rotations.reserve(4 * tree.tracks.size() * tree.tracks.front().size());
  for (int frame = 0; frame < tree.frame_count(); ++frame) {
    for (std::size_t joint = 0; joint < tree.tracks.size(); ++joint) {
      const Vector3d& place = tree.tracks[joint][frame];
      positions.insert(positions.end(), {place.x(), place.y(), place.z()});
      const Eigen::Quaterniond q = Eigen::Quaterniond(world[joint][frame]).normalized();
      rotations.insert(rotations.end(), {q.w(), q.x(), q.y(), q.z()});
    }
  }
  ClipArrays arrays;
  arrays.names = tree.names;
  arrays.parents = tree.parents;
  arrays.positions = positions;
  arrays.rotations = rotations;
  arrays.frames = static_cast<std::size_t>(tree.frame_count());
  arrays.rate = rate;
  arrays.fixed_offset = kFixedOffset;
  return clip_from_arrays(arrays);
}

// Sets OFFSETs of joints with translations to their median lengths, because single frames may be
// far off.
Clip with_median_offsets(const Clip& clip) {
  std::vector<Joint> joints = clip.skeleton().joints();
  for (int at = 1; at < clip.skeleton().joint_count(); ++at) {
    if (clip.skeleton().translation_slot(at) < 0) continue;
    std::vector<double> lengths;
    for (int frame = 0; frame < clip.frame_count(); ++frame) {
      lengths.push_back(clip.translation(frame, at).norm());
    }
    const double length = joints[at].offset.norm();
    if (length > 0.0) joints[at].offset *= median(lengths) / length;
  }
  Clip made(std::make_shared<const Skeleton>(std::move(joints)), clip.rate(), clip.frame_count());
  for (int frame = 0; frame < clip.frame_count(); ++frame) copy_frame(clip, frame, made, frame);
  return made;
}

std::vector<Warning> warnings_of(const FoundTree& found, const std::vector<std::string>& unknown) {
  std::vector<std::string> texts;
  if (!found.order.empty()) {
    texts.push_back(fmt::format(
        "the joints have no names; the positions match the joint order of {}", found.order));
  }
  if (found.is_exchanged) {
    texts.emplace_back(
        "knees bend and toes point backwards, so the names or the axes exchange left and right: the "
        "names are exchanged back; if the axes are mirrored, " OPTION("mirror") " corrects the "
        "motion");
  }
  if (!found.tree.made.empty()) {
    texts.push_back(fmt::format("no joints for {}: placed midway between left and right",
                                list_names(found.tree.made)));
  }
  const bool has_level_feet = std::ranges::any_of(
      kSides, [&](Side side) { return foot_without_toes(found.tree, side) >= 0; });
  texts.push_back(fmt::format(
      "joint positions without rotations: rotations were computed from limb directions "
      "and bending planes; the rotation of {} about {} is unknown and follows neighbouring "
      "joints{}",
      list_names(unknown), unknown.size() == 1 ? "itself" : "themselves",
      has_level_feet ? ", except feet that can stand, which are level" : ""));
  constexpr double kSteadyLength = 0.02;
  if (const double change = limb_length_change(found.tree); change > kSteadyLength) {
    texts.push_back(
        fmt::format("limb lengths vary by {:.0f} % (standard deviation)", 100.0 * change));
  }
  std::vector<Warning> warnings;
  for (std::string& text : texts) warnings.push_back({0, 0, std::move(text)});
  return warnings;
}

}  // namespace

Result<Clip> clip_of_joints(const JointMotion& motion, const std::string& name) {
  // Larger coordinates exceed every unit, and their products could overflow.
  constexpr double kFar = 1e9;
  for (const Vector3d& place : motion.positions) {
    if (place.cwiseAbs().maxCoeff() > kFar) {
      return input_failure(name, fmt::format("a joint coordinate of {:g} is out of range",
                                             place.cwiseAbs().maxCoeff()));
    }
  }
  TRY_ASSIGN(const FoundTree found, motion.names.empty() ? tree_of_known_order(motion, name)
                                                         : tree_of_names(motion, name));
  if (!found.order.empty() && !motion.order_of_rate.empty() &&
      found.order != motion.order_of_rate) {
    return input_failure(name,
                         "no frame rate: the file states none, and motions in the joint order of " +
                             found.order + " have no usual one",
                         "give the frame rate with " OPTION("source-fps"));
  }
  ClipOrigin origin;
  origin.name = name;
  origin.body_height = motion.height;
  origin.up = motion.up;
  origin.warnings = motion.warnings;
  WorldRotations world;
  if (motion.rotations.empty() || !found.tree.made.empty()) {
    RotationMaker maker(found.tree);
    world = maker.make(motion.rate, origin);
    origin.unknown_rotations = maker.unknown();
    const auto said = warnings_of(found, origin.unknown_rotations);
    origin.warnings.insert(origin.warnings.end(), said.begin(), said.end());
  } else {
    world = rotations_of_file(motion);
  }
  TRY_ASSIGN(Clip clip, clip_of_poses(found.tree, world, motion.rate));
  clip = with_median_offsets(clip);
  make_sign_continuous(clip);
  clip.set_origin(std::move(origin));
  if (motion.no_rate) {
    Error error = *motion.no_rate;
    RecogniseOptions options;
    options.partial = true;
    // A bone map or a profile may still make it a human.
    if (const auto human = recognise_skeleton(clip, {}, options); !human) {
      error.hint += "; the joints are not recognised, either: " + human.error().message;
    }
    return failure(std::move(error));
  }
  return clip;
}

}  // namespace retarget
