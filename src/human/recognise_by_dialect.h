#pragma once

#include <vector>

#include "human/candidate.h"
#include "human/dialect.h"

namespace retarget {

/// A dialect that fits, and the map by its names.
struct DialectMatch {
  const Dialect* dialect = nullptr;
  BoneMap map;
  double score = 0.0;    ///< 0..1; see match_dialects.
  int hints = 0;         ///< Marks and directions that were asked for and found.
  double overlap = 0.0;  ///< Jaccard index of all names, fingers and ends included.
};

/// All dialects that fit well enough to be believed (score >= 0.9), best first.
///
/// The score is the Jaccard index of the names that lie in the body (mapped joints and those
/// between them) times the share of mapped bones that hang from the bone they should hang from.
/// Where none fits so, unknown joints that share a place with the one above or below them do not
/// count. Required names, marks, parents and directions must hold or the dialect does not fit at
/// all.
[[nodiscard]] std::vector<DialectMatch> match_dialects(const BodySource& source,
                                                       const std::vector<Dialect>& dialects);

/// The map of the one dialect that fits; of several that map alike, the one with most in common.
/// Nothing if none fits, or if those that fit best disagree.
[[nodiscard]] std::optional<BoneMap> recognise_by_dialect(const BodySource& source,
                                                          const std::vector<Dialect>& dialects);

}  // namespace retarget
