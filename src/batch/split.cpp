#include "batch/split.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <numeric>
#include <regex>
#include <set>
#include <tuple>
#include <utility>

#include "batch/duplicates.h"
#include "batch/find_inputs.h"
#include "batch/motion_signature.h"
#include "retarget/hash.h"
#include "retarget/option_name.h"
#include "retarget/text.h"
#include "retarget/try.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;

// Removes leading zeros, since 07 and 7 are the same subject.
std::string without_zeros(const std::string& digits) {
  const std::size_t first = digits.find_first_not_of('0');
  return first == std::string::npos ? "0" : digits.substr(first);
}

// Removes the suffix of a mirror image.
std::string without_mirror_mark(const std::string& stem) {
  static const std::regex kMark("^(.+)_(mirrored|mirror|flipped)$", std::regex::icase);
  std::smatch match;
  return std::regex_match(stem, match, kMark) ? match[1].str() : stem;
}

// Matches `walk1_subject5`, `sub3_largebox_003`, `Subject_11_F_10`.
std::string subject_word(const std::string& stem) {
  static const std::regex kWord(
      "(?:^|[^a-z])(?:subject|subj|sub|actor|performer|person)[ _-]?([0-9]+)(?![0-9])",
      std::regex::icase);
  std::smatch match;
  return std::regex_search(stem, match, kWord) ? "subject " + without_zeros(match[1].str())
                                               : std::string();
}

// Matches `07_01`, `cmu_07_01_walk`: the subject's number, then the trial's.
std::string cmu_subject(const std::string& stem) {
  static const std::regex kTrial("^(?:cmu_(?:[a-z0-9]+_)?)?([0-9]{1,3})_([0-9]{2})(?:[_ .-].*)?$",
                                 std::regex::icase);
  std::smatch match;
  return std::regex_match(stem, match, kTrial) ? "subject " + without_zeros(match[1].str())
                                               : std::string();
}

// A folder belongs to a subject if its name looks like one, also with folders below it, or if its
// files are named as in AMASS. Names with a word, `s1`, precede mere numbers, `KIT/3`.
std::string subject_folder(const fs::path& folder, const std::string& stem) {
  static const std::regex kAmass(".*_(poses|stageii|stagei)$", std::regex::icase);
  static const std::regex kPerson("(s|p|subject|subj|sub|actor|person)[ _-]?[0-9]{1,3}",
                                  std::regex::icase);
  static const std::regex kNumbered("[ _-]?[0-9]{1,3}");
  static const std::regex kSex("((?:fe)?male[ _-]?[0-9]+).*", std::regex::icase);
  std::string numbered;  // The topmost one: those below it may number takes.
  for (fs::path at = folder; at.has_filename(); at = at.parent_path()) {
    const std::string name = at.filename().generic_string();
    std::smatch match;
    if (std::regex_match(name, match, kSex)) {
      return (at.parent_path() / lower_case(match[1].str())).generic_string();
    }
    if (std::regex_match(name, kPerson)) return at.generic_string();
    if (std::regex_match(name, kNumbered)) numbered = at.generic_string();
  }
  if (!numbered.empty()) return numbered;
  return std::regex_match(stem, kAmass) ? folder.generic_string() : std::string();
}

fs::path input_path(const ManifestEntry& clip) {
  return fs::path(clip.input.file).lexically_normal();
}

// The folder above all input files.
fs::path common_folder(const std::vector<const ManifestEntry*>& clips) {
  fs::path common;
  for (const ManifestEntry* clip : clips) {
    const fs::path folder = input_path(*clip).parent_path();
    if (clip == clips.front()) common = folder;
    fs::path shared;
    for (auto a = common.begin(), b = folder.begin();
         a != common.end() && b != folder.end() && *a == *b; ++a, ++b) {
      shared /= *a;
    }
    common = std::move(shared);
  }
  return common;
}

// The group of a clip by its name below the given folder. Without a person in it, the folders of
// the file decide, because a list or a named folder leaves them out of the name. A folder above all
// files identifies no person.
ClipGroup group_of_clip(const ManifestEntry& clip, const fs::path& common) {
  ClipGroup group = group_of(clip.variant.source.empty() ? clip.relative : clip.variant.source);
  if (group.is_subject) return group;
  ClipGroup by_folder = group_of(input_path(clip).lexically_relative(common).generic_string());
  return by_folder.is_subject ? by_folder : group;
}

// `M000001` is the mirror image of `000001`.
std::string humanml_number(const std::string& stem) {
  static const std::regex kNumber("^M?([0-9]{6})$");
  std::smatch match;
  return std::regex_match(stem, match, kNumber) ? match[1].str() : std::string();
}

// Adds the format and an example of each kind to an error.
Failure split_failure(const std::string& problem) {
  return usage_failure(
      RETARGET_OPTION("split") " " + problem,
      RETARGET_OPTION("split") " 0.9:1 uses 90 % for training, " RETARGET_OPTION(
          "split") " 0.8,0.1,0.1:1 also splits the rest into validation and test; another seed "
          "gives another split");
}

// Parses `0.8,0.1,0.1`. Returns an empty list unless all numbers are between 0 and 1.
std::vector<double> parse_shares(std::string_view text) {
  const auto shares = numbers_from_text(text, ',');
  const auto is_share = [](double share) { return share > 0.0 && share < 1.0; };
  return shares && std::ranges::all_of(*shares, is_share) ? *shares : std::vector<double>();
}

// A group, to be ordered by its hash.
struct DrawnGroup {
  std::string hash;
  const std::string* key = nullptr;
  std::size_t size = 0;
  SplitSide side = SplitSide::kTrain;
};

// Adds groups to a set while they bring it closer to its fraction.
void fill_side(std::vector<DrawnGroup>& groups, SplitSide side, double wanted) {
  double taken = 0.0;
  for (DrawnGroup& group : groups) {
    if (group.side != SplitSide::kTrain) continue;
    const double with = taken + static_cast<double>(group.size);
    if (std::abs(with - wanted) >= std::abs(taken - wanted)) continue;
    group.side = side;
    taken = with;
  }
}

// Moves the smallest group that another set can spare to an empty set.
void spare_one_for(std::vector<DrawnGroup>& groups, SplitSide side) {
  const auto count = [&](SplitSide of) {
    return std::ranges::count(groups, of, &DrawnGroup::side);
  };
  if (count(side) > 0) return;
  DrawnGroup* smallest = nullptr;
  for (DrawnGroup& group : groups) {
    if (count(group.side) < 2) continue;
    if (smallest == nullptr || group.size < smallest->size) smallest = &group;
  }
  if (smallest != nullptr) smallest->side = side;
}

// Maximum distance in degrees between two files of one recording whose names say two persons. It is
// far below kDuplicateDistance, because a wrong pair would merge all clips of two persons
// (docs/batch.md has measurements). A copy trimmed by a few frames may be farther away.
constexpr double kTwinDistance = 0.5;
// Minimum root mean square change of a movement, degrees. Clips that move less look alike for any
// person.
constexpr double kLeastMovement = 2.0;

// Disjoint sets of group keys. The first key in sort order represents a merged group.
class KeySets {
 public:
  void add(const std::string& key, bool is_subject) {
    first_.emplace(key, key);
    if (is_subject) of_subjects_.insert(key);
  }
  [[nodiscard]] const std::string& first_of(const std::string& key) {
    std::string& parent = first_.at(key);
    if (parent != key) parent = first_of(parent);
    return parent;
  }
  void join(const std::string& a, const std::string& b) {
    std::string low = first_of(a), high = first_of(b);
    if (high < low) std::swap(low, high);
    first_.at(high) = low;
    if (of_subjects_.contains(high)) of_subjects_.insert(low);
  }
  /// Whether a and b are of two persons, so that joining them merges all clips of both.
  [[nodiscard]] bool are_two_subjects(const std::string& a, const std::string& b) {
    const std::string &first = first_of(a), &second = first_of(b);
    return first != second && of_subjects_.contains(first) && of_subjects_.contains(second);
  }

 private:
  std::map<std::string, std::string> first_;
  std::set<std::string> of_subjects_;  // First keys of sets with a person.
};

double movement(const MotionSignature& signature) {
  constexpr double kDegrees = 57.29577951308232 / 127.0;
  const auto count = static_cast<double>(signature.count());
  double sum = 0.0;
  for (std::size_t number = 0; number < kSignatureNumbers; ++number) {
    double mean = 0.0, square = 0.0;
    for (std::size_t i = number; i < signature.samples.size(); i += kSignatureNumbers) {
      const double sample = signature.samples[i];
      mean += sample / count;
      square += sample * sample / count;
    }
    sum += square - mean * mean;
  }
  return kDegrees * std::sqrt(std::max(0.0, sum) / kSignatureVectors);
}

struct Signed {
  std::string_view relative;
  const std::string* key = nullptr;
  MotionSignature signature;
};

// Merges the keys of files that show the same movement.
void join_twins(const std::vector<const ManifestEntry*>& clips,
                const std::vector<std::string>& keys, KeySets& sets) {
  std::vector<Signed> known;
  std::set<std::string_view> seen;  // Counts a clip of several robots once.
  for (std::size_t i = 0; i < clips.size(); ++i) {
    const ManifestEntry& clip = *clips[i];
    if (clip.signature.empty() || !seen.insert(clip.relative).second) continue;
    MotionSignature signature = signature_from_bytes(clip.signature);
    if (movement(signature) < kLeastMovement) continue;
    known.push_back({clip.relative, &keys[i], std::move(signature)});
  }
  // Longest first: each copy that was cut shorter is near the one before it.
  std::ranges::sort(known, [](const Signed& a, const Signed& b) {
    return std::tie(b.signature.seconds, a.relative) < std::tie(a.signature.seconds, b.relative);
  });
  std::vector<const MotionSignature*> signatures;
  signatures.reserve(known.size());
  for (const Signed& each : known) signatures.push_back(&each.signature);
  for (const double limit : {kTwinDistance, kDuplicateDistance}) {
    const auto found = find_duplicates(signatures, {}, limit, true);
    for (std::size_t i = 0; i < known.size(); ++i) {
      if (!found[i]) continue;
      const std::string &a = *known[i].key, &b = *known[found[i]->index].key;
      if (limit == kTwinDistance || !sets.are_two_subjects(a, b)) sets.join(a, b);
    }
  }
}

void join_copies(const std::vector<const ManifestEntry*>& clips,
                 const std::vector<std::string>& keys, KeySets& sets) {
  std::map<std::string_view, const std::string*> key_of_hash;
  for (std::size_t i = 0; i < clips.size(); ++i) {
    const std::string& hash = clips[i]->input.hash;
    if (hash.empty()) continue;
    const auto [known, is_new] = key_of_hash.emplace(hash, &keys[i]);
    if (!is_new) sets.join(*known->second, keys[i]);
  }
}

}  // namespace

Result<Split> parse_split(const std::string& text) {
  const std::size_t colon = text.find(':');
  const std::vector<double> shares = parse_shares(std::string_view(text).substr(0, colon));
  if (shares.empty() || shares.size() > 3) {
    return split_failure(
        "must be RATIO:SEED with a ratio between 0 and 1, or three shares for training, validation "
        "and test, found \"" +
        text + "\"");
  }
  Split split{shares.front(), colon == std::string::npos ? std::string() : text.substr(colon + 1)};
  if (shares.size() == 1) return split;
  const double sum = std::accumulate(shares.begin(), shares.end(), 0.0);
  constexpr double kRounding = 1e-9;
  if (std::abs(sum - 1.0) > kRounding) {
    return split_failure(
        fmt::format("\"{}\": the shares add up to {}, not to 1", text, number_text(sum, 6)));
  }
  if (shares.size() == 3) split.test = shares.back();
  return split;
}

ClipGroup group_of(const std::string& source) {
  const fs::path path(output_stem(source));
  const std::string stem = without_mirror_mark(path.filename().generic_string());
  if (std::string subject = subject_word(stem); !subject.empty()) return {subject, true};
  if (std::string number = humanml_number(stem); !number.empty()) {
    return {(path.parent_path() / number).generic_string(), false};
  }
  if (std::string subject = cmu_subject(stem); !subject.empty()) return {subject, true};
  if (std::string folder = subject_folder(path.parent_path(), stem); !folder.empty()) {
    return {folder, true};
  }
  return {(path.parent_path() / stem).generic_string(), false};
}

Result<std::vector<SplitSide>> split_clips(const std::vector<std::string>& groups,
                                           const Split& split) {
  std::map<std::string, std::size_t> sizes;
  for (const std::string& key : groups) ++sizes[key];
  std::vector<DrawnGroup> drawn;
  for (const auto& [key, size] : sizes) {
    RETARGET_TRY_ASSIGN(std::string hash, hash_bytes(split.seed + '\n' + key));
    drawn.push_back({std::move(hash), &key, size});
  }
  std::ranges::sort(drawn, {}, &DrawnGroup::hash);
  const auto count = static_cast<double>(groups.size());
  fill_side(drawn, SplitSide::kValidation, (1.0 - split.ratio - split.test) * count);
  if (split.test > 0.0) fill_side(drawn, SplitSide::kTest, split.test * count);
  for (const SplitSide side : {SplitSide::kTrain, SplitSide::kValidation, SplitSide::kTest}) {
    if (side != SplitSide::kTest || split.test > 0.0) spare_one_for(drawn, side);
  }
  std::map<std::string_view, SplitSide> sides;
  for (const DrawnGroup& group : drawn) sides[*group.key] = group.side;
  std::vector<SplitSide> result;
  result.reserve(groups.size());
  for (const std::string& key : groups) result.push_back(sides[key]);
  return result;
}

SplitGroups split_groups(const std::vector<const ManifestEntry*>& clips) {
  SplitGroups groups;
  KeySets sets;
  std::map<std::string, bool> names;  // By key: whether the name identifies a person.
  const fs::path common = common_folder(clips);
  for (const ManifestEntry* clip : clips) {
    ClipGroup group = group_of_clip(*clip, common);
    names.emplace(group.key, group.is_subject);
    sets.add(group.key, group.is_subject);
    groups.keys.push_back(std::move(group.key));
  }
  join_copies(clips, groups.keys, sets);
  join_twins(clips, groups.keys, sets);
  std::map<std::string, bool> joined;
  for (const auto& [key, is_subject] : names) joined[sets.first_of(key)] |= is_subject;
  groups.by_subject = static_cast<std::size_t>(
      std::ranges::count_if(joined, [](const auto& group) { return group.second; }));
  groups.by_file = joined.size() - groups.by_subject;
  groups.joined = names.size() - joined.size();
  for (std::string& key : groups.keys) key = std::string(sets.first_of(key));
  return groups;
}

}  // namespace retarget
