#include "human/skeleton/body_words.h"

#include <algorithm>
#include <array>
#include <optional>

namespace retarget {
namespace {

/// Words that name a bone, separated by spaces. The left bone represents both sides.
struct BoneWords {
  Bone bone;
  double weight;  // Below 1 if the words mean different parts in different profiles.
  std::string_view words;
};

constexpr std::array kBoneWords = {
    // Escaped: foot, leg.
    BoneWords{Bone::kLeftUpLeg, 1.0, "upleg upperleg thigh thighbend femur \xE8\xB6\xB3"},
    BoneWords{Bone::kLeftUpLeg, 0.9, "hip"}, BoneWords{Bone::kLeftUpLeg, 0.6, "leg"},
    BoneWords{Bone::kLeftLeg, 0.6, "leg"},
    // Escaped: knee.
    BoneWords{Bone::kLeftLeg, 1.0,
              "lowleg lowerleg loleg shin knee calf tibia \xE3\x81\xB2\xE3\x81\x96"},
    BoneWords{Bone::kLeftFoot, 0.8, "foot"}, BoneWords{Bone::kLeftToe, 0.6, "foot"},
    BoneWords{Bone::kLeftFoot, 1.0, "ankle \xE8\xB6\xB3\xE9\xA6\x96"},  // Escaped: ankle.
    // Escaped: tip of the toes.
    BoneWords{Bone::kLeftToe, 1.0,
              "toe toes toebase toejoint ball \xE3\x81\xA4\xE3\x81\xBE\xE5\x85\x88"},
    // Escaped: shoulder.
    BoneWords{Bone::kLeftShoulder, 1.0, "collar collarbone clavicle \xE8\x82\xA9"},
    BoneWords{Bone::kLeftShoulder, 0.6, "shoulder"}, BoneWords{Bone::kLeftArm, 0.6, "shoulder"},
    // Escaped: arm.
    BoneWords{Bone::kLeftArm, 1.0, "upperarm uparm uarm shldr shldrbend humerus \xE8\x85\x95"},
    BoneWords{Bone::kLeftArm, 0.9, "arm"}, BoneWords{Bone::kLeftForeArm, 0.3, "arm"},
    // Escaped: elbow.
    BoneWords{Bone::kLeftForeArm, 1.0,
              "forearm forearmbend lowerarm lowarm loarm farm elbow radius "
              "\xE3\x81\xB2\xE3\x81\x98"},
    BoneWords{Bone::kLeftHand, 1.0, "hand wrist \xE6\x89\x8B\xE9\xA6\x96"},  // Escaped: wrist.
    // Escaped: lower body.
    BoneWords{Bone::kHips, 1.0, "hips pelvis \xE4\xB8\x8B\xE5\x8D\x8A\xE8\xBA\xAB"},
    BoneWords{Bone::kHips, 0.9, "hip"}, BoneWords{Bone::kHips, 0.3, "root rootjoint"},
    BoneWords{Bone::kSpine, 1.0,
              "spine chest upperchest thorax torso abdomen waist lowerback upperback"},
    BoneWords{Bone::kNeck, 1.0, "neck lowerneck upperneck \xE9\xA6\x96"},  // Escaped: neck.
    BoneWords{Bone::kHead, 1.0, "head skull \xE9\xA0\xAD"},                // Escaped: head.
};

constexpr std::string_view kAnimalWords =
    "tail paw wing hoof muzzle snout fetlock tusk frontleg foreleg forelimb hindleg hindlimb "
    "frontpaw backpaw proboscis";

// A number may denote one of several segments of a limb part, which lowers the weight.
constexpr double kNumberedLimb = 0.5;
// A word of at least this weight is unambiguous.
constexpr double kPlain = 0.8;

bool has_word(std::string_view words, std::string_view word) {
  while (!words.empty()) {
    const std::size_t end = std::min(words.find(' '), words.size());
    if (words.substr(0, end) == word) return true;
    words.remove_prefix(std::min(end + 1, words.size()));
  }
  return false;
}

double weight_of_bone(const JointName& name, Bone bone) {
  const std::optional<LimbBone> part = limb_bone(bone);
  if (part == LimbBone::kFootMod) bone = side_bone(side_of(bone), LimbBone::kFoot);
  if (bone == Bone::kSpine1 || bone == Bone::kSpine2) bone = Bone::kSpine;
  double weight = 0.0;
  for (const WordMeaning& meaning : meanings_of(name)) {
    if (meaning.bone == bone) weight = std::max(weight, meaning.weight);
  }
  return weight;
}

}  // namespace

std::string_view without_number(std::string_view base) {
  const std::size_t last = base.find_last_not_of("0123456789");
  return last == std::string_view::npos ? base : base.substr(0, last + 1);
}

std::vector<WordMeaning> meanings_of(const JointName& name) {
  std::vector<WordMeaning> meanings;
  const std::string_view plain = without_number(name.base);
  const bool of_limb = name.side != Side::kNone;
  const double factor = of_limb && plain != name.base ? kNumberedLimb : 1.0;
  for (const auto& [bone, weight, words] : kBoneWords) {
    if ((side_of(bone) != Side::kNone) != of_limb || !has_word(words, plain)) continue;
    meanings.push_back({name.side == Side::kRight ? mirrored(bone) : bone, weight * factor});
  }
  return meanings;
}

bool may_mean(const JointName& name, Bone bone) {
  return weight_of_bone(name, bone) > 0.0;
}

bool plainly_means(const JointName& name, Bone bone) {
  return weight_of_bone(name, bone) >= kPlain;
}

bool is_limb_word(std::string_view base) {
  return std::ranges::any_of(kBoneWords, [base](const BoneWords& of) {
    return side_of(of.bone) != Side::kNone && has_word(of.words, base);
  });
}

bool is_animal_word(std::string_view base) {
  return has_word(kAnimalWords, without_number(base));
}

}  // namespace retarget
