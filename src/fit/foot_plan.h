#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "fit/frame_terms.h"
#include "human/contact_plan.h"
#include "human/source_feet.h"
#include "pipeline/support_bodies.h"
#include "retarget/options.h"

namespace retarget {

/// A time in which one end of a foot, or something else that carries the robot, stays where it is.
struct PlantedPhase {
  int begin = 0, end = 0;  ///< Frames [begin, end).
  int foot = 0;            ///< Index of the robot's foot; -1: it is none.
  int foot_end = kHeelEnd;
  int support = -1;  ///< Index of the SupportBody that it is of; -1: a foot's.
};

/// What the robot's feet should do, clip-wide, and when it rests on something else.
struct FootPlan {
  int foot_count = 0, support_count = 0;
  std::vector<FootEndGoal> ends;      ///< Frame-major, two a foot.
  std::vector<double> upright;        ///< Frame-major, one a foot.
  std::vector<SupportGoal> supports;  ///< Frame-major, one a SupportBody.
  std::vector<PlantedPhase> phases;

  [[nodiscard]] std::span<const FootEndGoal> ends_of(int frame) const;
  [[nodiscard]] std::span<const double> upright_of(int frame) const;
  [[nodiscard]] std::span<const SupportGoal> supports_of(int frame) const;
  /// Makes room for the plan of so many frames.
  void reserve(int frames, std::size_t feet, std::size_t bodies);
  /// Whether anything stays where it is in a frame.
  [[nodiscard]] bool plants(int frame) const;
  /// Calls visit(index of its phase) for all that does.
  template <typename Visit>
  void for_each_planted(int frame, const Visit& visit) const {
    for (const FootEndGoal& goal : ends_of(frame)) {
      if (goal.phase >= 0) visit(goal.phase);
    }
    for (const SupportGoal& goal : supports_of(frame)) {
      if (goal.place > 0.0) visit(goal.phase);
    }
  }
};

/// What a phase holds in place: the middle of a foot's end or of a SupportBody, in the world's plane.
[[nodiscard]] Eigen::Vector2d planted_place(const FitModel& model, const PlantedPhase& phase,
                                            const TreeState& pose);

/// When feet count as in contact, as a fit's options have it.
[[nodiscard]] ContactOptions contact_options(const FitOptions& options);

/// What the robot's feet do for the source's contacts, and their clearances where there are none.
/// @param source_feet  of each foot of the robot, the source's: 0 left, 1 right.
/// @param scale        of the robot's foot paths against the source's.
/// @param plan         overwritten, with the memory that it has.
void plan_feet(const SourceFeet& source, const ContactPlan& contacts,
               std::span<const int> source_feet, double scale, FootPlan& plan);

/// Adds when the source rests on what these bodies of the robot are.
void plan_supports(const ContactPlan& contacts, std::span<const SupportBody> supports, int frames,
                   double frame_time, FootPlan& plan);

}  // namespace retarget
