#include "batch/split_groups.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string_view>
#include <utility>

#include "batch/duplicates.h"
#include "batch/motion_signature.h"
#include "batch/split.h"

namespace retarget {
namespace {

// Maximum distance in degrees between two files of one recording. It is far below
// kDuplicateDistance, because a wrong pair would merge all clips of two persons (docs/batch.md has
// measurements).
constexpr double kTwinDistance = 0.5;
// Minimum root mean square change of a movement, degrees. Clips that move less look alike for any
// person.
constexpr double kLeastMovement = 2.0;

// Disjoint sets of group keys. The first key in sort order represents a merged group.
class KeySets {
 public:
  void add(const std::string& key) { first_.emplace(key, key); }
  [[nodiscard]] const std::string& first_of(const std::string& key) {
    std::string& parent = first_.at(key);
    if (parent != key) parent = first_of(parent);
    return parent;
  }
  void join(const std::string& a, const std::string& b) {
    std::string low = first_of(a), high = first_of(b);
    if (high < low) std::swap(low, high);
    first_.at(high) = low;
  }

 private:
  std::map<std::string, std::string> first_;
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
  std::ranges::sort(known, {}, &Signed::relative);
  std::vector<const MotionSignature*> signatures;
  signatures.reserve(known.size());
  for (const Signed& each : known) signatures.push_back(&each.signature);
  const auto found = find_duplicates(signatures, {}, kTwinDistance);
  for (std::size_t i = 0; i < known.size(); ++i) {
    if (found[i]) sets.join(*known[i].key, *known[found[i]->index].key);
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

SplitGroups split_groups(const std::vector<const ManifestEntry*>& clips) {
  SplitGroups groups;
  KeySets sets;
  std::map<std::string, bool> names;  // By key: whether the name identifies a person.
  for (const ManifestEntry* clip : clips) {
    const std::string& file = clip->variant.source.empty() ? clip->relative : clip->variant.source;
    ClipGroup group = group_of(file);
    names.emplace(group.key, group.is_subject);
    sets.add(group.key);
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
