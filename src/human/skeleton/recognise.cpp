#include "human/skeleton/recognise.h"

#include <fmt/format.h>
#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "base/faults.h"
#include "base/option_name.h"
#include "base/try.h"
#include "human/skeleton/candidate.h"
#include "human/skeleton/joint_names.h"
#include "human/skeleton/posed_body.h"
#include "human/skeleton/skeleton_tree.h"
#include "retarget/text.h"

namespace retarget {
namespace {

constexpr const char* kMapHint = "give a bone map with " OPTION("map");

// Whether a body is complete without this bone.
bool is_optional(Bone bone) {
  const std::optional<LimbBone> part = limb_bone(bone);
  if (!part) return bone != Bone::kHips && bone != Bone::kSpine2;
  return part == LimbBone::kToe || part == LimbBone::kShoulder || part == LimbBone::kHand;
}

// Handles mapped joints that share their name with another joint: optional bones are removed from
// the map, others are an error.
Result<void> settle_doubled_names(const BodySource& source, BoneMap& map) {
  for (const Bone bone : kMappedBones) {
    const int joint = map.joint_of_bone[bone];
    // A joint whose name has no meaning was not found by its name.
    if (joint < 0 || meanings_of(source.names[joint]).empty()) continue;
    const std::string& name = source.skeleton.joint(joint).name;
    const auto count = std::ranges::count(source.skeleton.joints(), name, &Joint::name);
    if (count < 2) continue;
    const std::string what = fmt::format("{} joints are called \"{}\", so the {} is ambiguous",
                                         count, name, bone_name(bone));
    if (!is_optional(bone)) return input_failure({}, what, "rename all but one of them");
    map.joint_of_bone[bone] = -1;
    map.notes.push_back(what + ": it is not used");
  }
  return {};
}

std::string sentence_of(const std::vector<std::string>& parts) {
  if (parts.size() == 1) return parts.front();
  return fmt::format("{} and {}", fmt::join(parts.begin(), parts.end() - 1, ", "), parts.back());
}

// Runs the recognition methods and chooses among their results.
class Recogniser {
 public:
  Recogniser(const BodySource& source, const std::vector<SkeletonProfile>& profiles,
             const RecogniseOptions& options)
      : source_(source), profiles_(profiles), options_(options) {}

  Result<BoneMap> run() {
    if (auto map = recognise_by_profile(source_, profiles_)) consider(std::move(*map));
    if (accepted_) return finish();
    const Result<void> by_names = consider_candidate(recognise_by_names(source_));
    if (accepted_) return finish();
    // The shape may give limbs that the names miss or misplace.
    const Result<void> by_shape = consider_candidate(recognise_by_shape(source_));
    if (accepted_ && overrides_names(*accepted_)) accepted_.reset();
    if (!(accepted_ && names_mean_nothing(*accepted_))) TRY(by_names);
    if (accepted_) return finish();
    if (incomplete_.empty()) TRY(by_shape);
    return refuse_or_take_part();
  }

 private:
  // Whether most joints that the shape maps have names of other parts of the body.
  bool names_mean_nothing(const BoneMap& map) const {
    int mapped = 0, fitting = 0;
    for (const Bone bone : kMappedBones) {
      const int joint = map.joint_of_bone[bone];
      if (joint < 0) continue;
      ++mapped;
      fitting += may_mean(source_.names[joint], bone) ? 1 : 0;
    }
    return 2 * fitting < mapped;
  }

  // Whether a shape shifts a limb: if the names are meaningful but incomplete, it assigns a joint
  // whose name clearly means one bone to another bone.
  bool overrides_names(const BoneMap& shape) const {
    if (names_mean_nothing(shape)) return false;
    return std::ranges::any_of(incomplete_, [&](const BoneMap& named) {
      for (const Bone bone : kMappedBones) {
        const int joint = named.joint_of_bone[bone];
        if (joint < 0 || side_of(bone) == Side::kNone || shape.joint_of_bone[bone] == joint) {
          continue;
        }
        const bool is_plain = named.profile != "names" || plainly_means(source_.names[joint], bone);
        if (is_plain && shape.maps(joint)) return true;
      }
      return false;
    });
  }

  // Returns the candidate's error, if any.
  Result<void> consider_candidate(Candidate candidate) {
    TRY_ASSIGN(auto map, std::move(candidate));
    if (map) consider(std::move(*map));
    return {};
  }

  void consider(BoneMap map) {
    const Verdict verdict = verify_bone_map(source_, map);
    if (!verdict.faults.empty()) {
      faults_.insert(faults_.end(), verdict.faults.begin(), verdict.faults.end());
      return;
    }
    map.confidence *= verdict.confidence;
    map.notes.insert(map.notes.end(), verdict.doubts.begin(), verdict.doubts.end());
    if (missing_parts(map).empty()) {
      accepted_ = std::move(map);
    } else {
      incomplete_.push_back(std::move(map));
    }
  }

  Result<BoneMap> finish() {
    TRY(settle_doubled_names(source_, *accepted_));
    const HumanDoubts doubts = doubt_human(source_, *accepted_);
    if (doubts.proven) {
      return input_failure({}, "the skeleton is not human: " + sentence_of(doubts.signs),
                           std::string("if it is human, ") + kMapHint);
    }
    for (const std::string& sign : doubts.signs) {
      accepted_->notes.push_back("unusual for a human: " + sign);
      accepted_->confidence *= kOddity;
    }
    add_trunk_notes(source_, *accepted_);
    return *accepted_;
  }

  // Takes the incomplete map with the most bones, if it lacks only arms or only legs.
  Result<BoneMap> refuse_or_take_part() {
    const auto best = std::ranges::max_element(incomplete_, {}, &BoneMap::mapped_count);
    if (best == incomplete_.end()) return no_human({"legs", "arms"});
    const std::vector<std::string> missing = missing_parts(*best);
    const auto lacks = [&](std::string_view part) {
      return std::ranges::any_of(
          missing, [&](const std::string& one) { return one.find(part) != std::string::npos; });
    };
    if (lacks("hips") || (lacks("leg") && lacks("arm"))) return no_human(missing);
    if (!options_.partial) {
      return input_failure({}, "no " + sentence_of(missing) + " found in the skeleton",
                           std::string(OPTION("partial") " continues without, or ") + kMapHint);
    }
    accepted_ = *best;
    accepted_->partial = true;
    accepted_->notes.push_back("partial: the source has no " + sentence_of(missing));
    return finish();
  }

  Failure no_human(const std::vector<std::string>& missing) const {
    return input_failure(
        {},
        fmt::format("not a human skeleton: no {} found in its {}{}{}", sentence_of(missing),
                    count_text(source_.skeleton.joint_count(), "joint"),
                    faults_.empty() ? "" : "; ", faults_.empty() ? "" : faults_.front()),
        std::string("if it is human, ") + kMapHint);
  }

  static constexpr double kOddity = 0.85;

  const BodySource& source_;
  const std::vector<SkeletonProfile>& profiles_;
  const RecogniseOptions& options_;
  std::optional<BoneMap> accepted_;
  std::vector<BoneMap> incomplete_;  // Verified, but missing a limb.
  std::vector<std::string> faults_;  // Reasons for the rejection of other maps.
};

Result<BoneMap> recognise(const Skeleton& skeleton, BodyPoses poses,
                          const std::vector<SkeletonProfile>& profiles,
                          const RecogniseOptions& options) {
  const BodySource source{skeleton, SkeletonTree(skeleton), normalise_joint_names(skeleton.names()),
                          std::move(poses)};
  return Recogniser(source, profiles, options).run();
}

}  // namespace

Result<BoneMap> recognise_skeleton(const Skeleton& skeleton,
                                   const std::vector<SkeletonProfile>& profiles,
                                   const RecogniseOptions& options) {
  return recognise(skeleton, sample_zero_pose(skeleton), profiles, options);
}

Result<BoneMap> recognise_skeleton(const Clip& clip, const std::vector<SkeletonProfile>& profiles,
                                   const RecogniseOptions& options) {
  return located(recognise(clip.skeleton(), sample_poses(clip), profiles, options), clip.name());
}

}  // namespace retarget
