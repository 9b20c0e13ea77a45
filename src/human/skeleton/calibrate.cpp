#include "human/skeleton/calibrate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "base/faults.h"
#include "base/option_name.h"
#include "base/try.h"
#include "human/skeleton/calibration_text.h"
#include "human/skeleton/candidate.h"
#include "human/skeleton/find_rest.h"
#include "human/skeleton/learned_axes.h"
#include "human/skeleton/posed_body.h"
#include "human/skeleton/rest_pose.h"
#include "human/skeleton/stated_axes.h"
#include "human/skeleton/twist_joints.h"
#include "human/skeleton/units.h"
#include "human/skeleton/up_axis.h"
#include "human/skeleton/up_evidence.h"
#include "retarget/clip_range.h"
#include "retarget/text.h"

namespace retarget {
namespace {

using enum LimbBone;

// In LAFAN1, offsets deviate from their axis by at most 20 degrees.
bool runs_along(const Eigen::Vector3d& offset, int axis) {
  constexpr double kMinShare = 0.93969262078590838;  // cosine of that angle
  return offset[axis] > kMinShare * offset.norm();
}

// Returns the sides on which the toes turn farther against the foot than toes can: by more than 90
// degrees from the T-pose, in more than one percent of the frames. A known defect of motion capture
// data (for example CMU's) turns them by 180 degrees; a robot's foot that followed would drag the
// whole body along.
std::vector<Side> sides_with_flipped_toes(const Body& body, const std::vector<JointPoses>& poses,
                                          const JointFromBone& axes) {
  // The trace of a rotation is 1 + 2 cos(angle).
  constexpr double kTraceOfRightAngle = 1.0, kShareOfFrames = 0.01;
  std::vector<Side> sides;
  for (const Side side : kSides) {
    const Bone foot_bone = side_bone(side, kFoot), toe_bone = side_bone(side, kToe);
    const int foot = body.turning_joint(foot_bone), toe = body.turning_joint(toe_bone);
    const auto& foot_axes = axes[foot_bone];
    const auto& toe_axes = axes[toe_bone];
    if (foot < 0 || toe < 0 || !foot_axes || !toe_axes) continue;
    const Eigen::Matrix3d foot_from_toe_in_t =
        canonical_t_pose(foot_bone).transpose() * canonical_t_pose(toe_bone);
    std::size_t flipped = 0;
    for (const JointPoses& pose : poses) {
      const Eigen::Matrix3d world_from_foot = pose[foot].rotation.toRotationMatrix() * *foot_axes;
      const Eigen::Matrix3d world_from_toe = pose[toe].rotation.toRotationMatrix() * *toe_axes;
      const Eigen::Matrix3d turn =
          (world_from_foot * foot_from_toe_in_t).transpose() * world_from_toe;
      flipped += turn.trace() < kTraceOfRightAngle ? 1 : 0;
    }
    if (static_cast<double>(flipped) > kShareOfFrames * static_cast<double>(poses.size())) {
      sides.push_back(side);
    }
  }
  return sides;
}

class Calibrator {
 public:
  Calibrator(const Clip& clip, const BoneMap& map, const CalibrationOptions& options)
      : clip_(clip), map_(map), options_(options), body_(clip.skeleton(), map) {}

  Result<Calibration> run() {
    TRY(check());
    look();
    doubt_sides();
    Calibration result;
    TRY(has_lafan1_axes() ? keep_lafan1_axes(result) : bring_to_canonical_axes(result));
    result.up = movement_.up;
    result.up_is_uncertain = up_is_uncertain_;
    const bool is_published = result.rest_pose == "lafan1" && result.unit == "cm" &&
                              result.up == SignedAxis{} && tilt_degrees(result) == 0.0 &&
                              !options_.height;
    if (options_.height) {
      result.height = result.size = *options_.height;
    } else if (options_.metres_per_unit) {
      doubt_given_unit(result);
    } else if (!is_published) {
      doubt_height(result);
    }
    result.doubts.insert(result.doubts.end(), doubts_.begin(), doubts_.end());
    if (!is_published) result.description = describe_calibration(result, evidence_);
    return result;
  }

 private:
  [[nodiscard]] RestSearch rest() const { return {clip_, map_, options_, body_, movement_}; }

  Result<void> check() const {
    if (!body_.has(Bone::kHips)) {
      return input_failure({}, "no joint found for the hips", "name it in a bone map");
    }
    std::vector<std::string> missing;
    for (const Side side : kSides) {
      for (const LimbBone part : {kUpLeg, kLeg, kFoot, kArm, kForeArm}) {
        const Bone bone = side_bone(side, part);
        if (!body_.has(bone)) missing.emplace_back(bone_name(bone));
      }
    }
    if (!missing.empty() && !map_.partial) {
      return input_failure({}, "no joints found for " + list_names(missing),
                           "legs and arms are needed, unless " OPTION("partial") " is given");
    }
    const auto is_positive = [](const std::optional<double>& value) {
      return !value || (std::isfinite(*value) && *value > 0.0);
    };
    if (!is_positive(options_.metres_per_unit)) return usage_failure("the unit must be positive");
    if (!is_positive(options_.height)) return usage_failure("the height must be positive");
    if (options_.tpose && options_.rest != RestPose::kAuto) {
      return usage_failure("a T-pose file and a rest pose cannot be combined");
    }
    if (options_.up && options_.forward &&
        nearest_axis(*options_.up).axis == options_.forward->axis) {
      return usage_failure("forward cannot be along the up axis");
    }
    return {};
  }

  void look() {
    movement_.lead_in = count_lead_in_frames(clip_);
    movement_.frames = sampled_frames(clip_, movement_.lead_in);
    for (const int frame : movement_.frames) movement_.poses.push_back(frame_pose(clip_, frame));
    starts_ = body_.turning_joints();
    twist_joints_ = find_twist_joints(body_, movement_.poses);
    for (const Bone bone : kMappedBones) {
      if (twist_joints_[bone] >= 0) body_.turn_by(bone, twist_joints_[bone]);
    }
    UpChoice up = find_up();
    movement_.up = up.axis;
    if (options_.up) {
      movement_.up = nearest_axis(*options_.up);
      up.doubt = doubt_stated_up(body_, movement_.poses, *options_.up, up);
    }
    up_is_uncertain_ = !up.doubt.empty();
    if (up_is_uncertain_) doubt(std::move(up.doubt));
  }

  // The up axis without the statement of the user.
  [[nodiscard]] UpChoice find_up() const {
    KnownUp known;
    if (clip_.origin().up) known.of_file = nearest_axis(*clip_.origin().up);
    // A skeleton made from joint positions has the axes of the body, not those of a kind of file.
    const bool is_made = !clip_.origin().unknown_rotations.empty();
    if (map_.facts.up && !is_made) known.of_kind = nearest_axis(*map_.facts.up);
    constexpr double kAlongAxis = 0.94;  // Cosine of 20 degrees.
    if (const auto zero = zero_candidate(rest());
        zero && !is_made && is_well_formed(body_, *zero) &&
        zero->axes.row(2).cwiseAbs().maxCoeff() > kAlongAxis) {
      known.of_zero_pose = nearest_axis(zero->axes.row(2));
    }
    known.of_fall = free_fall_axis(clip_, body_, movement_.lead_in);
    return choose_up(body_, movement_.poses, known);
  }

  Result<Unit> find_unit(double hip_height, double height) {
    if (options_.metres_per_unit) return Unit{"given", *options_.metres_per_unit};
    const auto unit =
        unit_of_body({hip_height, height, map_.facts.metres_per_unit, options_.height});
    if (unit) return *unit;
    // Programs scale scenes, and characters may have any size. Retargeting scales limbs
    // individually anyway.
    const bool any_size = map_.profile == "mixamo" || clip_.origin().metres_per_unit.has_value();
    if (options_.unit_optional || (any_size && has_human_proportions(hip_height, height))) {
      const Unit assumed = unit_of_average_body(height);
      doubt(assumed_unit_text(hip_height));
      return assumed;
    }
    return input_failure(
        {},
        hip_height > 0.0 ? "hips " + std::to_string(hip_height) +
                               " units above the floor fit a person in no known unit"
        : options_.height ? "cannot infer the unit without a leg, even with the given height"
                          : "cannot infer the unit without a leg",
        "give the unit's length in metres with " OPTION("unit") +
            std::string(height > 0.0 ? ", or the body's height with " OPTION("height") : ""));
  }

  // Offset of a bone. Of joints at the same position, the uppermost has the length.
  std::optional<Eigen::Vector3d> offset_of(Bone bone) const {
    if (!body_.has(bone)) return std::nullopt;
    return clip_.skeleton().joint(first_in_place(clip_.skeleton(), map_, body_.joint(bone))).offset;
  }

  // Whether limbs run along x, and left and right are separated along z.
  bool has_lafan1_axes() const {
    if (map_.profile != "lafan1" || options_.rest != RestPose::kAuto || options_.tpose ||
        options_.forward) {
      return false;
    }
    for (const Side side : kSides) {
      for (const LimbBone part : {kLeg, kFoot, kForeArm, kHand}) {
        const auto along = offset_of(side_bone(side, part));
        if (along && !runs_along(*along, 0)) return false;
      }
    }
    return std::ranges::all_of(std::array{kUpLeg, kShoulder}, [this](LimbBone part) {
      const auto left = offset_of(side_bone(Side::kLeft, part));
      const auto right = offset_of(side_bone(Side::kRight, part));
      return !left || !right || runs_along(*left - *right, 2);
    });
  }

  // Makes toes with implausible rotations follow their feet.
  bool disbelieve_flipped_toes(const JointFromBone& axes) {
    const auto sides = sides_with_flipped_toes(body_, movement_.poses, axes);
    for (const Side side : sides) body_.disbelieve_rotation(side_bone(side, kToe));
    if (sides.empty()) return false;
    doubt((sides.size() > 1               ? std::string("the toes turn")
           : sides.front() == Side::kLeft ? "the left toes turn"
                                          : "the right toes turn") +
          " farther than toes can: their rotations are ignored, and they "
          "follow the foot");
    return true;
  }

  // Completes toes, synthetic feet and hands: missing ones, and toes with implausible rotations.
  void complete_ends(const JointPoses& rest, BoneArray<BoneSource>& bones) const {
    JointFromBone own_axes;
    for (const Bone bone : kMappedBones) {
      if (body_.turning_joint(bone) >= 0) own_axes[bone] = Eigen::Matrix3d::Identity();
    }
    const BoneArray<BoneSource> completed = bone_sources(body_, own_axes, rest);
    for (const Side side : kSides) {
      const Bone toe = side_bone(side, kToe), hand = side_bone(side, kHand);
      const Bone foot_mod = side_bone(side, kFootMod);
      if (!own_axes[toe]) {
        bones[toe] = completed[toe];
        bones[foot_mod] = completed[foot_mod];
      }
      if (!own_axes[hand]) bones[hand] = completed[hand];
    }
  }

  // Uses the published method's calibration. Copies in other units, with another up axis or of
  // another size keep its axes, too; a body of another size has its own height.
  Result<void> keep_lafan1_axes(Calibration& result) {
    constexpr double kHipHeightPerLeg = 1.12;
    const JointPoses zero = zero_pose(clip_.skeleton());
    const double own_height = estimated_height(body_, zero);
    const auto knee = offset_of(Bone::kLeftLeg), ankle = offset_of(Bone::kLeftFoot);
    const double leg = knee && ankle ? knee->norm() + ankle->norm() : 0.0;
    TRY_ASSIGN(const Unit unit, find_unit(kHipHeightPerLeg * leg, own_height));
    disbelieve_flipped_toes(JointFromBone(Eigen::Matrix3d(Eigen::Matrix3d::Identity())));
    result = lafan1_calibration(body_.joints(), body_.turning_joints());
    const bool is_published = unit.metres == result.metres_per_unit;
    result.unit = is_published ? "cm" : unit.name;
    result.rest_pose = "lafan1";
    result.metres_per_unit = unit.metres;
    if (own_height > 0.0 && !is_lafan1_height(own_height * unit.metres)) {
      result.rest_pose = "lafan1 axes";
      result.height = own_height * unit.metres;
      result.size = height_of_legs(body_, zero) * unit.metres;
    }
    complete_ends(zero, result.bones);
    split_twists(twist_joints_, starts_, zero, result.bones);
    result.human_from_source = z_up_from_file(options_.up.value_or(movement_.up.direction()));
    if (const auto best = best_frame(rest())) {
      result.forward = nearest_axis(best->second.axes.row(0));
      result.rest_deviation = deviation_from_t(body_, best->second).mean;
    }
    return {};
  }

  Result<void> bring_to_canonical_axes(Calibration& result) {
    TRY_ASSIGN(Rest found, find_rest(rest()));
    if (disbelieve_flipped_toes(found.axes)) {
      TRY_ASSIGN(found, find_rest(rest()));
    }
    const RestCandidate& posed = found.candidate;
    TRY_ASSIGN(const Unit unit, find_unit(standing_hip_height(body_, posed.pose, posed.axes),
                                          estimated_height(body_, posed.pose)));
    result.unit = unit.name;
    result.rest_pose = found.name;
    result.rest_deviation = deviation_from_t(body_, posed).mean;
    result.forward = nearest_axis(posed.axes.row(0));
    result.profile = map_.profile;
    evidence_ = found.evidence;
    if (!found.doubt.empty()) doubt(found.doubt);
    if (const auto guessed = forearms_without_length(body_, posed.pose); !guessed.empty()) {
      doubt("no length is known for " + list_names(guessed) +
            ", so the direction is a guess; hand joints or end sites determine it");
    }
    if (options_.forward) {
      auto text = doubt_stated_forward(body_, posed, *options_.forward);
      if (!text.empty()) doubt(std::move(text));
    }
    result.metres_per_unit = unit.metres;
    result.human_from_source = z_up_from_file(options_.up.value_or(movement_.up.direction()));
    result.bones = bone_sources(body_, found.axes, posed.pose);
    // Learned axes belong to no pose. Twist joints then have no twist if they do not rotate.
    const bool is_learned = result.rest_pose == "learned";
    split_twists(twist_joints_, starts_, is_learned ? zero_pose(clip_) : posed.pose, result.bones);
    const double height = estimated_height(body_, posed.pose) * unit.metres;
    result.height = map_.facts.height.value_or(height > 0.0 ? height : 1.75);
    const double by_legs = height_of_legs(body_, posed.pose) * unit.metres;
    result.size = by_legs > 0.0 ? by_legs : result.height;
    return {};
  }

  void doubt_sides() {
    double sum = 0.0;
    for (const JointPoses& pose : movement_.poses) {
      const auto axes = body_axes(body_, pose, movement_.up.direction());
      const auto trunk = trunk_direction(body_, pose);
      if (!axes || !trunk) continue;
      // The front in body axes, so that lying and crawling bodies count, too.
      const Eigen::Vector3d front = axes->row(1).transpose().cross(*trunk).normalized();
      for (const Side side : kSides) {
        const auto part = [&](LimbBone bone) {
          const auto line = along(body_.segment(side_bone(side, bone)), pose);
          return line ? *line : Eigen::Vector3d(Eigen::Vector3d::Zero());
        };
        sum +=
            leg_facing(part(LimbBone::kUpLeg), part(LimbBone::kLeg), part(LimbBone::kFoot), front);
      }
    }
    if (sum < -kMinSwapEvidence * 2.0 * static_cast<double>(movement_.poses.size())) {
      doubt(
          "feet point and knees bend the wrong way: left and right are swapped "
          "or the body is mirrored");
    }
  }

  void doubt_height(const Calibration& found) {
    constexpr double kSmall = 1.3, kTall = 2.1;  // metres
    const double height = found.height;
    if (height >= kSmall && height <= kTall) return;
    doubt("a body height of " + metres_text(height) + " is unusual: " + "if the unit is not " +
          found.unit + ", give " OPTION("unit"));
  }

  // Children and characters may have other heights than adults.
  void doubt_given_unit(const Calibration& found) {
    constexpr double kSmall = 0.6, kTall = 2.8;  // metres
    if (found.height >= kSmall && found.height <= kTall) return;
    doubt("a body height of " + metres_text(found.height) +
          " is unusual: " OPTION("unit") " may be wrong");
  }

  void doubt(std::string text) { doubts_.push_back({0, 0, std::move(text)}); }

  const Clip& clip_;
  const BoneMap& map_;
  const CalibrationOptions& options_;
  Body body_;
  BoneArray<int> starts_, twist_joints_;  // Joints that turn bones at their start and inside.
  Movement movement_;
  std::vector<Warning> doubts_;
  bool up_is_uncertain_ = false;
  std::string evidence_;  // for the rest pose
};

}  // namespace

Result<Calibration> calibrate(const Clip& clip, const BoneMap& map,
                              const CalibrationOptions& options) {
  return located(Calibrator(clip, map, options).run(), clip.name());
}

}  // namespace retarget
