#include <vector>

#include "retarget/clip.h"
#include "retarget/skeleton_points.h"
#include "retarget/try.h"
#include "retarget/version.h"
#include "retarget/view.h"
#include "view/page_data.h"

namespace retarget {
namespace {

using Eigen::Vector3d;
using Json = nlohmann::ordered_json;

constexpr double kStep = 1e-4;          // Metres; the error is half a step.
constexpr double kUnknownHeight = 1.7;  // Metres; assumed if the unit is unknown.

// Positions of joints and end sites, at rest or in a frame.
class SkeletonPlacer {
 public:
  explicit SkeletonPlacer(const SkeletonPage& page)
      : clip_(*page.clip), points_(skeleton_points(clip_.skeleton())) {
    if (page.calibration != nullptr) {
      world_from_file_ = page.calibration->human_from_source * page.calibration->metres_per_unit;
      return;
    }
    const Vector3d size = extents(clip_.empty_like(clip_.rate(), 0)).sizes();
    // Assume Y up, as in most files, unless the body is longest along z.
    if (size.z() <= size.y()) world_from_file_ << 0, 0, 1, 1, 0, 0, 0, 1, 0;
    const double longest = size.maxCoeff();
    if (longest > 0.0) world_from_file_ *= kUnknownHeight / longest;
  }

  [[nodiscard]] const std::vector<SkeletonPoint>& points() const { return points_; }
  [[nodiscard]] const Eigen::Matrix3d& world_from_file() const { return world_from_file_; }

  void append_frame(int frame, std::vector<double>& places) const {
    std::vector<Pose> world_from_joint(clip_.skeleton().joints().size());
    forward_kinematics(clip_, frame, world_from_joint);
    append(world_from_joint, places);
  }
  [[nodiscard]] std::vector<double> at_rest() const {
    std::vector<Pose> world_from_joint;
    for (const Joint& joint : clip_.skeleton().joints()) {
      const Pose parent_from_joint{Eigen::Quaterniond::Identity(), joint.offset};
      world_from_joint.push_back(joint.parent < 0
                                     ? parent_from_joint
                                     : world_from_joint[static_cast<std::size_t>(joint.parent)] *
                                           parent_from_joint);
    }
    std::vector<double> places;
    append(world_from_joint, places);
    return places;
  }

 private:
  void append(const std::vector<Pose>& world_from_joint, std::vector<double>& places) const {
    for (const SkeletonPoint& point : points_) {
      const Vector3d place =
          world_from_file_ * world_from_point(point, world_from_joint).translation;
      places.insert(places.end(), place.begin(), place.end());
    }
  }

  const Clip& clip_;
  const std::vector<SkeletonPoint> points_;
  Eigen::Matrix3d world_from_file_ = Eigen::Matrix3d::Identity();
};

// Returns the joints and end sites with their parent, bone and side.
Json points_json(const SkeletonPage& page, const std::vector<SkeletonPoint>& points) {
  const Skeleton& skeleton = page.clip->skeleton();
  std::vector<int> point_of_joint(skeleton.joints().size(), -1);
  Json json = Json::array();
  std::vector<std::string> sides(skeleton.joints().size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto joint = static_cast<std::size_t>(points[i].joint);
    const bool is_end = point_of_joint[joint] >= 0;
    Json point = {{"name", points[i].name}};
    if (is_end) {
      point["parent"] = point_of_joint[joint];
      point["side"] = sides[joint];
      json.push_back(std::move(point));
      continue;
    }
    point_of_joint[joint] = static_cast<int>(i);
    const int parent = skeleton.joint(points[i].joint).parent;
    point["parent"] = parent < 0 ? -1 : point_of_joint[static_cast<std::size_t>(parent)];
    for (const Bone bone : kMappedBones) {
      if (page.calibration == nullptr ||
          page.calibration->bones[bone].position_joint != points[i].joint)
        continue;
      point["bone"] = bone_name(bone);
      sides[joint] = side_name(side_of(bone));
    }
    point["side"] = sides[joint];
    json.push_back(std::move(point));
  }
  return json;
}

Json axes_json(const Eigen::Matrix3d& world_from_file) {
  Json json = Json::array();
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3d direction = world_from_file.col(axis).normalized();
    json.push_back(Json::array({direction.x(), direction.y(), direction.z()}));
  }
  return json;
}

}  // namespace

Result<std::string> skeleton_page(const SkeletonPage& page) {
  const Clip& clip = *page.clip;
  const SkeletonPlacer placer(page);
  std::vector<double> places;
  for (int frame = 0; frame < clip.frame_count(); ++frame) placer.append_frame(frame, places);
  const std::vector<double> rest = placer.at_rest();
  TrackPacker packer;
  const auto channels = static_cast<int>(3 * placer.points().size());
  RETARGET_TRY_ASSIGN(const int rest_track, packer.add(channels, kStep, rest));
  Json skeleton = {{"points", points_json(page, placer.points())},
                   {"frames", clip.frame_count()},
                   {"rate", {clip.rate().frames, clip.rate().seconds}},
                   {"rest", rest_track},
                   {"axes", axes_json(placer.world_from_file())},
                   {"understood", page.calibration != nullptr},
                   {"facts", page.facts},
                   {"doubts", page.doubts}};
  if (clip.frame_count() > 0) {
    RETARGET_TRY_ASSIGN(const int track, packer.add(channels, kStep, places));
    skeleton["track"] = track;
  }
  if (page.calibration != nullptr) {
    skeleton["unit"] = page.calibration->unit;
    skeleton["up"] = to_text(page.calibration->up);
    skeleton["forward"] = to_text(page.calibration->forward);
    skeleton["height"] = page.calibration->height;
  }
  const Json header = {{"title", page.title},
                       {"tool", "retarget " + version_number()},
                       {"precision", {{"bone_m", 0.5 * kStep}}},
                       {"figure", page_figure()},
                       {"skeleton", std::move(skeleton)},
                       {"tracks", tracks_json(packer)}};
  RETARGET_TRY_ASSIGN(PageData data, packed_page(header, packer));
  return assemble_page(page.title, std::move(data));
}

}  // namespace retarget
