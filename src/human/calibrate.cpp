#include "human/calibrate.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "base/option_name.h"
#include "base/try.h"
#include "human/body_axes.h"
#include "human/bone_sources.h"
#include "human/find_rest.h"
#include "human/lafan1_shape.h"
#include "human/learned_axes.h"
#include "human/posed_body.h"
#include "human/rest_pose.h"
#include "human/toe_rotations.h"
#include "human/units.h"
#include "human/up_axis.h"
#include "motion/lead_in.h"

namespace retarget {
namespace {

using enum LimbBone;

class Calibrator {
 public:
  Calibrator(const Clip& clip, const BoneMap& map, const CalibrationOptions& options,
             const std::string& file)
      : clip_(clip), map_(map), options_(options), file_(file), body_(clip.skeleton(), map) {}

  Result<Calibration> run();

 private:
  [[nodiscard]] Result<void> check() const;
  void look();
  [[nodiscard]] bool has_lafan1_axes() const;
  [[nodiscard]] Result<void> keep_lafan1_axes(Calibration& result);
  [[nodiscard]] Result<void> bring_to_canonical_axes(Calibration& result);
  [[nodiscard]] RestFinder rest_finder() const {
    return {clip_, map_, options_, file_, body_, movement_};
  }
  bool disbelieve_flipped_toes(const JointFromBone& axes);
  [[nodiscard]] Result<Unit> find_unit(double hip_height, double height);
  void doubt_sides();
  void doubt_height(const Calibration& found);

  const Clip& clip_;
  const BoneMap& map_;
  const CalibrationOptions& options_;
  const std::string& file_;
  Body body_;
  Movement movement_;
  std::vector<Warning> doubts_;
  // as far as offsets count: of joints in one place the uppermost, which has the length
  JointOfBone joint_of_ = [this](Bone bone) -> std::optional<int> {
    if (!body_.has(bone)) return std::nullopt;
    return first_in_place(clip_.skeleton(), map_, body_.joint(bone));
  };
};

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

Result<void> Calibrator::check() const {
  if (!body_.has(Bone::kHips)) {
    return input_failure(file_, "no joint stands for the hips", "name it in a mapping file");
  }
  std::vector<std::string> missing;
  for (const Side side : kSides) {
    for (const LimbBone part : {kUpLeg, kLeg, kFoot, kArm, kForeArm}) {
      if (!body_.has(side_bone(side, part))) missing.emplace_back(bone_name(side_bone(side, part)));
    }
  }
  if (!missing.empty() && !map_.partial) {
    return input_failure(file_, "no joints stand for " + joined(missing),
                         "legs and arms are needed, unless " OPTION("partial") " is given");
  }
  const auto is_positive = [](const std::optional<double>& value) {
    return !value || (std::isfinite(*value) && *value > 0.0);
  };
  if (!is_positive(options_.metres_per_unit)) return usage_failure("the unit must be positive");
  if (!is_positive(options_.height)) return usage_failure("the height must be positive");
  if (options_.tpose && options_.rest != RestPose::kAuto) {
    return usage_failure("a T-pose file and a rest pose exclude each other");
  }
  if (options_.up && options_.forward && options_.up->axis == options_.forward->axis) {
    return usage_failure("forward cannot be along the up axis");
  }
  return {};
}

void Calibrator::look() {
  movement_.lead_in = count_lead_in_frames(clip_);
  movement_.frames = sampled_frames(clip_, movement_.lead_in);
  for (const int frame : movement_.frames) movement_.poses.push_back(frame_pose(clip_, frame));
  if (options_.up) {
    movement_.up = *options_.up;
    return;
  }
  KnownUp known;
  if (map_.facts.up) known.of_kind = nearest_axis(*map_.facts.up);
  if (const auto zero = rest_finder().zero_candidate(); zero && is_well_formed(body_, *zero)) {
    known.of_zero_pose = nearest_axis(zero->axes.row(2));
  }
  const UpChoice up = choose_up(body_, movement_.poses, known);
  movement_.up = up.axis;
  if (up.doubtful) {
    doubts_.push_back({0, 0,
                       "the body hardly ever stands: " + to_text(up.axis) +
                           " was taken as the up axis; give " OPTION("up") " if that is wrong"});
  }
}

Result<Unit> Calibrator::find_unit(double hip_height, double height) {
  if (options_.metres_per_unit) return Unit{"given", *options_.metres_per_unit};
  const auto unit = unit_of_body({hip_height, height, map_.facts.metres_per_unit, options_.height});
  if (unit) return *unit;
  if (options_.unit_optional) {
    const Unit assumed = unit_of_average_body(height);
    doubts_.push_back({0, 0, assumed_unit_text(hip_height)});
    return assumed;
  }
  return input_failure(
      file_,
      hip_height > 0.0 ? "hips " + std::to_string(hip_height) +
                             " units above the floor are a person's in no known unit"
      : options_.height ? "without a leg the unit cannot be told, nor by the height that is given"
                        : "without a leg the unit cannot be told",
      "give the unit's length in metres with " OPTION("unit") +
          std::string(height > 0.0 ? ", or the body's height with " OPTION("height") : ""));
}

bool Calibrator::has_lafan1_axes() const {
  return map_.dialect == "lafan1" && options_.rest == RestPose::kAuto && !options_.tpose &&
         !options_.forward && bones_off_lafan1_axes(clip_.skeleton(), joint_of_).empty();
}

// toes that turn as none do follow their feet from now on
bool Calibrator::disbelieve_flipped_toes(const JointFromBone& axes) {
  const auto sides = sides_with_flipped_toes(body_, movement_.poses, axes);
  for (Side side : sides) {
    body_.disbelieve_rotation(side_bone(side, kToe));
  }
  if (sides.empty()) return false;
  doubts_.push_back({0, 0,
                     (sides.size() > 1               ? std::string("the toes turn")
                      : sides.front() == Side::kLeft ? "the left toes turn"
                                                     : "the right toes turn") +
                         " farther than toes do: their rotations are not believed, and they "
                         "follow the foot"});
  return true;
}

// the published method's mapping; copies in other units or with another axis up keep its axes too,
// and so do bodies of another size, whose height is their own
Result<void> Calibrator::keep_lafan1_axes(Calibration& result) {
  constexpr double kHipHeightPerLeg = 1.12;
  const double own_height = estimated_height(body_, zero_pose(clip_.skeleton()));
  TRY_ASSIGN(
      const Unit unit,
      find_unit(kHipHeightPerLeg * lafan1_leg_length(clip_.skeleton(), joint_of_), own_height));
  disbelieve_flipped_toes(JointFromBone(Eigen::Matrix3d(Eigen::Matrix3d::Identity())));
  result.mapping = lafan1_mapping(map_);
  const bool is_published = unit.metres == result.mapping.metres_per_unit;
  result.unit = is_published ? "cm" : unit.name;
  result.rest_pose = "lafan1";
  result.mapping.metres_per_unit = unit.metres;
  if (own_height > 0.0 && !is_lafan1_height(own_height * unit.metres)) {
    result.rest_pose = "lafan1 axes";
    result.mapping.height = own_height * unit.metres;
    result.mapping.size = height_of_legs(body_, zero_pose(clip_.skeleton())) * unit.metres;
  }
  for (BoneSource& source : result.mapping.bones) {
    for (const Bone bone : kMappedBones) {
      if (body_.joint(bone) < 0 || body_.joint(bone) != source.rotation_joint) continue;
      source.rotation_joint = body_.turning_joint(bone);
      break;
    }
  }
  complete_lafan1_ends(body_, result.mapping.bones);
  result.mapping.human_from_source = z_up_from_file(movement_.up);
  if (const auto best = rest_finder().best_frame()) {
    result.forward = nearest_axis(best->second.axes.row(0));
    result.rest_deviation = deviation_from_t(body_, best->second).mean;
  }
  return {};
}

Result<void> Calibrator::bring_to_canonical_axes(Calibration& result) {
  TRY_ASSIGN(Rest rest, rest_finder().find());
  if (disbelieve_flipped_toes(rest.axes)) {
    TRY_ASSIGN(rest, rest_finder().find());
  }
  const RestCandidate& posed = rest.candidate;
  TRY_ASSIGN(const Unit unit, find_unit(standing_hip_height(body_, posed.pose, posed.axes),
                                        estimated_height(body_, posed.pose)));
  result.unit = unit.name;
  result.rest_pose = rest.name;
  result.rest_deviation = deviation_from_t(body_, rest.candidate).mean;
  result.forward = nearest_axis(rest.candidate.axes.row(0));
  result.mapping.dialect = map_.dialect;
  result.mapping.metres_per_unit = unit.metres;
  result.mapping.human_from_source = z_up_from_file(movement_.up);
  result.mapping.bones = bone_sources(body_, rest.axes, rest.candidate.pose);
  const double height = estimated_height(body_, rest.candidate.pose) * unit.metres;
  result.mapping.height = map_.facts.height.value_or(height > 0.0 ? height : 1.75);
  const double by_legs = height_of_legs(body_, rest.candidate.pose) * unit.metres;
  result.mapping.size = by_legs > 0.0 ? by_legs : result.mapping.height;
  return {};
}

void Calibrator::doubt_sides() {
  if (facing_evidence(body_, movement_.poses, movement_.up.direction()) < -0.2) {
    doubts_.push_back({0, 0,
                       "feet point and knees bend the wrong way: left and right are swapped "
                       "or the body is mirrored"});
  }
}

void Calibrator::doubt_height(const Calibration& found) {
  constexpr double kSmall = 1.3, kTall = 2.1;  // metres
  const double height = found.mapping.height;
  if (height >= kSmall && height <= kTall) return;
  doubts_.push_back({0, 0,
                     "a body height of " + metres_text(height) + " is unusual: " +
                         "if the unit is not " + found.unit + ", give " OPTION("unit")});
}

Result<Calibration> Calibrator::run() {
  TRY(check());
  look();
  doubt_sides();
  Calibration result;
  result.up = movement_.up;
  TRY(has_lafan1_axes() ? keep_lafan1_axes(result) : bring_to_canonical_axes(result));
  const bool is_published = result.rest_pose == "lafan1" && result.unit == "cm" &&
                            result.up == SignedAxis{} && !options_.height;
  if (options_.height) {
    result.mapping.height = result.mapping.size = *options_.height;
  } else if (!is_published && !options_.metres_per_unit) {
    doubt_height(result);
  }
  result.mapping.doubts.insert(result.mapping.doubts.end(), doubts_.begin(), doubts_.end());
  if (!is_published) result.mapping.description = describe_calibration(result);
  return result;
}

}  // namespace

std::string to_text(const SignedAxis& axis) {
  return std::string(axis.negative ? "-" : "+") + "xyz"[axis.axis];
}

Result<Calibration> calibrate(const Clip& clip, const BoneMap& map,
                              const CalibrationOptions& options, const std::string& file) {
  return Calibrator(clip, map, options, file).run();
}

}  // namespace retarget
