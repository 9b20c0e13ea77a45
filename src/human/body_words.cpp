#include "human/body_words.h"

#include <algorithm>
#include <array>

namespace retarget {
namespace {

struct Word {
  std::string_view text;
  Role role;
  double weight;
};

// weights below 1 are of words that mean different parts in different dialects
constexpr std::array kLimbWords = {
    Word{"upleg", Role::kThigh, 1.0},
    Word{"upperleg", Role::kThigh, 1.0},
    Word{"thigh", Role::kThigh, 1.0},
    Word{"thighbend", Role::kThigh, 1.0},
    Word{"femur", Role::kThigh, 1.0},
    Word{"hip", Role::kThigh, 0.9},
    Word{"leg", Role::kThigh, 0.6},
    Word{"\xE8\xB6\xB3", Role::kThigh, 1.0},  // foot, leg
    Word{"leg", Role::kShin, 0.6},
    Word{"lowleg", Role::kShin, 1.0},
    Word{"lowerleg", Role::kShin, 1.0},
    Word{"loleg", Role::kShin, 1.0},
    Word{"shin", Role::kShin, 1.0},
    Word{"knee", Role::kShin, 1.0},
    Word{"calf", Role::kShin, 1.0},
    Word{"tibia", Role::kShin, 1.0},
    Word{"\xE3\x81\xB2\xE3\x81\x96", Role::kShin, 1.0},  // knee
    Word{"foot", Role::kFoot, 0.8},
    Word{"foot", Role::kToe, 0.6},
    Word{"ankle", Role::kFoot, 1.0},
    Word{"\xE8\xB6\xB3\xE9\xA6\x96", Role::kFoot, 1.0},  // ankle
    Word{"toe", Role::kToe, 1.0},
    Word{"toes", Role::kToe, 1.0},
    Word{"toebase", Role::kToe, 1.0},
    Word{"toejoint", Role::kToe, 1.0},
    Word{"ball", Role::kToe, 1.0},
    Word{"\xE3\x81\xA4\xE3\x81\xBE\xE5\x85\x88", Role::kToe, 1.0},  // tip of the toes
    Word{"collar", Role::kClavicle, 1.0},
    Word{"collarbone", Role::kClavicle, 1.0},
    Word{"clavicle", Role::kClavicle, 1.0},
    Word{"shoulder", Role::kClavicle, 0.6},
    Word{"\xE8\x82\xA9", Role::kClavicle, 1.0},  // shoulder
    Word{"shoulder", Role::kUpperArm, 0.6},
    Word{"upperarm", Role::kUpperArm, 1.0},
    Word{"uparm", Role::kUpperArm, 1.0},
    Word{"uarm", Role::kUpperArm, 1.0},
    Word{"shldr", Role::kUpperArm, 1.0},
    Word{"shldrbend", Role::kUpperArm, 1.0},
    Word{"humerus", Role::kUpperArm, 1.0},
    Word{"arm", Role::kUpperArm, 0.9},
    Word{"\xE8\x85\x95", Role::kUpperArm, 1.0},  // arm
    Word{"arm", Role::kForearm, 0.3},
    Word{"forearm", Role::kForearm, 1.0},
    Word{"forearmbend", Role::kForearm, 1.0},
    Word{"lowerarm", Role::kForearm, 1.0},
    Word{"lowarm", Role::kForearm, 1.0},
    Word{"loarm", Role::kForearm, 1.0},
    Word{"farm", Role::kForearm, 1.0},
    Word{"elbow", Role::kForearm, 1.0},
    Word{"radius", Role::kForearm, 1.0},
    Word{"\xE3\x81\xB2\xE3\x81\x98", Role::kForearm, 1.0},  // elbow
    Word{"hand", Role::kHand, 1.0},
    Word{"wrist", Role::kHand, 1.0},
    Word{"\xE6\x89\x8B\xE9\xA6\x96", Role::kHand, 1.0},  // wrist
};

constexpr std::array kTrunkWords = {
    Word{"hips", Role::kHips, 1.0},
    Word{"pelvis", Role::kHips, 1.0},
    Word{"hip", Role::kHips, 0.9},
    Word{"root", Role::kHips, 0.3},
    Word{"spine", Role::kSpine, 1.0},
    Word{"chest", Role::kSpine, 1.0},
    Word{"upperchest", Role::kSpine, 1.0},
    Word{"thorax", Role::kSpine, 1.0},
    Word{"torso", Role::kSpine, 1.0},
    Word{"abdomen", Role::kSpine, 1.0},
    Word{"waist", Role::kSpine, 1.0},
    Word{"lowerback", Role::kSpine, 1.0},
    Word{"upperback", Role::kSpine, 1.0},
    Word{"neck", Role::kNeck, 1.0},
    Word{"lowerneck", Role::kNeck, 1.0},
    Word{"upperneck", Role::kNeck, 1.0},
    Word{"\xE9\xA6\x96", Role::kNeck, 1.0},  // neck
    Word{"head", Role::kHead, 1.0},
    Word{"skull", Role::kHead, 1.0},
    Word{"\xE9\xA0\xAD", Role::kHead, 1.0},  // head
    Word{"rootjoint", Role::kHips, 0.3},
    Word{"\xE4\xB8\x8B\xE5\x8D\x8A\xE8\xBA\xAB", Role::kHips, 1.0},  // lower body
};

// a numbered part of a limb may be a part of it only
constexpr double kNumberedLimb = 0.5;
// words of at least this weight leave no doubt where another part may be meant
constexpr double kPlain = 0.8;

}  // namespace

std::string_view without_number(std::string_view base) {
  const std::size_t last = base.find_last_not_of("0123456789");
  return last == std::string_view::npos ? base : base.substr(0, last + 1);
}

std::vector<RoleWeight> roles_of(const JointName& name) {
  std::vector<RoleWeight> roles;
  const std::string_view plain = without_number(name.base);
  if (name.side == Side::kNone) {
    for (const Word& word : kTrunkWords) {
      if (word.text == plain) roles.push_back({word.role, word.weight});
    }
    return roles;
  }
  const double factor = plain == name.base ? 1.0 : kNumberedLimb;
  for (const Word& word : kLimbWords) {
    if (word.text == plain) roles.push_back({word.role, word.weight * factor});
  }
  return roles;
}

namespace {

Role role_of(Bone bone) {
  if (const auto part = limb_bone(bone)) {
    switch (*part) {
      case LimbBone::kUpLeg:
        return Role::kThigh;
      case LimbBone::kLeg:
        return Role::kShin;
      case LimbBone::kFoot:
      case LimbBone::kFootMod:
        return Role::kFoot;
      case LimbBone::kToe:
        return Role::kToe;
      case LimbBone::kShoulder:
        return Role::kClavicle;
      case LimbBone::kArm:
        return Role::kUpperArm;
      case LimbBone::kForeArm:
        return Role::kForearm;
      case LimbBone::kHand:
        return Role::kHand;
    }
  }
  if (bone == Bone::kHips) return Role::kHips;
  if (bone == Bone::kNeck) return Role::kNeck;
  return bone == Bone::kHead ? Role::kHead : Role::kSpine;
}

double weight_of_bone(const JointName& name, Bone bone) {
  if (name.side != side_of(bone)) return 0.0;
  double weight = 0.0;
  for (const RoleWeight& r : roles_of(name)) {
    if (r.role == role_of(bone)) weight = std::max(weight, r.weight);
  }
  return weight;
}

}  // namespace

bool may_mean(const JointName& name, Bone bone) {
  return weight_of_bone(name, bone) > 0.0;
}

bool plainly_means(const JointName& name, Bone bone) {
  return weight_of_bone(name, bone) >= kPlain;
}

bool is_limb_word(std::string_view base) {
  return std::ranges::find(kLimbWords, base, &Word::text) != kLimbWords.end();
}

bool is_animal_word(std::string_view base) {
  static constexpr std::array<std::string_view, 16> kWords = {
      "tail",     "paw",     "wing",     "hoof",    "muzzle",   "snout",    "fetlock", "tusk",
      "frontleg", "foreleg", "forelimb", "hindleg", "hindlimb", "frontpaw", "backpaw", "proboscis"};
  const std::string_view plain = without_number(base);
  return std::ranges::find(kWords, plain) != kWords.end();
}

}  // namespace retarget
