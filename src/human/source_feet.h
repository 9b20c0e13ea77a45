#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "human/human_clip.h"
#include "retarget/human.h"

namespace retarget {

/// The ends of a foot: the heel goes as the ankle goes.
inline constexpr int kHeelEnd = 0, kToeEnd = 1;

/// Thigh and shank of the body that lengths and speeds of ContactOptions are for, metres.
inline constexpr double kUsualSourceLeg = 0.85;

/// What may carry a body besides its feet, by the joint it lies around: knees, elbows, hands, seat
/// and back.
inline constexpr std::array kSupportBones = {
    Bone::kLeftLeg,  Bone::kRightLeg,  Bone::kLeftForeArm, Bone::kRightForeArm,
    Bone::kLeftHand, Bone::kRightHand, Bone::kHips,        Bone::kSpine2};

/// A foot of the source in one frame.
struct SourceFoot {
  Eigen::Vector3d ankle = Eigen::Vector3d::Zero();  ///< World, metres.
  Eigen::Vector3d toe = Eigen::Vector3d::Zero();    ///< Where the toes begin.
  double up = 1.0;       ///< Height of the unit vector that points up from toes that stand.
  double side = 0.0;     ///< The same of the one to their side.
  double sole_up = 1.0;  ///< The same of the one that points up from a foot that stands.
  std::optional<Eigen::Vector3d> heel;  ///< Of a sole that is known, whose toe `toe` is then.
  double down = 0.0;                    ///< Of such a foot: how far its bone points down.

  /// @param end  kHeelEnd (the heel, else the ankle) or kToeEnd.
  [[nodiscard]] const Eigen::Vector3d& end(int end) const {
    return end == kToeEnd ? toe : heel ? *heel : ankle;
  }
  /// How far down the bone from ankle to toe points, by its length.
  [[nodiscard]] double steepness() const {
    return heel ? down : (ankle.z() - toe.z()) / (ankle - toe).norm();
  }
};

/// Feet, legs and hips of the source over a clip, and what else may carry it.
struct SourceFeet {
  double frame_time = 1.0 / 30.0;
  std::vector<SourceFoot> feet;  ///< Frame-major, foot_count a frame: left, right.
  int foot_count = 0;
  std::array<bool, 2> has_ankle{true, true}, has_toe{true, true};  ///< By foot.
  std::vector<double> legs;  ///< Thigh and shank by frame, metres; empty: kUsualSourceLeg.
  std::vector<double> hips;  ///< Their height by frame, metres; empty: not known.
  /// Places of kSupportBones, frame-major; world, metres. Empty: not known.
  std::vector<Eigen::Vector3d> supports;
  std::array<bool, kSupportBones.size()> has_support{};
  std::array<std::optional<FootSole>, 2> soles;  ///< By foot, where they are known.

  SourceFeet() = default;
  /// Of a human, without frames yet. A body without a whole leg has no feet.
  explicit SourceFeet(const HumanClipInfo& human);
  /// Of the first frames of a human.
  SourceFeet(const HumanClip& human, int frames);

  /// Appends a frame of that human.
  void add(const HumanPose& pose);
  /// Drops the first frames; all when there are fewer.
  void forget(int frames);
  /// Makes room for so many frames, which add() then takes without allocating.
  void reserve(int frames);

  [[nodiscard]] int frame_count() const {
    return foot_count == 0 ? 0 : static_cast<int>(feet.size()) / foot_count;
  }
  [[nodiscard]] const SourceFoot& at(int frame, int foot) const {
    return feet[static_cast<std::size_t>(frame) * static_cast<std::size_t>(foot_count) +
                static_cast<std::size_t>(foot)];
  }
  [[nodiscard]] bool has(int foot, int end) const {
    return end == kHeelEnd ? has_ankle[foot] : has_toe[foot];
  }
  /// Of the left leg, of the right one where the left is incomplete; median over the frames,
  /// metres.
  [[nodiscard]] double leg_length() const;
  /// The same.
  /// @param scratch  overwritten; once it has room for a value a frame nothing is allocated.
  [[nodiscard]] double leg_length(std::vector<double>& scratch) const;
  /// How high ankles stand above heels: of feet that stand, metres; 0 where soles are not known.
  [[nodiscard]] double ankle_over_heel() const;
  /// Speed of one end of a foot over a short time about the frame, m/s.
  [[nodiscard]] double speed(int frame, int foot, int end) const;
  /// @param support  index into kSupportBones.
  [[nodiscard]] const Eigen::Vector3d& support(int frame, std::size_t support) const {
    return supports[static_cast<std::size_t>(frame) * kSupportBones.size() + support];
  }
  /// The same of what may carry the body.
  [[nodiscard]] double support_speed(int frame, std::size_t support) const;

 private:
  bool has_hips_ = false;
  Side leg_ = Side::kLeft;
};

/// Length of the left leg, hip to knee to ankle, median over the frames, metres; of the right one
/// where the left is incomplete; 0 for a body without legs and a clip without frames.
[[nodiscard]] double leg_length(const HumanClip& human);

/// Whether hips rise over the straight line between a flight's ends as what falls does, by
/// g T^2 / 8, or by this share of it: they are not the centre of mass, and feet leave the floor
/// early.
/// @param hips  their heights in the flight's frames, two at least, metres.
[[nodiscard]] bool falls_freely(std::span<const double> hips, double frame_time, double share);

}  // namespace retarget
