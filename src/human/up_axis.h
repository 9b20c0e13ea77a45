#pragma once

#include <optional>
#include <vector>

#include "human/calibrate.h"
#include "human/posed_body.h"
#include "retarget/options.h"

namespace retarget {

/// What is known of a file's up axis beside the movement.
struct KnownUp {
  std::optional<SignedAxis> of_kind;       ///< Of all skeletons of its kind.
  std::optional<SignedAxis> of_zero_pose;  ///< In which a well-formed zero pose stands.
};

struct UpChoice {
  SignedAxis axis;
  bool doubtful = false;  ///< The body hardly ever stands.
};

/// The up axis of a file. That of its kind counts unless the body plainly stands along another one.
/// Else the movement tells, by how trunk and legs stand and how the lowest joint wanders; where it
/// does so with little certainty, as of bodies that tumble, roll or crawl, the zero pose counts
/// more, unless the floor speaks for what was guessed. Without poses the zero pose tells, else y,
/// by custom.
[[nodiscard]] UpChoice choose_up(const Body& body, const std::vector<JointPoses>& poses,
                                 const KnownUp& known);

}  // namespace retarget
