#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "retarget/error.h"
#include "retarget/export.h"

namespace RETARGET_API retarget {

/// The effect of an edit on the contacts of a part of the human.
enum class ContactAction : unsigned char {
  kAdd,     ///< The part is in contact from start to end.
  kRemove,  ///< The part is not in contact from start to end.
  kShift,   ///< The contacts that touch start to end move by `by`.
};

/// A change to the detected contacts of a clip (docs/fit.md, "Editing contacts"). Times are
/// seconds from the first frame of the motion.
struct ContactEdit {
  /// `left_foot`, `left_heel`, `left_toe`, `left_knee`, `left_elbow`, `left_hand`, the same for
  /// right, `seat`, `back`. A foot means its heel and toe.
  std::string part;
  ContactAction action = ContactAction::kAdd;
  double start = 0.0, end = 0.0;  ///< Seconds.
  double by = 0.0;                ///< kShift: seconds; positive: later.
  /// kAdd: height of the surface above the floor, metres at the human's scale.
  double height = 0.0;
};

/// Names of the parts, in the order of documentation.
[[nodiscard]] std::vector<std::string> contact_part_names();

/// Reads edits from JSON: `{"contacts": [{"part": "left_foot", "start": 1.2, "end": 1.8, "action":
/// "add"}, ...]}`. `by` is required for `shift` and an error otherwise, `height` is optional for
/// `add`. Errors (kConfig), all at once: unknown parts and actions, with the nearest name; missing
/// or invalid times.
/// @param file  file name for messages.
[[nodiscard]] Result<std::vector<ContactEdit>> parse_contact_edits(std::string_view text,
                                                                   const std::string& file);
[[nodiscard]] Result<std::vector<ContactEdit>> load_contact_edits(const std::string& file);

/// Checks that all edits are within a motion. Errors (kConfig): all edits outside it, and shifts
/// that leave it.
/// @param seconds  length of the motion.
/// @param file     file name for messages.
[[nodiscard]] Result<void> check_contact_edits(std::span<const ContactEdit> edits, double seconds,
                                               const std::string& file);

}  // namespace retarget
