#pragma once

#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "human/gait/contact_plan.h"
#include "human/gait/source_feet.h"
#include "retarget/contact_edits.h"

namespace retarget {

/// A part of a human whose contacts can be edited.
struct ContactPart {
  std::string_view name;
  int foot = -1;            ///< 0 left, 1 right; -1: another part.
  int end = -1;             ///< kHeelEnd, kToeEnd; -1: both.
  std::size_t support = 0;  ///< Index into kSupportBones, for parts that are not feet.
};

/// Applies edits to the contacts of a human, in order. Frames that no edit names keep their
/// contacts. An edited foot is in contact as a whole where its heel and toe are on one surface. An
/// added contact is level: the foot rests on its sole.
/// @param source  the feet in which `contacts` were found.
/// @return edits without effect: the body has no such part, or nothing is there to remove or shift;
///     as indices into `edits`.
std::vector<std::size_t> edit_contacts(std::span<const ContactEdit> edits, const SourceFeet& source,
                                       ContactPlan& contacts);

}  // namespace retarget
