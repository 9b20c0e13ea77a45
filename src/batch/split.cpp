#include "batch/split.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <regex>
#include <utility>

#include "base/lower_case.h"
#include "base/number_text.h"
#include "base/option_name.h"
#include "base/try.h"
#include "batch/find_inputs.h"
#include "provenance/hash.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;

// 07 and 7 are one
std::string without_zeros(const std::string& digits) {
  const std::size_t first = digits.find_first_not_of('0');
  return first == std::string::npos ? "0" : digits.substr(first);
}

// what is added to the name of a mirror image
std::string without_mirror_mark(const std::string& stem) {
  static const std::regex kMark("^(.+)_(mirrored|mirror|flipped)$", std::regex::icase);
  std::smatch match;
  return std::regex_match(stem, match, kMark) ? match[1].str() : stem;
}

// `walk1_subject5`, `sub3_largebox_003`, `Subject_11_F_10`
std::string subject_word(const std::string& stem) {
  static const std::regex kWord(
      "(?:^|[^a-z])(?:subject|subj|sub|actor|performer|person)[ _-]?([0-9]+)(?![0-9])",
      std::regex::icase);
  std::smatch match;
  return std::regex_search(stem, match, kWord) ? "subject " + without_zeros(match[1].str())
                                               : std::string();
}

// `07_01`, `cmu_07_01_walk`: the subject's number, then the trial's
std::string cmu_subject(const std::string& stem) {
  static const std::regex kTrial("^(?:cmu_(?:[a-z0-9]+_)?)?([0-9]{1,3})_([0-9]{2})(?:[_ .-].*)?$",
                                 std::regex::icase);
  std::smatch match;
  return std::regex_match(stem, match, kTrial) ? "subject " + without_zeros(match[1].str())
                                               : std::string();
}

// a folder is a subject's where files are called as in AMASS, or it is called like one: `KIT/3`, `s1`
std::string subject_folder(const fs::path& folder, const std::string& stem) {
  static const std::regex kAmass(".*_(poses|stageii|stagei)$", std::regex::icase);
  static const std::regex kPerson("(s|p|subject|subj|sub|actor|person)?[ _-]?[0-9]{1,3}",
                                  std::regex::icase);
  static const std::regex kSex("((?:fe)?male[ _-]?[0-9]+).*", std::regex::icase);
  const std::string name = folder.filename().string();
  std::smatch match;
  if (std::regex_match(name, match, kSex)) {
    return (folder.parent_path() / lower_case(match[1].str())).generic_string();
  }
  const bool is_subject =
      !name.empty() && (std::regex_match(stem, kAmass) || std::regex_match(name, kPerson));
  return is_subject ? folder.generic_string() : std::string();
}

// `M000001` is the mirror image of `000001`
std::string humanml_number(const std::string& stem) {
  static const std::regex kNumber("^M?([0-9]{6})$");
  std::smatch match;
  return std::regex_match(stem, match, kNumber) ? match[1].str() : std::string();
}

}  // namespace

Result<Split> parse_split(const std::string& text) {
  const std::size_t colon = text.find(':');
  const auto ratio = parse_number<double>(std::string_view(text).substr(0, colon));
  if (ratio && *ratio > 0.0 && *ratio < 1.0) {
    return Split{*ratio, colon == std::string::npos ? std::string() : text.substr(colon + 1)};
  }
  return usage_failure(
      OPTION("split") " must be RATIO:SEED with a ratio between 0 and 1, found \"" + text + "\"",
      OPTION("split") " 0.9:1 takes nine tenths for training; another seed parts them otherwise");
}

ClipGroup group_of(const std::string& source) {
  const fs::path path(output_stem(source));
  const std::string stem = without_mirror_mark(path.filename().string());
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

Result<std::vector<bool>> split_clips(const std::vector<std::string>& groups, const Split& split) {
  std::map<std::string, std::size_t> sizes;
  for (const std::string& key : groups) ++sizes[key];
  struct Drawn {
    std::string hash;
    const std::string* key = nullptr;
    std::size_t size = 0;
    bool validates = false;
  };
  std::vector<Drawn> drawn;
  for (const auto& [key, size] : sizes) {
    TRY_ASSIGN(std::string hash, hash_bytes(split.seed + '\n' + key));
    drawn.push_back({std::move(hash), &key, size, false});
  }
  std::ranges::sort(drawn, {}, &Drawn::hash);
  const double wanted = (1.0 - split.ratio) * static_cast<double>(groups.size());
  double taken = 0.0;
  for (Drawn& group : drawn) {
    const double with = taken + static_cast<double>(group.size);
    if (std::abs(with - wanted) >= std::abs(taken - wanted)) continue;
    group.validates = true;
    taken = with;
  }
  // neither side stays empty where there are two groups: the smallest goes over
  if (drawn.size() > 1) {
    const auto on_side = std::ranges::count(drawn, true, &Drawn::validates);
    if (on_side == 0 || on_side == std::ssize(drawn)) {
      Drawn& smallest = *std::ranges::min_element(drawn, {}, &Drawn::size);
      smallest.validates = !smallest.validates;
    }
  }
  std::map<std::string_view, bool> trains;
  for (const Drawn& group : drawn) trains[*group.key] = !group.validates;
  std::vector<bool> result;
  result.reserve(groups.size());
  for (const std::string& key : groups) result.push_back(trains[key]);
  return result;
}

}  // namespace retarget
