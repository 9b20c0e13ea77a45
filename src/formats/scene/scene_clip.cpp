#include "formats/scene/read_scene.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "base/option_name.h"
#include "base/try.h"
#include "formats/containers/file_kind.h"
#include "formats/scene/clip_builder.h"
#include "formats/scene/scene_takes.h"
#include "formats/scene/scene_times.h"
#include "formats/scene/skeleton_shape.h"
#include "motion/clip.h"
#include "retarget/bvh.h"
#include "retarget/text.h"

namespace retarget {
namespace {

// Whether limbs extend along both directions of two axes, as with straight legs, spine and raised
// arms.
bool is_t_pose(const std::vector<WorldJoint>& joints) {
  constexpr double kAlong = 0.985;  // Cosine of ten degrees.
  constexpr double kMostBones = 0.85, kSide = 0.1;
  std::array<double, 6> along{};  // Bone length along +x, -x, +y, -y, +z, -z.
  double all = 0.0;
  for (const WorldJoint& joint : joints) {
    if (joint.parent < 0) continue;
    const Eigen::Vector3d bone = joint.world_from_rest.translation -
                                 joints[as_size(joint.parent)].world_from_rest.translation;
    const double length = bone.norm();
    all += length;
    for (int axis = 0; axis < 3; ++axis) {
      if (std::abs(bone[axis]) >= kAlong * length) {
        along[as_size(2 * axis + (bone[axis] < 0.0 ? 1 : 0))] += length;
        break;
      }
    }
  }
  int both_sides = 0;
  double straight = 0.0;
  for (std::size_t axis = 0; axis < 6; axis += 2) {
    straight += along[axis] + along[axis + 1];
    both_sides += std::min(along[axis], along[axis + 1]) >= kSide * all ? 1 : 0;
  }
  return both_sides >= 2 && straight >= kMostBones * all;
}

// Limits on the memory of a clip, because a few keys may span hours.
constexpr std::size_t kFreeClipBytes = std::size_t{256} << 20U;
constexpr std::size_t kMaxBytesOfFile = 256;
// Ratio of scales.
constexpr double kUneven = 1.01;
// A body with fingers, face and helpers has a few hundred.
constexpr std::size_t kMaxJoints = 5000;
// Frames that are searched for the rest pose in each of the other takes: an hour at 30 fps.
constexpr int kMaxSearchedFrames = 108'000;

class SceneSampler {
 public:
  SceneSampler(const SceneGraph& scene, const std::string& file_name,
               const SceneReadOptions& options)
      : scene_(scene), file_name_(file_name), options_(options) {}

  Result<Clip> run(std::size_t file_bytes) {
    TRY_ASSIGN(SceneMotionChoice choice, choose_motion(scene_, options_.take, options_.root,
                                                       options_.skeleton_only, file_name_));
    take_ = choice.take;
    skeleton_ = choice.skeleton;
    if (take_ >= 0 && !choice.moves && !options_.skeleton_only) warn_of_still_take();
    if (!choice.longer.empty()) warn_of_longer_takes(choice.longer);
    if (options_.root.empty() && !options_.skeleton_only) warn_of_other_actors();
    if (skeleton_.joints.size() > kMaxJoints) {
      return input_failure(file_name_,
                           fmt::format("the skeleton has {} joints; {} are allowed",
                                       skeleton_.joints.size(), kMaxJoints),
                           "export the armature of the body alone");
    }
    if (take_ < 0 && !options_.skeleton_only) {
      return input_failure(
          file_name_,
          fmt::format("the {} file holds no animation{}", scene_.format,
                      scene_.takes.empty() ? "" : " that moves its skeleton"),
          "export the character with its animation baked; retarget inspect " OPTION(
              "skeleton") " shows the joints of a file without one");
    }
    still_copies_ = drop_still_copies(scene_, take_, skeleton_);
    mark_chain();
    TRY(check_scale());
    const SceneTimes times(scene_, choice, in_chain_, options_.source_fps);
    TRY(times.check(file_name_));
    TRY_ASSIGN(const int frames, count_frames(times, choice, file_bytes));
    for (Warning& warning : times.warnings()) warnings_.push_back(std::move(warning));
    std::vector<WorldJoint> rest = rest_joints(rests_in_motion(times, frames));
    TRY(check_rest(rest));
    ClipBuilder builder(std::move(rest), times.rate(), frames);
    for (int frame = 0; frame < frames; ++frame) {
      TRY(place_nodes(frame, times.seconds_of(frame)));
      builder.set_frame(frame, joint_poses());
    }
    Clip clip = builder.build();
    clip.set_origin(origin(times, file_bytes));
    return clip;
  }

 private:
  // Marks the joints and all nodes above the root.
  void mark_chain() {
    in_chain_ = nodes_of_chain(scene_, skeleton_);
    has_joints_below_.assign(scene_.nodes.size(), false);
    for (std::size_t i = 0; i < scene_.nodes.size(); ++i) {
      if (!in_chain_[i]) continue;
      chain_.push_back(static_cast<int>(i));
      const int parent = scene_.nodes[i].parent;
      if (parent >= 0) has_joints_below_[as_size(parent)] = true;
    }
  }

  void warn_of_still_take() {
    warnings_.push_back({0, 0,
                         "the take \"" + printable(scene_.takes[as_size(take_)].name) +
                             "\" has no movement: all its skeleton keys are equal"});
  }

  void warn_of_longer_takes(const std::vector<std::string>& takes) {
    warnings_.push_back({0, 0,
                         fmt::format("longer takes move less than half as much of the body and are "
                                     "not read: {}; " OPTION("take") " NAME reads one",
                                     list_names(takes, 8))});
  }

  void warn_of_other_actors() {
    if (take_ < 0) return;
    std::string text = other_actors_text(scene_, skeleton_, take_);
    if (!text.empty()) warnings_.push_back({0, 0, std::move(text)});
  }

  std::string name_of(int node) const {
    const std::string name = printable(scene_.nodes[as_size(node)].name);
    return name.empty() ? "node " + std::to_string(node) : "\"" + name + "\"";
  }

  Failure mirrored(int node) const {
    return input_failure(file_name_,
                         name_of(node) +
                             " is mirrored by a negative scale, which a skeleton cannot "
                             "represent",
                         "apply the scale before the export (Blender: Object, Apply, Scale)");
  }

  Result<void> check_scale() {
    for (const int node : chain_) {
      const NodeTransform& rest = scene_.nodes[as_size(node)].rest;
      if (is_mirrored(rest)) return mirrored(node);
      const Eigen::Vector3d size = rest.scale.cwiseAbs();
      if (!uneven_ && size.maxCoeff() > kUneven * size.minCoeff() &&
          has_joints_below_[as_size(node)]) {
        uneven_ = true;
        warnings_.push_back({0, 0,
                             name_of(node) +
                                 " has a non-uniform scale, which skews the joints below it: their "
                                 "positions include the scale, their rotations ignore it"});
      }
    }
    return {};
  }

  Result<int> count_frames(const SceneTimes& times, const SceneMotionChoice& choice,
                           std::size_t file_bytes) const {
    if (take_ < 0) return 0;
    const double frames = times.frame_count();
    const std::size_t frame_bytes = ClipBuilder::frame_bytes(chain_.size());
    const double by_file = static_cast<double>(kFreeClipBytes) +
                           static_cast<double>(kMaxBytesOfFile) * static_cast<double>(file_bytes);
    const double most = std::min(static_cast<double>(options_.max_clip_bytes), by_file);
    if (!(frames * static_cast<double>(frame_bytes) <= most) || frames > 1e9) {
      const std::string hint = times.far_key_hint();
      return input_failure(file_name_,
                           fmt::format("the animation lasts {:.6g} s: its frames exceed the memory "
                                       "limit for this file size",
                                       choice.end - choice.begin),
                           hint.empty() ? kLargeFileHint : hint);
    }
    return static_cast<int>(frames);
  }

  // Whether to use zero angles as the zero pose. Without a skin that defines the bind pose, some
  // programs write the frame shown at export as the rest pose. This is the case if the rest pose
  // occurs in the motion. It may be a frame of another take, because all takes of a file have one
  // rest pose.
  bool rests_in_motion(const SceneTimes& times, int frames) const {
    const auto is_bound = [&](int joint) {
      return scene_.nodes[as_size(joint)].world_from_bind.has_value();
    };
    // Other formats have no zero angles to use. A rest pose that is a T-pose is the zero pose.
    if (scene_.format != "FBX" || std::ranges::any_of(skeleton_.joints, is_bound) ||
        is_t_pose(rest_joints(false))) {
      return false;
    }
    for (int frame = 0; frame < frames; ++frame) {
      if (rests_at(take_, times.seconds_of(frame))) return true;
    }
    for (int take = 0; take < static_cast<int>(scene_.takes.size()); ++take) {
      if (take != take_ && rests_in(take)) return true;
    }
    return false;
  }

  // Whether all joints are at rest at a time.
  bool rests_at(int take, double seconds) const {
    constexpr double kSame = 0.99999;  // Cosine of half of half a degree.
    return std::ranges::all_of(skeleton_.joints, [&](int joint) {
      const Eigen::Quaterniond now = scene_.motion->at(take, joint, seconds).rotation;
      return std::abs(now.dot(scene_.nodes[as_size(joint)].rest.rotation)) > kSame;
    });
  }

  // Whether a frame of another take that moves the skeleton is the rest pose. A take that holds a
  // reference pose is ignored.
  bool rests_in(int take) const {
    const std::vector<bool>& moves = scene_.takes[as_size(take)].moves;
    const bool is_moving =
        std::ranges::any_of(skeleton_.joints, [&](int joint) { return moves[as_size(joint)]; });
    if (!is_moving) return false;
    SceneMotionChoice other;
    other.take = take;
    set_extent(scene_, in_chain_, other);
    const SceneTimes times(scene_, other, in_chain_, options_.source_fps);
    const int frames = static_cast<int>(std::min<double>(times.frame_count(), kMaxSearchedFrames));
    for (int frame = 0; frame < frames; ++frame) {
      if (rests_at(take, times.seconds_of(frame))) return true;
    }
    return false;
  }

  // Rest poses: world_from_bind if there is one, otherwise the rest transform below the parent.
  std::vector<WorldJoint> rest_joints(bool is_unturned) const {
    std::vector<NodePlace> places(scene_.nodes.size());
    for (const int index : chain_) {
      const SceneNode& node = scene_.nodes[as_size(index)];
      NodeTransform rest = node.rest;
      if (is_unturned) rest.rotation = node.unturned;
      places[as_size(index)] =
          place_below(node.parent < 0 ? NodePlace() : places[as_size(node.parent)], rest);
      if (!node.world_from_bind) continue;
      places[as_size(index)] = {*node.world_from_bind, rotation_of(node.world_from_bind->linear())};
    }
    std::vector<std::string> names;
    for (const int joint : skeleton_.joints) names.push_back(scene_.nodes[as_size(joint)].name);
    names = plain_joint_names(std::move(names));
    std::vector<WorldJoint> joints;
    for (std::size_t j = 0; j < skeleton_.joints.size(); ++j) {
      const NodePlace& place = places[as_size(skeleton_.joints[j])];
      joints.push_back(
          {names[j], skeleton_.parents[j], {place.rotation, place.world_from_node.translation()}});
    }
    return joints;
  }

  [[nodiscard]] Result<void> check_rest(const std::vector<WorldJoint>& joints) const {
    for (const WorldJoint& joint : joints) {
      const Pose& rest = joint.world_from_rest;
      if (rest.translation.allFinite() && rest.rotation.coeffs().allFinite()) continue;
      return input_failure(file_name_,
                           "\"" + printable(joint.name) + "\" has a non-finite rest pose");
    }
    return {};
  }

  Result<void> place_nodes(int frame, double seconds) {
    places_.resize(scene_.nodes.size());
    for (const int node : chain_) {
      const NodeTransform local = scene_.motion->at(take_, node, seconds);
      const int parent = scene_.nodes[as_size(node)].parent;
      NodePlace& place = places_[as_size(node)];
      if (is_sound(local)) {
        place = place_below(parent < 0 ? NodePlace() : places_[as_size(parent)], local);
      }
      if (!is_sound(local) || !place.world_from_node.matrix().allFinite()) {
        return input_failure(file_name_, fmt::format("{} has a non-finite pose at {:.4g} s",
                                                     name_of(node), seconds));
      }
      if (is_mirrored(local)) return mirrored(node);
      check_size(node, place, frame);
    }
    return {};
  }

  void check_size(int node, const NodePlace& place, int frame) {
    const double size = place.world_from_node.linear().norm();
    if (frame == 0) {
      sizes_.resize(scene_.nodes.size());
      sizes_[as_size(node)] = size;
    } else if (!grows_ && std::max(size, sizes_[as_size(node)]) >
                              kUneven * std::min(size, sizes_[as_size(node)])) {
      grows_ = true;
      warnings_.push_back(
          {0, 0,
           "the scale of " + name_of(node) + " changes during the motion, so bone lengths change"});
    }
  }

  std::vector<Pose> joint_poses() const {
    std::vector<Pose> poses;
    poses.reserve(skeleton_.joints.size());
    for (const int joint : skeleton_.joints) {
      const NodePlace& place = places_[as_size(joint)];
      poses.push_back({place.rotation, place.world_from_node.translation()});
    }
    return poses;
  }

  ClipOrigin origin(const SceneTimes& times, std::size_t file_bytes) const {
    ClipOrigin origin;
    origin.name = file_name_;
    origin.bytes = file_bytes;
    origin.warnings = scene_.warnings;
    origin.warnings.insert(origin.warnings.end(), warnings_.begin(), warnings_.end());
    origin.metres_per_unit = scene_.metres_per_unit;
    origin.up = scene_.up;
    for (const SceneTake& take : scene_.takes) origin.takes.push_back(printable(take.name));
    origin.choices = scene_.format;
    if (take_ >= 0) {
      origin.choices += ", take \"" + origin.takes[as_size(take_)] + "\"";
      if (origin.takes.size() > 1) {
        origin.choices += fmt::format(" ({} of {})", take_ + 1, origin.takes.size());
      }
    }
    if (!skeleton_.others.empty()) {
      origin.choices += fmt::format(", skeleton {} of {}", name_of(skeleton_.joints.front()),
                                    skeleton_.others.size() + 1);
    }
    if (still_copies_ > 0) {
      origin.choices +=
          fmt::format(", without a still copy of {}", count_text(still_copies_, "joint"));
    }
    if (take_ >= 0) {
      origin.choices += fmt::format(", {} fps: {}", to_text(times.rate()), times.reason());
    }
    return origin;
  }

  const SceneGraph& scene_;
  const std::string& file_name_;
  const SceneReadOptions& options_;
  int take_ = -1;
  SceneSkeleton skeleton_;
  std::size_t still_copies_ = 0;  // Joints that are left out.
  std::vector<int> chain_;        // Nodes that affect the joints' positions, parents first.
  std::vector<bool> in_chain_, has_joints_below_;  // One per node.
  std::vector<NodePlace> places_;                  // In the current frame.
  std::vector<double> sizes_;                      // In the first frame.
  std::vector<Warning> warnings_;
  bool uneven_ = false, grows_ = false;
};

}  // namespace

Result<Clip> clip_of_scene(const SceneGraph& scene, const std::string& file_name,
                           std::size_t file_bytes, const SceneReadOptions& options) {
  return SceneSampler(scene, file_name, options).run(file_bytes);
}

Result<Clip> read_scene(std::string_view bytes, const std::string& file_name,
                        const SceneReadOptions& options) {
  const FileKind kind = file_type(bytes).kind;
  if (kind == FileKind::kMvnx) return read_mvnx(bytes, file_name, options);
  TRY_ASSIGN(const SceneGraph scene, kind == FileKind::kFbx
                                         ? read_fbx(bytes, file_name, options.max_clip_bytes)
                                         : read_gltf(bytes, file_name, options.max_clip_bytes));
  return clip_of_scene(scene, file_name, bytes.size(), options);
}

}  // namespace retarget
