#include "retarget/human/calibrate.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "human/body_axes.h"
#include "human/bone_sources.h"
#include "human/lafan1_shape.h"
#include "human/learned_axes.h"
#include "human/posed_body.h"
#include "human/rest_pose.h"
#include "human/units.h"
#include "human/up_axis.h"

namespace retarget {
namespace {

// a frame within these is a T-pose that was meant as one
constexpr double kExactMean = 5.0;      // degrees
constexpr double kExactLargest = 12.0;  // degrees

// the pose that is brought to T, and the axes it gives
struct Rest {
  RestCandidate candidate;
  JointFromBone axes;
  std::string name;
};

// what is seen of a movement
struct View {
  std::vector<int> frames;
  std::vector<JointPoses> poses;
  SignedAxis up;
  std::vector<Warning> doubts;
};

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
  [[nodiscard]] std::optional<RestCandidate> candidate(JointPoses pose,
                                                       const Eigen::Vector3d& up) const;
  [[nodiscard]] std::optional<RestCandidate> zero_candidate(const Body& body) const;
  [[nodiscard]] std::optional<std::pair<int, RestCandidate>> best_frame() const;
  [[nodiscard]] std::optional<Rest> rest_of_dialect() const;
  [[nodiscard]] Result<Rest> find_rest() const;
  [[nodiscard]] Result<Rest> told_rest() const;
  [[nodiscard]] Result<Rest> rest_of_tpose_file() const;
  [[nodiscard]] Result<Rest> taken(std::optional<RestCandidate> candidate, std::string name) const;
  [[nodiscard]] Result<Unit> find_unit(double hip_height, double height);
  void doubt_sides();
  void doubt_height(const Calibration& found);

  const Clip& clip_;
  const BoneMap& map_;
  const CalibrationOptions& options_;
  const std::string& file_;
  Body body_;
  View view_;
  // as far as offsets count: of joints in one place the uppermost, which has the length
  JointOfBone joint_of_ = [this](std::string_view bone) -> std::optional<int> {
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
  if (!body_.has("Hips")) {
    return input_failure(file_, "no joint stands for the hips", "name it in a mapping file");
  }
  std::vector<std::string> missing;
  for (const std::string side : {"Left", "Right"}) {
    for (const char* part : {"UpLeg", "Leg", "Foot", "Arm", "ForeArm"}) {
      if (!body_.has(side + part)) missing.push_back(side + part);
    }
  }
  if (!missing.empty() && !map_.partial) {
    return input_failure(file_, "no joints stand for " + joined(missing),
                         "legs and arms are needed, unless --partial is given");
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
  view_.frames = sampled_frames(clip_);
  for (const int frame : view_.frames) view_.poses.push_back(frame_pose(clip_, frame));
  if (options_.up) {
    view_.up = *options_.up;
    return;
  }
  KnownUp known;
  if (map_.facts.up) known.of_kind = nearest_axis(*map_.facts.up);
  if (const auto zero = zero_candidate(body_); zero && is_well_formed(body_, *zero)) {
    known.of_zero_pose = nearest_axis(zero->axes.row(2));
  }
  const UpChoice up = choose_up(body_, view_.poses, known);
  view_.up = up.axis;
  if (up.doubtful) {
    view_.doubts.push_back({0, 0,
                            "the body hardly ever stands: " + to_text(up.axis) +
                                " was taken as the up axis; give --up if that is wrong"});
  }
}

std::optional<RestCandidate> Calibrator::candidate(JointPoses pose,
                                                   const Eigen::Vector3d& up) const {
  std::optional<BodyFromFile> axes;
  if (!options_.forward) {
    axes = body_axes(body_, pose, up);
  } else if (up.cross(options_.forward->direction()).norm() > 0.5) {
    axes = told_axes(options_.forward->direction(), up);
  }
  if (!axes) return std::nullopt;
  return RestCandidate{std::move(pose), *axes};
}

// a zero pose is built along its own axes, which need not be those of the movement
std::optional<RestCandidate> Calibrator::zero_candidate(const Body& body) const {
  JointPoses pose = zero_pose(body.skeleton());
  const auto trunk = trunk_direction(body, pose);
  if (!trunk) return std::nullopt;
  auto found = candidate(std::move(pose), nearest_axis(*trunk).direction());
  if (found) found->is_built = true;
  return found;
}

std::optional<std::pair<int, RestCandidate>> Calibrator::best_frame() const {
  std::optional<std::pair<int, RestCandidate>> best;
  double least = 0.0;
  for (std::size_t i = 0; i < view_.poses.size(); ++i) {
    auto found = candidate(view_.poses[i], view_.up.direction());
    if (!found) continue;
    const double mean = deviation_from_t(body_, *found).mean;
    // poses that are equal but for rounding count as one, the first
    if (best && mean > least - 1e-6) continue;
    least = mean;
    best = std::pair(view_.frames[i], *std::move(found));
  }
  return best;
}

Result<Rest> Calibrator::taken(std::optional<RestCandidate> found, std::string name) const {
  if (!found) {
    return input_failure(file_, "the " + name + " shows no facing: hips and shoulders lie along up",
                         "choose another rest pose, or give --forward");
  }
  JointFromBone axes = bring_to_t(body_, *found);
  return Rest{*std::move(found), std::move(axes), std::move(name)};
}

Result<Rest> Calibrator::rest_of_tpose_file() const {
  const Skeleton& own = clip_.skeleton();
  const Clip& tpose = *options_.tpose;
  const JointPoses given =
      tpose.frame_count() > 0 ? frame_pose(tpose, 0) : zero_pose(tpose.skeleton());
  // only the mapped joints and the ends of their bones are looked at
  JointPoses pose = zero_pose(own);
  for (int joint = 0; joint < own.joint_count(); ++joint) {
    const auto same = tpose.skeleton().find(own.joint(joint).name);
    if (same) pose[joint] = given[*same];
    if (!same && std::ranges::count(map_.joint_of_bone, joint) > 0) {
      return input_failure(file_, "the T-pose file has no joint \"" + own.joint(joint).name + "\"",
                           "give a T-pose of the same skeleton");
    }
  }
  const auto trunk = trunk_direction(body_, pose);
  if (!trunk) return taken(std::nullopt, "T-pose file");
  return taken(candidate(std::move(pose), nearest_axis(*trunk).direction()), "T-pose file");
}

Result<Rest> Calibrator::told_rest() const {
  if (options_.rest == RestPose::kZero) return taken(zero_candidate(body_), "zero pose");
  if (clip_.frame_count() == 0) return input_failure(file_, "no frames: no frame is a rest pose");
  const auto best = best_frame();
  if (options_.rest == RestPose::kBest || options_.rest == RestPose::kLearned) {
    if (!best) return taken(std::nullopt, "movement");
    if (options_.rest == RestPose::kBest) {
      return taken(best->second, "frame " + std::to_string(best->first));
    }
    return Rest{best->second, learned_axes(body_, view_.poses, view_.up.direction(), best->second),
                "learned"};
  }
  const int frame = options_.rest == RestPose::kFirst ? 0 : options_.rest_frame;
  if (frame < 0 || frame >= clip_.frame_count()) {
    return usage_failure("no frame " + std::to_string(frame) + ": the clip has " +
                         std::to_string(clip_.frame_count()));
  }
  return taken(candidate(frame_pose(clip_, frame), view_.up.direction()),
               "frame " + std::to_string(frame));
}

// the rest pose of a kind of skeleton, when it is one in this file
std::optional<Rest> Calibrator::rest_of_dialect() const {
  constexpr double kMostOff = 20.0;  // degrees
  const std::string& known = map_.facts.rest_pose;
  std::optional<RestCandidate> pose;
  if (known == "zero") pose = zero_candidate(body_);
  if (known == "first" && clip_.frame_count() > 0) {
    pose = candidate(frame_pose(clip_, 0), view_.up.direction());
  }
  if (!pose || deviation_from_t(body_, *pose).mean > kMostOff) return std::nullopt;
  auto rest = taken(std::move(pose), known == "zero" ? "zero pose" : "frame 0");
  return rest ? std::optional<Rest>(*std::move(rest)) : std::nullopt;
}

Result<Rest> Calibrator::find_rest() const {
  if (options_.tpose) return rest_of_tpose_file();
  if (options_.rest != RestPose::kAuto) return told_rest();
  if (auto known = rest_of_dialect()) return *std::move(known);
  const auto zero = zero_candidate(body_);
  if (zero && is_well_formed(body_, *zero)) {
    auto rest = taken(zero, "zero pose");
    if (rest && !view_.poses.empty()) {
      rest->axes = with_corrected_arms(body_, view_.poses, view_.up.direction(), rest->axes);
    }
    return rest;
  }
  const auto best = best_frame();
  if (!best) return taken(std::nullopt, "movement");
  const Deviation deviation = deviation_from_t(body_, best->second);
  if (deviation.mean < kExactMean && deviation.largest < kExactLargest) {
    return taken(best->second, "frame " + std::to_string(best->first));
  }
  return Rest{best->second, learned_axes(body_, view_.poses, view_.up.direction(), best->second),
              "learned"};
}

Result<Unit> Calibrator::find_unit(double hip_height, double height) {
  if (options_.metres_per_unit) return Unit{"given", *options_.metres_per_unit};
  const auto unit = unit_of_body({hip_height, height, map_.facts.metres_per_unit, options_.height});
  if (unit) return *unit;
  if (options_.unit_optional) {
    const Unit assumed = unit_of_average_body(height);
    view_.doubts.push_back({0, 0, assumed_unit_text(hip_height)});
    return assumed;
  }
  return input_failure(file_,
                       hip_height > 0.0
                           ? "hips " + std::to_string(hip_height) +
                                 " units above the floor are a person's in no known unit"
                           : "without a leg the unit cannot be told",
                       "give the unit's length in metres with --unit" +
                           std::string(height > 0.0 ? ", or the body's height with --height" : ""));
}

bool Calibrator::has_lafan1_axes() const {
  return map_.dialect == "lafan1" && options_.rest == RestPose::kAuto && !options_.tpose &&
         !options_.forward && bones_off_lafan1_axes(clip_.skeleton(), joint_of_).empty();
}

// the published method's mapping; copies in other units or with another axis up keep its axes too,
// and so do bodies of another size, whose height is their own
Result<void> Calibrator::keep_lafan1_axes(Calibration& result) {
  constexpr double kHipHeightPerLeg = 1.12;
  const double own_height = estimated_height(body_, zero_pose(clip_.skeleton()));
  const auto unit =
      find_unit(kHipHeightPerLeg * lafan1_leg_length(clip_.skeleton(), joint_of_), own_height);
  if (!unit) return failure(unit.error());
  result.mapping = lafan1_mapping(map_);
  const bool is_published = unit->metres == result.mapping.metres_per_unit;
  result.unit = is_published ? "cm" : unit->name;
  result.rest_pose = "lafan1";
  result.mapping.metres_per_unit = unit->metres;
  if (own_height > 0.0 && !is_lafan1_height(own_height * unit->metres)) {
    result.rest_pose = "lafan1 axes";
    result.mapping.height = own_height * unit->metres;
    result.mapping.size = height_of_legs(body_, zero_pose(clip_.skeleton())) * unit->metres;
  }
  for (BoneSource& source : result.mapping.bones) {
    for (int bone = 0; bone < kMappedBoneCount; ++bone) {
      if (body_.joint(bone) < 0 || body_.joint(bone) != source.rotation_joint) continue;
      source.rotation_joint = body_.turning_joint(bone);
      break;
    }
  }
  result.mapping.human_from_source = z_up_from_file(view_.up);
  if (const auto best = best_frame()) {
    result.forward = nearest_axis(best->second.axes.row(0));
    result.rest_deviation = deviation_from_t(body_, best->second).mean;
  }
  return {};
}

Result<void> Calibrator::bring_to_canonical_axes(Calibration& result) {
  const auto rest = find_rest();
  if (!rest) return failure(rest.error());
  const RestCandidate& posed = rest->candidate;
  const auto unit = find_unit(standing_hip_height(body_, posed.pose, posed.axes),
                              estimated_height(body_, posed.pose));
  if (!unit) return failure(unit.error());
  result.unit = unit->name;
  result.rest_pose = rest->name;
  result.rest_deviation = deviation_from_t(body_, rest->candidate).mean;
  result.forward = nearest_axis(rest->candidate.axes.row(0));
  result.mapping.dialect = map_.dialect;
  result.mapping.metres_per_unit = unit->metres;
  result.mapping.human_from_source = z_up_from_file(view_.up);
  result.mapping.bones = bone_sources(body_, rest->axes);
  const double height = estimated_height(body_, rest->candidate.pose) * unit->metres;
  result.mapping.height = map_.facts.height.value_or(height > 0.0 ? height : 1.75);
  const double by_legs = height_of_legs(body_, rest->candidate.pose) * unit->metres;
  result.mapping.size = by_legs > 0.0 ? by_legs : result.mapping.height;
  return {};
}

void Calibrator::doubt_sides() {
  if (facing_evidence(body_, view_.poses, view_.up.direction()) < -0.2) {
    view_.doubts.push_back({0, 0,
                            "feet point and knees bend the wrong way: left and right are swapped "
                            "or the body is mirrored"});
  }
}

void Calibrator::doubt_height(const Calibration& found) {
  constexpr double kSmall = 1.3, kTall = 2.1;  // metres
  const double height = found.mapping.height;
  if (height >= kSmall && height <= kTall) return;
  view_.doubts.push_back({0, 0,
                          "a body height of " + metres_text(height) + " is unusual: " +
                              "if the unit is not " + found.unit + ", give --unit"});
}

Result<Calibration> Calibrator::run() {
  if (const auto checked = check(); !checked) return failure(checked.error());
  look();
  doubt_sides();
  Calibration result;
  result.up = view_.up;
  const auto done = has_lafan1_axes() ? keep_lafan1_axes(result) : bring_to_canonical_axes(result);
  if (!done) return failure(done.error());
  const bool is_published = result.rest_pose == "lafan1" && result.unit == "cm" &&
                            result.up == SignedAxis{} && !options_.height;
  if (options_.height) {
    result.mapping.height = result.mapping.size = *options_.height;
  } else if (!is_published && !options_.metres_per_unit) {
    doubt_height(result);
  }
  result.mapping.doubts.insert(result.mapping.doubts.end(), view_.doubts.begin(),
                               view_.doubts.end());
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
