#include "human/recognise.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/option_name.h"
#include "base/suggest.h"
#include "human/body_words.h"
#include "human/candidate.h"
#include "human/human_proportions.h"
#include "human/recognise_by_dialect.h"
#include "human/recognise_by_names.h"
#include "human/recognise_by_shape.h"
#include "human/trunk.h"
#include "human/verify_bone_map.h"

namespace retarget {
namespace {

constexpr const char* kMapHint = "give a mapping file with " OPTION("map");

// bones a body does without
bool is_optional(Bone bone) {
  const std::optional<LimbBone> part = limb_bone(bone);
  if (!part) return bone != Bone::kHips && bone != Bone::kSpine2;
  return part == LimbBone::kToe || part == LimbBone::kShoulder || part == LimbBone::kHand;
}

// joints that are mapped and share their name with another one: bones that a body does without are
// left out, others are an error
std::optional<Error> settle_doubled_names(const BodySource& source, BoneMap& map) {
  for (const Bone bone : kMappedBones) {
    const int joint = map.joint_of_bone[bone];
    // names that say nothing of a body are not what the joint was found by
    if (joint < 0 || roles_of(source.names[joint]).empty()) continue;
    const std::string& name = source.skeleton.joint(joint).name;
    const auto count = std::ranges::count(source.skeleton.joints(), name, &Joint::name);
    if (count < 2) continue;
    const std::string what = std::to_string(count) + " joints are called \"" + name +
                             "\": which of them is the " + std::string(bone_name(bone)) +
                             " cannot be told";
    if (!is_optional(bone)) {
      return input_failure(source.file, what, "rename all but one of them").value();
    }
    map.joint_of_bone[bone] = -1;
    map.notes.push_back(what + ", it is left out");
  }
  return std::nullopt;
}

std::string sentence_of(const std::vector<std::string>& parts) {
  std::string text = parts.front();
  for (std::size_t i = 1; i < parts.size(); ++i) {
    text += (i + 1 == parts.size() ? " and " : ", ") + parts[i];
  }
  return text;
}

// what the ways of recognising found, to choose from and to speak of
class Recogniser {
 public:
  Recogniser(const BodySource& source, const std::vector<Dialect>& dialects,
             const RecogniseOptions& options)
      : source_(source), dialects_(dialects), options_(options) {}

  Result<BoneMap> run() {
    if (auto map = recognise_by_dialect(source_, dialects_)) consider(std::move(*map));
    if (accepted_) return finish();
    const std::optional<Error> by_names = consider_candidate(recognise_by_names(source_));
    if (accepted_) return finish();
    // limbs that names left out or put wrongly
    const std::optional<Error> by_shape = consider_candidate(recognise_by_shape(source_));
    if (accepted_ && overrules_names(*accepted_)) accepted_.reset();
    if (by_names && !(accepted_ && names_mean_nothing(*accepted_))) return failure(*by_names);
    if (accepted_) return finish();
    if (by_shape && incomplete_.empty()) return failure(*by_shape);
    return refuse_or_take_part();
  }

 private:
  // whether most joints that the shape maps are called after other parts of the body
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

  // whether a shape shifts a limb: it takes a joint that plainly is one bone for another, where
  // names that mean something are believed but leave bones out
  bool overrules_names(const BoneMap& shape) const {
    if (names_mean_nothing(shape)) return false;
    return std::ranges::any_of(incomplete_, [&](const BoneMap& named) {
      for (const Bone bone : kMappedBones) {
        const int joint = named.joint_of_bone[bone];
        if (joint < 0 || side_of(bone) == Side::kNone || shape.joint_of_bone[bone] == joint) {
          continue;
        }
        const bool is_plain = named.dialect != "names" || plainly_means(source_.names[joint], bone);
        const bool is_other =
            std::ranges::find(shape.joint_of_bone, joint) != shape.joint_of_bone.end();
        if (is_plain && is_other) return true;
      }
      return false;
    });
  }

  // an error to stop at, if there is one
  std::optional<Error> consider_candidate(Candidate candidate) {
    if (!candidate) return candidate.error();
    if (*candidate) consider(std::move(**candidate));
    return std::nullopt;
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
    if (auto doubled = settle_doubled_names(source_, *accepted_)) return failure(*doubled);
    const HumanDoubts doubts = doubt_human(source_, *accepted_);
    if (doubts.proven) {
      return input_failure(source_.file,
                           "the skeleton is not a human's: " + sentence_of(doubts.signs),
                           std::string("if it is one, ") + kMapHint);
    }
    for (const std::string& sign : doubts.signs) {
      accepted_->notes.push_back("odd for a human: " + sign);
      accepted_->confidence *= kOddity;
    }
    add_trunk_notes(source_, *accepted_);
    return *accepted_;
  }

  // the incomplete map with the most bones, if it is one that lacks arms or legs alone
  Result<BoneMap> refuse_or_take_part() {
    const auto bones = [](const BoneMap& map) {
      return std::ranges::count_if(map.joint_of_bone, [](int joint) { return joint >= 0; });
    };
    const auto best = std::ranges::max_element(incomplete_, {}, bones);
    if (best == incomplete_.end()) return no_human({"legs", "arms"});
    const std::vector<std::string> missing = missing_parts(*best);
    const auto lacks = [&](const std::string& part) {
      return std::ranges::find(missing, part) != missing.end();
    };
    const auto is_limb_of = [&](const std::string& limb) {
      return std::ranges::any_of(
          missing, [&](const std::string& part) { return part.find(limb) != std::string::npos; });
    };
    if (lacks("hips") || (is_limb_of("leg") && is_limb_of("arm"))) return no_human(missing);
    if (!options_.partial) {
      return input_failure(source_.file, "no " + sentence_of(missing) + " found in the skeleton",
                           std::string("go on without with " OPTION("partial") ", or ") + kMapHint);
    }
    accepted_ = *best;
    accepted_->partial = true;
    accepted_->notes.push_back("partial: the source has no " + sentence_of(missing));
    return finish();
  }

  Failure no_human(const std::vector<std::string>& missing) const {
    const int count = source_.skeleton.joint_count();
    std::string message = "no human skeleton: no " + sentence_of(missing) + " found in its " +
                          std::to_string(count) + (count == 1 ? " joint" : " joints");
    if (!faults_.empty()) message += "; " + faults_.front();
    return input_failure(source_.file, message,
                         std::string("if the skeleton is a human's, ") + kMapHint);
  }

  static constexpr double kOddity = 0.85;

  const BodySource& source_;
  const std::vector<Dialect>& dialects_;
  const RecogniseOptions& options_;
  std::optional<BoneMap> accepted_;
  std::vector<BoneMap> incomplete_;  // verified, but without some limb
  std::vector<std::string> faults_;  // why others were not believed
};

Result<BoneMap> recognise(const Skeleton& skeleton, BodyPoses poses,
                          const std::vector<Dialect>& dialects, const std::string& file,
                          const RecogniseOptions& options) {
  const BodySource source{skeleton, file, SkeletonTree(skeleton),
                          normalise_joint_names(skeleton.names()), std::move(poses)};
  return Recogniser(source, dialects, options).run();
}

}  // namespace

Result<BoneMap> recognise_skeleton(const Skeleton& skeleton, const std::vector<Dialect>& dialects,
                                   const std::string& file, const RecogniseOptions& options) {
  return recognise(skeleton, sample_zero_pose(skeleton), dialects, file, options);
}

Result<BoneMap> recognise_skeleton(const Clip& clip, const std::vector<Dialect>& dialects,
                                   const std::string& file, const RecogniseOptions& options) {
  return recognise(clip.skeleton(), sample_poses(clip), dialects, file, options);
}

}  // namespace retarget
