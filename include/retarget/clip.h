#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "retarget/error.h"
#include "retarget/export.h"
#include "retarget/pose.h"

namespace RETARGET_API retarget {

/// An exact frame rate: `frames` frames in `seconds` seconds, both positive, in lowest terms.
///
/// Times of frames are rational numbers, so they do not drift in long clips.
struct FrameRate {
  std::int64_t frames = 30;
  std::int64_t seconds = 1;

  [[nodiscard]] double fps() const { return static_cast<double>(frames) / seconds; }
  /// Duration of one frame in seconds.
  [[nodiscard]] double frame_time() const { return static_cast<double>(seconds) / frames; }
  /// Time of a frame in seconds; frame 0 is at 0.
  [[nodiscard]] double time_of(std::int64_t frame) const {
    return static_cast<double>(frame * seconds) / static_cast<double>(frames);
  }

  friend bool operator==(const FrameRate&, const FrameRate&) = default;
};

/// The exact rate for a positive, finite number of frames per second.
///
/// The result is a whole number if the value is within a relative 1e-4 of one, so the frame time
/// 0.033333 of many files means exactly 30 fps. Otherwise it is the simplest fraction within 1e-9
/// of the value: 23.976 becomes 2997/125.
[[nodiscard]] FrameRate frame_rate_from_fps(double fps);

/// The exact rate for a positive, finite `Frame Time` in seconds, by the rules of
/// frame_rate_from_fps.
[[nodiscard]] FrameRate frame_rate_from_frame_time(double frame_time);

/// Whether two rates differ by at most a relative 1e-4. Resampling then copies the frames.
[[nodiscard]] bool same_rate(const FrameRate& a, const FrameRate& b);

/// Text with up to eight significant digits: `30`, `23.976`.
[[nodiscard]] std::string to_text(const FrameRate& rate);

/// One value of a joint in a motion row.
enum class Channel : unsigned char {
  kXPosition,
  kYPosition,
  kZPosition,
  kXRotation,
  kYRotation,
  kZRotation,
  kXScale,
  kYScale,
  kZScale,
};

[[nodiscard]] constexpr bool is_position(Channel channel) {
  return channel <= Channel::kZPosition;
}
[[nodiscard]] constexpr bool is_rotation(Channel channel) {
  return channel >= Channel::kXRotation && channel <= Channel::kZRotation;
}
/// Index of the channel's axis: 0, 1 or 2 for x, y or z.
[[nodiscard]] constexpr int axis_of(Channel channel) {
  return static_cast<int>(channel) % 3;
}
/// Name of the channel in BVH: `Xposition`, `Zrotation`, `Yscale`.
[[nodiscard]] std::string_view channel_name(Channel channel);

/// A joint of a skeleton, in the units and axes of the file.
struct Joint {
  std::string name;
  int parent = -1;  ///< Index of the parent, always smaller than the joint's own; -1 for the root.
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();  ///< Offset from the parent, in the parent's
                                                     ///< frame.
  std::vector<Eigen::Vector3d> end_sites;            ///< End sites in the joint's frame.
  /// Channels of this joint in a motion row, in file order. Rotations compose left to right
  /// (intrinsic). The order may differ between joints.
  std::vector<Channel> channels;

  /// Whether the joint's translation is stored per frame instead of being its offset.
  [[nodiscard]] bool has_position_channels() const;
};

/// A tree of joints in depth-first declaration order; immutable once built.
class Skeleton {
 public:
  /// Joint 0 is the root; every parent comes before its children.
  explicit Skeleton(std::vector<Joint> joints);

  [[nodiscard]] int joint_count() const { return static_cast<int>(joints_.size()); }
  [[nodiscard]] const Joint& joint(int index) const { return joints_[index]; }
  [[nodiscard]] const std::vector<Joint>& joints() const { return joints_; }
  /// The first joint with exactly this name.
  [[nodiscard]] std::optional<int> find(std::string_view name) const;
  /// All joint names, in joint order.
  [[nodiscard]] std::vector<std::string> names() const;
  /// Number of values in one motion row: the channels of all joints.
  [[nodiscard]] int channel_count() const { return channel_count_; }

  /// Number of joints whose translation is stored in each frame.
  [[nodiscard]] int translated_count() const { return translated_count_; }
  /// Index of a joint's translation in a frame's list of translations; -1: the translation is the
  /// offset.
  [[nodiscard]] int translation_slot(int joint) const { return translation_slots_[joint]; }

 private:
  std::vector<Joint> joints_;
  std::vector<int> translation_slots_;
  int translated_count_ = 0;
  int channel_count_ = 0;
};

/// Origin of a clip.
struct ClipOrigin {
  std::string name;                   ///< The file name given by the user, or `standard input`.
  std::uint64_t bytes = 0;            ///< Size of the file.
  std::optional<double> body_height;  ///< Metres, if the file states it.
  std::vector<Warning> warnings;      ///< Problems found while reading.

  // Properties of scene files: FBX, glTF, MVNX (docs/scenes.md).
  std::optional<double> metres_per_unit;  ///< Unit of the file, if it states one.
  std::optional<Eigen::Vector3d> up;  ///< Up direction in the file's axes, if the file states it.
  std::vector<std::string> takes;     ///< Names of the file's animations, in file order.
  std::string choices;  ///< Human-readable: the take, skeleton and rate that were chosen.
  /// Joints whose rotation is unknown: the file has joint positions only, which do not determine
  /// it.
  std::vector<std::string> unknown_rotations = {};
  /// The robot whose motion this clip represents as a canonical human (human/robot_human.h). Empty:
  /// the source is not a robot.
  std::string robot = {};
};

/// A motion of a skeleton: local rotations (unit quaternions) and translations, frame by frame,
/// in the units and axes of its file.
///
/// Joints without position channels use their offset as translation in every frame; no memory is
/// allocated for it.
class Clip {
 public:
  /// All rotations are identity, all translations are the joints' offsets.
  Clip(std::shared_ptr<const Skeleton> skeleton, FrameRate rate, int frame_count);

  [[nodiscard]] const Skeleton& skeleton() const { return *skeleton_; }
  [[nodiscard]] const std::shared_ptr<const Skeleton>& shared_skeleton() const { return skeleton_; }
  [[nodiscard]] const FrameRate& rate() const { return rate_; }
  [[nodiscard]] int frame_count() const { return frame_count_; }
  /// Time from the first to the last frame in seconds: (frame_count - 1) / rate.
  [[nodiscard]] double duration() const;

  /// Rotations parent_from_joint of all joints in a frame.
  [[nodiscard]] std::span<Eigen::Quaterniond> rotations(int frame);
  [[nodiscard]] std::span<const Eigen::Quaterniond> rotations(int frame) const;
  /// Translations of the joints that have position channels, by Skeleton::translation_slot.
  [[nodiscard]] std::span<Eigen::Vector3d> translations(int frame);
  [[nodiscard]] std::span<const Eigen::Vector3d> translations(int frame) const;

  /// Translation of any joint from its parent, in the parent's frame.
  [[nodiscard]] const Eigen::Vector3d& translation(int frame, int joint) const;

  /// Origin of the clip. Clips made from it (cut, resampled) have the same origin.
  [[nodiscard]] const ClipOrigin& origin() const;
  /// A clip with the same skeleton and origin whose frames are at rest, as in the constructor.
  [[nodiscard]] Clip empty_like(FrameRate rate, int frame_count) const;
  /// Name of the clip in messages.
  [[nodiscard]] const std::string& name() const { return origin().name; }
  void set_origin(ClipOrigin origin);

  void set_rate(FrameRate rate) { rate_ = rate; }
  /// Added frames are at rest, as in the constructor. Amortised constant cost per frame.
  void resize(int frame_count);

 private:
  std::shared_ptr<const Skeleton> skeleton_;
  std::shared_ptr<const ClipOrigin> origin_;  // null: unknown
  FrameRate rate_;
  int frame_count_;
  std::vector<Eigen::Quaterniond> rotations_;  // frame-major
  std::vector<Eigen::Vector3d> translations_;  // frame-major, only translated joints
};

/// Frames [begin, end) of a clip, counted from 0, as for `cut`.
struct FrameRange {
  int begin = 0;
  int end = 0;

  friend bool operator==(const FrameRange&, const FrameRange&) = default;
};

/// Copies the pose of a frame to a frame of another clip on the same skeleton.
void copy_frame(const Clip& from, int from_frame, Clip& to, int to_frame);

/// Frames [begin, end) as a separate clip that starts at time 0.
/// @pre 0 <= begin <= end <= clip.frame_count()
[[nodiscard]] Clip cut(const Clip& clip, int begin, int end);

/// World poses of all joints in one frame, in file units and axes.
/// @param world_from_joint  one pose per joint, in joint order; overwritten.
void forward_kinematics(const Clip& clip, int frame, std::span<Pose> world_from_joint);

/// For every joint, replaces q by -q where that is nearer to the quaternion of the previous frame.
/// The rotations do not change; interpolation and filtering require continuous signs.
void make_sign_continuous(Clip& clip);

}  // namespace retarget
