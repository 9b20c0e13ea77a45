#include "human/skeleton/joint_names.h"

#include <algorithm>
#include <array>
#include <map>
#include <optional>

#include "retarget/text.h"

namespace retarget {
namespace {

using Words = std::vector<std::string>;

// Independent of the locale.
bool is_upper(char c) {
  return c >= 'A' && c <= 'Z';
}
bool is_digit(char c) {
  return c >= '0' && c <= '9';
}
bool is_letter(char c) {
  return is_upper(c) || (c >= 'a' && c <= 'z') || static_cast<unsigned char>(c) >= 0x80;
}

std::string_view without_namespace(std::string_view name) {
  const std::size_t end = name.find_last_of(":|");
  return end == std::string_view::npos || end + 1 == name.size() ? name : name.substr(end + 1);
}

// Whether a new word begins at name[i]. `word_length` is the length of the current word.
bool begins_word(std::string_view name, std::size_t i, std::size_t word_length) {
  const char before = name[i - 1], here = name[i];
  if (is_digit(before) != is_digit(here)) {
    return is_digit(before) || word_length > 1;  // "T8" is one word: T is not a side.
  }
  if (!is_upper(here)) return false;
  const bool before_lower = !is_upper(before);
  const bool next_lower = i + 1 < name.size() && name[i + 1] >= 'a' && name[i + 1] <= 'z';
  return before_lower || next_lower;
}

Words words_of(std::string_view name) {
  // Japanese side marks have no separator.
  static constexpr std::array<std::pair<std::string_view, std::string_view>, 2> kSideSigns = {
      {{"\xE5\xB7\xA6", "left"}, {"\xE5\x8F\xB3", "right"}}};
  Words words;
  std::string word;
  const auto finish = [&] {
    if (!word.empty()) words.push_back(lower_case(word));
    word.clear();
  };
  for (std::size_t i = 0; i < name.size(); ++i) {
    const auto sign = std::ranges::find_if(
        kSideSigns, [&](const auto& s) { return name.substr(i).starts_with(s.first); });
    if (sign != kSideSigns.end()) {
      finish();
      words.emplace_back(sign->second);
      i += sign->first.size() - 1;
    } else if (!is_letter(name[i]) && !is_digit(name[i])) {
      finish();
    } else {
      if (!word.empty() && begins_word(name, i, word.size())) finish();
      word += name[i];
    }
  }
  finish();
  return words;
}

bool is_number(const std::string& word) {
  return std::ranges::all_of(word, is_digit);
}

Side side_of(const std::string& word) {
  if (word == "left" || word == "l" || word == "lft") return Side::kLeft;
  if (word == "right" || word == "r" || word == "rgt") return Side::kRight;
  return Side::kNone;
}

// The third value in skeletons that mark every joint with a side.
bool is_centre(const std::string& word) {
  return word == "c" || word == "ctr" || word == "center" || word == "centre";
}

// Removes the affixes of well-known exporters, unless nothing else would remain.
void drop_known_affixes(Words& words) {
  static const std::vector<Words> kPrefixes = {
      {"valve", "biped"}, {"cc", "base"}, {"j", "bip"}, {"mixamorig"}, {"bip"},     {"character"},
      {"armature"},       {"def"},        {"joint"},    {"jnt"},       {"skeleton"}};
  static const Words kSuffixes = {"jnt", "jt", "bind"};
  for (const Words& prefix : kPrefixes) {
    if (words.size() <= prefix.size() || !std::equal(prefix.begin(), prefix.end(), words.begin())) {
      continue;
    }
    words.erase(words.begin(), words.begin() + static_cast<std::ptrdiff_t>(prefix.size()));
    const bool numbered =
        prefix[0] == "bip" || prefix[0] == "character" || prefix[0] == "mixamorig";
    if (numbered && words.size() > 1 && is_number(words[0])) words.erase(words.begin());
  }
  if (words.size() > 1 && std::ranges::find(kSuffixes, words.back()) != kSuffixes.end()) {
    words.pop_back();
  }
}

// A word in this share of the names counts as shared by nearly all.
constexpr double kNearlyAll = 0.8;
constexpr std::size_t kMinNames = 5;

// Removes the first (or last) word that nearly all names share. Returns whether there was one.
bool drop_shared_word(std::vector<Words>& all, bool first) {
  if (all.size() < kMinNames) return false;
  std::map<std::string, std::size_t> counts;
  for (const Words& words : all) {
    if (words.size() > 1) ++counts[first ? words.front() : words.back()];
  }
  for (const auto& [word, count] : counts) {
    if (static_cast<double>(count) < kNearlyAll * static_cast<double>(all.size())) continue;
    for (Words& words : all) {
      if (words.size() < 2 || (first ? words.front() : words.back()) != word) continue;
      words.erase(first ? words.begin() : words.end() - 1);
    }
    return true;
  }
  return false;
}

std::string glued(const Words& words) {
  std::string text;
  for (const std::string& word : words) {
    const std::size_t zeros = is_number(word) ? word.find_first_not_of('0') : 0;
    text += zeros == std::string::npos ? "0" : word.substr(zeros);
  }
  return text;
}

// Splits names such as `lfemur` and `leftarm`, whose side has no separator, if a limb word follows.
JointName with_glued_side(const std::string& base) {
  static constexpr std::array<std::pair<std::string_view, Side>, 4> kSides = {
      {{"left", Side::kLeft}, {"right", Side::kRight}, {"l", Side::kLeft}, {"r", Side::kRight}}};
  for (const auto& [text, side] : kSides) {
    if (base.starts_with(text) && is_limb_word(base.substr(text.size()))) {
      return {side, base.substr(text.size())};
    }
  }
  return {Side::kNone, base};
}

JointName name_of(Words words) {
  for (std::size_t i = 0; i < words.size(); ++i) {
    const Side side = side_of(words[i]);
    if (side == Side::kNone) continue;
    words.erase(words.begin() + static_cast<std::ptrdiff_t>(i));
    return {side, glued(words)};
  }
  // Drop the centre marks of `C_Head` and `Head_C`.
  if (words.size() > 1 && is_centre(words.front())) {
    words.erase(words.begin());
  } else if (words.size() > 1 && is_centre(words.back())) {
    words.pop_back();
  }
  return with_glued_side(glued(words));
}

}  // namespace

std::vector<JointName> normalise_joint_names(const std::vector<std::string>& names) {
  std::vector<Words> all;
  all.reserve(names.size());
  for (const std::string& name : names) {
    all.push_back(words_of(without_namespace(name)));
    drop_known_affixes(all.back());
  }
  while (drop_shared_word(all, true)) {
  }
  while (drop_shared_word(all, false)) {
  }
  std::vector<JointName> result;
  result.reserve(all.size());
  for (Words& words : all) result.push_back(name_of(std::move(words)));
  return result;
}

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
    BoneWords{Bone::kLeftToe, 0.9, "footindex bigtoe"},
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
    BoneWords{Bone::kHips, 0.9, "hip midhip"}, BoneWords{Bone::kHips, 0.3, "root rootjoint"},
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
    if (take_until(words, ' ') == word) return true;
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
