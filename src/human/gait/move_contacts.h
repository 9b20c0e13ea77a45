#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "human/gait/contact_plan.h"
#include "human/gait/source_feet.h"
#include "human/gait/surface_contacts.h"
#include "retarget/clip.h"
#include "retarget/human.h"
#include "scene/scene_world.h"
#include "scene/terrain.h"

namespace retarget {

/// Target of the end of a limb while it is in contact.
struct ContactMove {
  int begin = 0, end = 0;  ///< Frames.
  /// World rotation of a foot, about its ankle; hands keep their orientation.
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
  /// Displacement of the ankle or wrist in frames [begin, end); world, metres.
  std::vector<Eigen::Vector3d> offsets;
};

/// Moves of both feet, both hands and the trunk; sorted by time, without overlap.
struct ContactMoves {
  std::array<std::vector<ContactMove>, 2> feet, hands;
  std::vector<ContactMove> trunk;  ///< Moves of contacts of the seat, back and knees.

  [[nodiscard]] bool empty() const;
};

/// Moves contacts of a human, and the human with them.
///
/// Each foot moves as given while it stands, and smoothly from one stance to the next in between:
/// in a swing to a higher stance it rises early, to a lower one it sinks late. The body moves by
/// the mean of the feet, or with the trunk while that rests on something, smoothed over 0.6 s. It
/// is lowered, equally smoothly, where standing legs would not reach the ground. Hands move as
/// given in contact, otherwise with the body. Two-bone inverse kinematics of legs and arms supplies
/// the differences. A clip without moves does not change.
/// @param first  earlier frames do not change.
void move_contacts(Clip& clip, int first, const Calibration& calibration,
                   const ContactMoves& moves);

/// Puts terrain under a human who walks on a flat floor: its edge is in front of the feet in the
/// first frame, and it rises in the direction of the farthest point of the path.
/// @param hips      path of the hips over the ground, by frame, metres
/// @param contacts  result of find_contacts, on the floor
/// @param terrain   rise, tread, slope, and the number of steps; 0: as many as the human climbs.
///     Its position, direction and number of steps are set.
/// @return the target positions of the feet. They land on the ground, whole feet on one step if its
///     tread is long enough, otherwise with the toes at the next riser. Empty: the human does not
///     walk.
[[nodiscard]] ContactMoves put_on_terrain(const std::vector<Eigen::Vector2d>& hips,
                                          const SourceFeet& feet, const ContactPlan& contacts,
                                          Terrain& terrain);

/// Displacements of contacts if the scene around a human changes: a foot, hand, knee, seat or back
/// keeps its position on its body. Positions on the floor move if the floor is scaled.
/// @param before, after  the scene in the frames of the human; bodies in equal order
/// @param static_scale   factors of static bodies about the origin
/// @param object_scale   factor of the sizes of moving bodies
[[nodiscard]] ContactMoves moves_with_scene(const SceneWorld& before, const SceneClip& after,
                                            const Eigen::Vector3d& static_scale,
                                            double object_scale, const SourceFeet& feet,
                                            const ContactPlan& contacts,
                                            const std::vector<SurfacePhase>& phases);

}  // namespace retarget
