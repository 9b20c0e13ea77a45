#include "retarget/text.h"

#include <algorithm>
#include <cctype>
#include <utility>
#include <vector>

namespace retarget {
namespace {

// Costs count half steps, so that a wrong case can cost less than a wrong letter.
constexpr int kLetterCost = 2;
// Longer names are not typing errors, and comparing them takes quadratic time.
constexpr std::size_t kMaxNameLength = 100;

int substitution_cost(char a, char b) {
  if (a == b) return 0;
  const auto lower = [](char c) { return std::tolower(static_cast<unsigned char>(c)); };
  return lower(a) == lower(b) ? kLetterCost / 2 : kLetterCost;
}

// The edit distance, or any number of at least `max` if it is at least `max`.
int edit_distance(std::string_view a, std::string_view b, int max) {
  const std::size_t width = b.size() + 1;
  std::vector<int> before(width), last(width), row(width);
  for (std::size_t j = 0; j < width; ++j) last[j] = kLetterCost * static_cast<int>(j);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = kLetterCost * static_cast<int>(i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({last[j] + kLetterCost, row[j - 1] + kLetterCost,
                         last[j - 1] + substitution_cost(a[i - 1], b[j - 1])});
      const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped) row[j] = std::min(row[j], before[j - 2] + kLetterCost);
    }
    // The distance cannot fall below the minimum of two consecutive rows.
    if (*std::ranges::min_element(row) >= max && *std::ranges::min_element(last) >= max) {
      return max;
    }
    std::swap(before, last);
    std::swap(last, row);
  }
  return last[b.size()];
}

}  // namespace

std::string nearest_name(std::string_view name, std::span<const std::string> candidates) {
  std::string nearest;
  if (name.size() > kMaxNameLength) return nearest;
  // A name with more than a third of its letters wrong is not a typing error.
  int best = kLetterCost * std::max<int>(1, static_cast<int>(name.size()) / 3) + 1;
  for (const std::string& candidate : candidates) {
    const std::size_t longer = std::max(name.size(), candidate.size());
    const std::size_t missing = longer - std::min(name.size(), candidate.size());
    if (kLetterCost * missing >= static_cast<std::size_t>(best)) continue;
    const int distance = edit_distance(name, candidate, best);
    if (distance < best) {
      best = distance;
      nearest = candidate;
    }
  }
  return nearest;
}

std::string did_you_mean(std::string_view name, std::span<const std::string> candidates) {
  const std::string nearest = nearest_name(name, candidates);
  return nearest.empty() ? std::string() : " (did you mean \"" + nearest + "\"?)";
}

std::string list_names(std::span<const std::string> names, std::size_t limit) {
  std::string text;
  const std::size_t shown = std::min(limit, names.size());
  for (std::size_t i = 0; i < shown; ++i) {
    if (i > 0) text += ", ";
    text += names[i];
  }
  if (names.size() > shown) text += " and " + std::to_string(names.size() - shown) + " more";
  return text;
}

}  // namespace retarget
