#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "human/gait/contact_plan.h"
#include "human/gait/source_feet.h"
#include "retarget/options.h"
#include "solve/fit/frame_terms.h"
#include "solve/targets/support_bodies.h"

namespace retarget {

/// A phase in which one foot end, or another support body, is held at an anchor.
struct PlantedPhase {
  int begin = 0, end = 0;  ///< Frames [begin, end) with goals of this phase.
  int foot = 0;            ///< Index of the robot's foot; -1 for a SupportBody.
  int foot_end = kHeelEnd;
  int support = -1;  ///< Index of the SupportBody; -1 for a foot.
  /// Frames between `begin` and the contact, and between the contact and `end`.
  int before = 0, after = 0;

  /// The frames of the contact, [first, last).
  [[nodiscard]] int first() const { return begin + before; }
  [[nodiscard]] int last() const { return end - after; }
};

/// The goals of the robot's feet and support bodies for a whole clip.
struct FootPlan {
  int foot_count = 0, support_count = 0;
  std::vector<FootEndGoal> ends;      ///< Frame-major, two per foot.
  std::vector<double> upright;        ///< Frame-major, one per foot.
  std::vector<double> lying;          ///< Frame-major, one per foot.
  std::vector<SupportGoal> supports;  ///< Frame-major, one per SupportBody.
  std::vector<PlantedPhase> phases;

  [[nodiscard]] std::span<const FootEndGoal> ends_of(int frame) const;
  [[nodiscard]] std::span<const double> upright_of(int frame) const;
  /// Empty before plan_feet().
  [[nodiscard]] std::span<const double> lying_of(int frame) const;
  [[nodiscard]] std::span<const SupportGoal> supports_of(int frame) const;
  /// Allocates memory for a plan of `frames` frames.
  void reserve(int frames, std::size_t feet, std::size_t bodies);
  /// Whether a foot end or a support body is in contact in this frame.
  [[nodiscard]] bool plants(int frame) const;
  /// Calls visit(phase index, slide since the beginning of the contact) for each foot end and
  /// support body that is in contact in this frame.
  template <typename Visit>
  void for_each_planted(int frame, const Visit& visit) const {
    for (const FootEndGoal& goal : ends_of(frame)) {
      if (goal.phase >= 0) visit(goal.phase, Eigen::Vector2d(Eigen::Vector2d::Zero()));
    }
    for (const SupportGoal& goal : supports_of(frame)) {
      if (touches(goal, frame)) visit(goal.phase, goal.slide);
    }
  }

 private:
  [[nodiscard]] bool touches(const SupportGoal& goal, int frame) const {
    if (goal.phase < 0) return false;
    const PlantedPhase& phase = phases[static_cast<std::size_t>(goal.phase)];
    return phase.first() <= frame && frame < phase.last();
  }
};

/// Frames in which only surfaces above the floor carry the body.
struct RaisedFrames {
  int count = 0;
  double highest = 0.0;  ///< Height of the highest of these surfaces, metres.
};

[[nodiscard]] RaisedFrames raised_frames(const FootPlan& plan, int frames);

/// The point that a phase holds in place: the middle of a foot end or of a SupportBody, world x and
/// y, metres.
[[nodiscard]] Eigen::Vector2d planted_place(const FitModel& model, const PlantedPhase& phase,
                                            const TreeState& pose);

/// The thresholds of contact detection in a fit's options.
[[nodiscard]] ContactOptions contact_options(const FitOptions& options);

/// Plans the goals of the robot's feet: contacts in the contact phases of the source, clearances
/// otherwise.
/// @param source_feet  source foot of each robot foot: 0 left, 1 right.
/// @param scale        scale from the source's to the robot's foot paths.
/// @param ground       ground_under_feet(), or empty: the floor is the only known surface.
/// @param plan         overwritten; its memory is reused.
void plan_feet(const SourceFeet& source, const ContactPlan& contacts, const ContactOptions& options,
               std::span<const int> source_feet, double scale, std::span<const double> ground,
               FootPlan& plan);

/// Adds the phases in which the source rests on the body parts of these support bodies. Call it
/// after plan_feet().
/// @param scale  scale from the source's to the robot's foot paths.
void plan_supports(const SourceFeet& source, const ContactPlan& contacts,
                   std::span<const SupportBody> supports, int frames, double scale, FootPlan& plan);

/// Adapts the holds of foot ends to frames shorter than 1/30 s; see docs/fit.md. Call it after
/// plan_supports().
/// @param source_feet, scale  see plan_feet().
/// @param scene  may be null.
void ease_contacts(const SourceFeet& source, std::span<const int> source_feet, double scale,
                   const FitScene* scene, FootPlan& plan);

}  // namespace retarget
