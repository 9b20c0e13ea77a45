#pragma once

#include <memory>
#include <vector>

#include "human/gait/source_feet.h"
#include "retarget/contact_plan.h"

namespace retarget {

/// Least z component of the foot's up vector (unit length) when the whole sole is down: the vector
/// is at most 41 degrees from the vertical.
inline constexpr double kSoleUp = 0.75;

/// Finds when knees, elbows, hands, seat and back rest on the floor. Such a part is as slow as a
/// foot in contact, and its joint is as low as in a body that kneels, leans, sits or lies on it.
/// @param scale     scale of lengths and speeds, as ContactPlan::scale.
/// @param contacts  overwritten; its memory is reused.
void find_body_contacts(const SourceFeet& source, const StandingHeights& standing, double scale,
                        const ContactOptions& options, BodyContacts& contacts);

/// Finds the standing heights of the feet. They are learned from slow feet near the lowest height
/// that have the pitch of a standing foot: toes of people who lie are lower than toes they stand
/// on. With too few such feet the heights are guesses: the toe height is a low percentile of the
/// lower toe, and the ankle is above it by the median over slow, low feet or by a usual rise.
/// Without toe joints: the ankle height is a low percentile of the lower ankle, and the toes are
/// the usual rise below it.
/// If another part of the body is lower than feet of these heights allow, as in a handstand, the
/// feet stand on the floor on which that part rests.
[[nodiscard]] StandingHeights find_standing_heights(const SourceFeet& source,
                                                    const ContactOptions& options = {});

/// Like find_contacts of a human. For a clip that grows, use ContactPlanner.
[[nodiscard]] ContactPlan find_contacts(const SourceFeet& source,
                                        const ContactOptions& options = {});

/// Finds the parts of a foot's phases in which its up vector is at most 41 degrees from the
/// vertical, if they last at least `shortest`. A phase that satisfies this throughout is kept
/// unchanged. The test is needed in clips without standing, such as crawling: there the heights of
/// feet that lie on the instep pass for standing heights, and feet on their edge are at similar
/// heights.
/// @param soles  overwritten; its memory is reused.
void phases_on_sole(const SourceFeet& source, int foot, const std::vector<ContactPhase>& phases,
                    double shortest, std::vector<ContactPhase>& soles);

/// The stances of a foot: frames [begin, end) in which its heel or its toe is in contact. Breaks of
/// at most 0.1 s belong to the stance.
/// @param count  number of frames of the clip
[[nodiscard]] std::vector<FrameRange> foot_stances(const ContactPlan& contacts, int foot, int count,
                                                   double frame_time);

/// Computes find_contacts() repeatedly, for example for a growing clip. Reuses its memory: nothing
/// is allocated for clips that are no longer than an earlier clip or the reserved length.
class ContactPlanner {
 public:
  ContactPlanner();
  ~ContactPlanner();
  ContactPlanner(ContactPlanner&&) noexcept;
  ContactPlanner& operator=(ContactPlanner&&) noexcept;

  /// Valid until the next call.
  [[nodiscard]] const ContactPlan& plan(const SourceFeet& source,
                                        const ContactOptions& options = {});
  void reserve(int frames);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace retarget
