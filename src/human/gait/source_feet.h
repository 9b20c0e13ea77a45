#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "retarget/contact_plan.h"
#include "retarget/human.h"

namespace retarget {

/// A foot of the source in one frame.
struct SourceFoot {
  Eigen::Vector3d ankle = Eigen::Vector3d::Zero();  ///< World, metres.
  Eigen::Vector3d toe = Eigen::Vector3d::Zero();    ///< Start of the toes. World, metres.
  double up = 1.0;       ///< World z of the unit vector that points up from standing toes.
  double side = 0.0;     ///< World z of the unit vector to the side of standing toes.
  double sole_up = 1.0;  ///< World z of the unit vector that points up from a standing foot.
  std::optional<Eigen::Vector3d> heel;  ///< Heel of a known sole; `toe` is then the sole's toe.
  double down = 0.0;                    ///< Steepness of the foot's bone, if the sole is known.

  /// @param end  kHeelEnd (the heel, else the ankle) or kToeEnd.
  [[nodiscard]] const Eigen::Vector3d& end(int end) const {
    return end == kToeEnd ? toe : heel ? *heel : ankle;
  }
  /// Returns the sine of the downward slope of the bone from ankle to toe.
  [[nodiscard]] double steepness() const {
    return heel ? down : (ankle.z() - toe.z()) / (ankle - toe).norm();
  }
};

/// Joints of parts that may be the lowest of a body that lies or is upside down, besides
/// kSupportBones: shoulders and head.
inline constexpr std::array kUpperBones = {Bone::kLeftArm, Bone::kRightArm, Bone::kHead};

/// Feet, legs, hips and other supporting parts of the source over a clip.
struct SourceFeet {
  double frame_time = 1.0 / 30.0;
  std::vector<SourceFoot> feet;  ///< Frame-major, foot_count per frame: left, right.
  int foot_count = 0;
  std::array<bool, 2> has_ankle{true, true}, has_toe{true, true};  ///< Known joints, one entry per
                                                                   ///< foot.
  std::vector<double> legs;  ///< Thigh plus shank per frame, metres; empty: kUsualSourceLeg.
  std::vector<double> hips;  ///< Hip height per frame, metres; empty: unknown.
  /// Positions of kSupportBones, frame-major; world, metres. Empty: unknown.
  std::vector<Eigen::Vector3d> supports;
  std::array<bool, kSupportBones.size()> has_support{};
  /// Positions of kUpperBones, frame-major; world, metres. That of the head is the lower end of the
  /// skull. Empty: unknown.
  std::vector<Eigen::Vector3d> uppers;
  std::array<bool, kUpperBones.size()> has_upper{};
  std::array<std::optional<FootSole>, 2> soles;  ///< Known soles, one entry per foot.

  SourceFeet() = default;
  /// Creates feet for a human, without frames. A body without a complete leg has no feet.
  explicit SourceFeet(const HumanClipInfo& human);
  /// Creates feet from the first frames of a human.
  SourceFeet(const HumanClip& human, int frames);

  /// Appends a frame of the same human.
  void add(const HumanPose& pose);
  /// Drops the first frames, or all if there are fewer.
  void forget(int frames);
  /// Reserves memory so that add() does not allocate for this many frames.
  void reserve(int frames);

  /// The same feet before a time scale slowed them by a constant pace (TimeScale).
  [[nodiscard]] SourceFeet before_pace(double pace) const;

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
  /// Length of the left leg, or of the right one if the left is incomplete; median over the frames,
  /// metres.
  [[nodiscard]] double leg_length() const;
  /// Variant that does not allocate.
  /// @param scratch  overwritten; once it has room for a value a frame nothing is allocated.
  [[nodiscard]] double leg_length(std::vector<double>& scratch) const;
  /// Height of ankles above heels in standing feet, metres; 0 if the soles are unknown.
  [[nodiscard]] double ankle_over_heel() const;
  /// Speed of one end of a foot over a short time about the frame, m/s.
  [[nodiscard]] double speed(int frame, int foot, int end) const;
  /// @param support  index into kSupportBones.
  [[nodiscard]] const Eigen::Vector3d& support(int frame, std::size_t support) const {
    return supports[static_cast<std::size_t>(frame) * kSupportBones.size() + support];
  }
  /// @param upper  index into kUpperBones.
  [[nodiscard]] const Eigen::Vector3d& upper(int frame, std::size_t upper) const {
    return uppers[static_cast<std::size_t>(frame) * kUpperBones.size() + upper];
  }
  /// Speed of the support at `support`, as that of a foot's end.
  [[nodiscard]] double support_speed(int frame, std::size_t support) const;

 private:
  bool has_hips_ = false;
  Side leg_ = Side::kLeft;
};

struct FeetAndHips {
  SourceFeet feet;
  std::vector<Eigen::Vector3d> hips;  ///< World, metres.
};

/// Feet and hips of the human in frames of a clip.
[[nodiscard]] FeetAndHips feet_and_hips(const Clip& clip, const Calibration& calibration,
                                        FrameRange part);

/// Length of the left leg (hip to knee to ankle), or of the right one if the left is incomplete:
/// median over the frames, metres. 0 for a body without legs or a clip without frames.
[[nodiscard]] double leg_length(const HumanClip& human);

/// Whether the hips rise in a flight as a falling body does: by g T^2 / 8 above the straight line
/// between the flight's ends, or by this share of it. The share allows for two differences: hips
/// are not the centre of mass, and feet leave the floor early.
/// @param hips  hip heights in the frames of the flight, at least two, metres
[[nodiscard]] bool falls_freely(std::span<const double> hips, double frame_time, double share);

}  // namespace retarget
