#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "human/gait/source_feet.h"
#include "retarget/contact_plan.h"
#include "retarget/human.h"
#include "retarget/solved_scene.h"
#include "scene/scene_world.h"

namespace retarget {

static_assert(kSupportNames.size() == kSupportBones.size());

/// Points of the human that may touch the surfaces of a scene, besides the feet: the joints of
/// kSupportBones, and the palms and finger tips.
class SurfaceParts {
 public:
  SurfaceParts() = default;
  /// @param human  @param scale  leg length / kUsualSourceLeg.
  SurfaceParts(const HumanClipInfo& human, double scale);

  void add(const HumanPose& pose);

  [[nodiscard]] int frame_count() const;
  [[nodiscard]] bool has(std::size_t part) const { return has_[part]; }
  [[nodiscard]] double scale() const { return scale_; }
  /// World position of a part's joint, metres.
  [[nodiscard]] const Eigen::Vector3d& joint(int frame, std::size_t part) const {
    return positions_[static_cast<std::size_t>(frame) * per_frame_ + first_[part]];
  }
  /// The distance between the part's surface and a body: negative where it overlaps.
  struct Nearest {
    double distance = 0.0;
    Eigen::Vector3d on_surface = Eigen::Vector3d::Zero();  ///< World, metres.
  };
  [[nodiscard]] Nearest nearest(const SceneWorld& world, int frame, std::size_t part,
                                std::size_t body) const;

 private:
  struct Point {
    Bone bone;
    double along = 0.0;   ///< Along the bone's x axis, metres.
    double radius = 0.0;  ///< Metres.
  };
  std::array<std::vector<Point>, kSupportBones.size()> points_;
  std::array<bool, kSupportBones.size()> has_{};
  double scale_ = 1.0;
  std::size_t per_frame_ = 0;
  std::vector<Eigen::Vector3d> positions_;  // Frame-major, in the order of points_.
  std::array<std::size_t, kSupportBones.size()> first_{};
};

/// A contact of a part with a body of a scene.
struct SurfacePhase {
  std::size_t part = 0;  ///< Index into kSupportBones.
  std::size_t body = 0;
  int begin = 0, end = 0;
  bool slides = false;  ///< Whether it moves over the surface by more than the size of a hand.
  /// The nearest point of the surface in frames [begin, end), in the frame of the scene's body;
  /// metres. It is constant unless the contact slides.
  std::vector<Eigen::Vector3d> places;
};

/// Finds when parts touch the bodies of a scene for at least ContactOptions::shortest: they are
/// near, and slow relative to the body, or rest on it as on a floor.
/// @param contacts  result of find_contacts_on_ground.
[[nodiscard]] std::vector<SurfacePhase> find_surface_contacts(const SceneWorld& world,
                                                              const SurfaceParts& parts,
                                                              const ContactPlan& contacts,
                                                              const ContactOptions& options,
                                                              double frame_time);

/// Runs find_contacts() in a scene: feet stand, and other parts rest, on the ground under them. A
/// foot on a step stands like one on the floor, and its phases have the height of the step.
/// Contacts of other parts with raised ground are in ContactPlan::bodies_above_floor.
[[nodiscard]] ContactPlan find_contacts_on_ground(const SceneWorld& world, const SourceFeet& feet,
                                                  const ContactOptions& options = {});

/// The fixed body whose surface is nearest to a place on the ground; -1: the floor, or something
/// that the scene does not have.
/// @param scale  leg length / kUsualSourceLeg.
[[nodiscard]] int body_under(const SceneWorld& world, int frame, const Eigen::Vector3d& place,
                             double scale);

/// Heights of the ground under the ends of feet, metres; 0: the floor, or an end inside a body.
/// Frame-major, then by foot, then kHeelEnd and kToeEnd.
[[nodiscard]] std::vector<double> ground_under_feet(const SceneWorld& world,
                                                    const SourceFeet& feet);

/// Sets the contacts of a solved scene: `contacts`, `on_floor` and `under_feet`.
/// @param contacts  result of find_contacts_on_ground.
/// @param phases    result of find_surface_contacts.
void set_contacts(const SceneWorld& world, const SourceFeet& feet, const ContactPlan& contacts,
                  std::span<const SurfacePhase> phases, SolvedScene& solved);

}  // namespace retarget
