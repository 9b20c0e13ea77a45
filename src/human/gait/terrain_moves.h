#pragma once

#include <Eigen/Core>
#include <vector>

#include "human/gait/contact_plan.h"
#include "human/gait/move_contacts.h"
#include "human/gait/source_feet.h"
#include "human/gait/surface_contacts.h"
#include "scene/scene_world.h"
#include "scene/terrain.h"

namespace retarget {

/// Puts terrain under a human who walks on a flat floor: its edge is in front of the feet in the
/// first frame, and it rises in the direction of the farthest point of the path.
/// @param hips      path of the hips over the ground, by frame, metres
/// @param contacts  of find_contacts, on the floor
/// @param terrain   rise, tread, slope, and the number of steps; 0: as many as the human climbs.
///     Its position, direction and number of steps are set.
/// @return where the feet move to. They land on the ground, whole feet on one step if its tread is
///     long enough, otherwise with the toes at the next riser. Empty: the human does not walk.
[[nodiscard]] ContactMoves put_on_terrain(const std::vector<Eigen::Vector2d>& hips,
                                          const SourceFeet& feet, const ContactPlan& contacts,
                                          Terrain& terrain);

/// Displacements of contacts if the scene around a human changes: a foot, hand, knee, seat or back
/// stays at its position on its body. Positions on the floor move if the floor is scaled.
/// @param before, after  the scene in the frames of the human; bodies in equal order
/// @param static_scale   factors of static bodies about the origin
/// @param object_scale   factor of the sizes of moving bodies
[[nodiscard]] ContactMoves moves_with_scene(const SceneWorld& before, const SceneClip& after,
                                            const Eigen::Vector3d& static_scale,
                                            double object_scale, const SourceFeet& feet,
                                            const ContactPlan& contacts,
                                            const std::vector<SurfacePhase>& phases);

}  // namespace retarget
