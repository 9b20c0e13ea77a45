#include "view/page_data.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "retarget/contact_plan.h"
#include "retarget/human_skeleton.h"
#include "retarget/root_pose.h"
#include "retarget/trigonometry.h"
#include "retarget/try.h"
#include "retarget/version.h"
#include "view/figure.h"

namespace retarget {
namespace {

using Json = nlohmann::ordered_json;

// The error is half a step; over a chain of joints the errors sum to less than 0.2 mm.
constexpr double kAngleStep = 1e-4;                        // Radians; metres for slides.
constexpr double kBoneStep = 2.0e-4;                       // Metres.
constexpr double kErrorStepCm = 0.1, kErrorStepDeg = 0.5;  // Steps of tracking errors.
constexpr double kErrorRate = 15.0;                        // Samples per second of tracking errors.

Json phases_json(const std::vector<ContactPhase>& phases) {
  Json json = Json::array();
  for (const ContactPhase& phase : phases) json.push_back({phase.begin, phase.end});
  return json;
}

// Returns the contact phases of the robot's soles.
Json robot_contacts(const RobotClip& clip) {
  Json json = Json::array();
  for (const auto& [sole, phases] : sole_contacts(clip)) {
    json.push_back({{"side", sole->side}, {"body", sole->body}, {"phases", phases_json(phases)}});
  }
  return json;
}

Json limits_json(const Robot& robot, const LimitSet& limits) {
  Json json = Json::array();
  for (std::size_t i = 0; i < robot.joints().size(); ++i) {
    const double lower = limits.lower[i], upper = limits.upper[i];
    json.push_back(Json::array({std::isfinite(lower) ? Json(lower) : Json(),
                                std::isfinite(upper) ? Json(upper) : Json()}));
  }
  return json;
}

// Returns the index of each bone's predecessor in its chain; -1: none.
std::vector<int> chain_parents(const std::vector<std::string>& bones) {
  std::vector<int> parents(bones.size(), -1);
  for (const HumanChain& chain : human_chains()) {
    int before = -1;
    for (const std::string& bone : chain.bones) {
      const auto found = static_cast<int>(std::ranges::find(bones, bone) - bones.begin());
      if (found == static_cast<int>(bones.size())) continue;
      int& parent = parents[static_cast<std::size_t>(found)];
      if (parent < 0 && before < found) parent = before;
      before = found;
    }
  }
  return parents;
}

// Data that several motions share is written once per page.
class PageWriter {
 public:
  explicit PageWriter(const PageOptions& options) : options_(options) {}
  Result<void> add(const PageMotion& motion);
  Result<PageData> finish() const;

 private:
  Result<int> robot_of(const PageMotion& motion);
  Result<Json> meshes_of(const RobotMeshes& meshes);
  Result<int> human_of(const PageMotion& motion);
  Result<int> scene_of(const MotionScene& scene);
  Result<Json> tracks_of(const RobotClip& clip);
  Result<Json> error_tracks_of(const QualityReport& report, int stride);

  const PageOptions& options_;
  TrackPacker packer_;
  std::vector<const Robot*> known_robots_;
  std::vector<const HumanClip*> known_humans_;
  std::vector<const MotionScene*> known_scenes_;
  ScenePacker scene_packer_;
  Json robots_ = Json::array(), humans_ = Json::array(), scenes_ = Json::array();
  Json motions_ = Json::array();
};

// Meshes are stored as tracks whose frames are vertices and triangles.
Result<Json> PageWriter::meshes_of(const RobotMeshes& meshes) {
  Json json = Json::array();
  for (const auto& [body, mesh] : meshes.bodies) {
    Json packed = {{"body", body}};
    RETARGET_TRY(pack_mesh(mesh, packer_, packed));
    json.push_back(std::move(packed));
  }
  return json;
}

Result<int> PageWriter::robot_of(const PageMotion& motion) {
  const Robot* robot = &motion.clip->robot();
  const auto found = std::ranges::find(known_robots_, robot);
  const auto index = static_cast<int>(found - known_robots_.begin());
  if (found != known_robots_.end()) return index;
  known_robots_.push_back(robot);
  Json json = page_robot(*robot);
  if (motion.meshes != nullptr && !motion.meshes->bodies.empty()) {
    RETARGET_TRY_ASSIGN(json["meshes"], meshes_of(*motion.meshes));
  }
  robots_.push_back(std::move(json));
  return index;
}

Result<int> PageWriter::human_of(const PageMotion& motion) {
  const HumanClip& human = *motion.human;
  const auto found = std::ranges::find(known_humans_, &human);
  const auto index = static_cast<int>(found - known_humans_.begin());
  if (found != known_humans_.end()) return index;
  known_humans_.push_back(&human);
  std::vector<Bone> bones;
  std::vector<std::string> names;
  for (const Bone bone : kMappedBones) {
    if (!human.has(bone)) continue;
    bones.push_back(bone);
    names.emplace_back(bone_name(bone));
  }
  // Round first, then store positions relative to the previous bone: smaller numbers, same error.
  const std::vector<int> parents = chain_parents(names);
  std::vector<double> positions;
  positions.reserve(bones.size() * 3 * static_cast<std::size_t>(human.frame_count));
  for (int frame = 0; frame < human.frame_count; ++frame) {
    const auto rounded = [&](Bone bone) -> Eigen::Vector3d {
      return (human.frame(frame)[bone].translation / kBoneStep).array().round() * kBoneStep;
    };
    for (std::size_t i = 0; i < bones.size(); ++i) {
      Eigen::Vector3d place = rounded(bones[i]);
      if (parents[i] >= 0) place -= rounded(bones[static_cast<std::size_t>(parents[i])]);
      positions.insert(positions.end(), place.begin(), place.end());
    }
  }
  RETARGET_TRY_ASSIGN(const int track,
                      packer_.add(static_cast<int>(3 * bones.size()), kBoneStep, positions));
  humans_.push_back({{"bones", names},
                     {"parents", parents},
                     {"frames", human.frame_count},
                     {"height", human.height},
                     {"track", track}});
  return index;
}

Result<int> PageWriter::scene_of(const MotionScene& scene) {
  const auto found = std::ranges::find(known_scenes_, &scene);
  const auto index = static_cast<int>(found - known_scenes_.begin());
  if (found != known_scenes_.end()) return index;
  known_scenes_.push_back(&scene);
  RETARGET_TRY_ASSIGN(Json json, scene_packer_.pack(scene, packer_));
  scenes_.push_back(std::move(json));
  return index;
}

Result<Json> PageWriter::tracks_of(const RobotClip& clip) {
  std::vector<double> positions, rotations, joints;
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    const auto qpos = clip.qpos(frame);
    positions.insert(positions.end(), qpos.begin(), qpos.begin() + 3);
    const Eigen::Quaterniond rotation = root_rotation(qpos).normalized();
    rotations.insert(rotations.end(), {rotation.w(), rotation.x(), rotation.y(), rotation.z()});
    for (const RobotJoint& joint : clip.robot().joints())
      joints.push_back(qpos[joint.qpos_address]);
  }
  RETARGET_TRY_ASSIGN(const int position, packer_.add(3, kPageRootStep, positions));
  RETARGET_TRY_ASSIGN(const int rotation, packer_.add(4, kPageQuaternionStep, rotations));
  const auto count = static_cast<int>(clip.robot().joints().size());
  RETARGET_TRY_ASSIGN(const int joint, packer_.add(count, kAngleStep, joints));
  return Json{{"position", position}, {"rotation", rotation}, {"joints", joint}};
}

// Returns the tracking errors over time: a track of position and rotation errors for each body that
// has any.
// @param stride  keeps every stride-th frame.
Result<Json> PageWriter::error_tracks_of(const QualityReport& report, int stride) {
  Json json = Json::array();
  for (const TrackingRow& row : report.tracking) {
    Json errors = Json::object();
    const auto add = [&](const char* key, double step,
                         const std::vector<float>& values) -> Result<void> {
      if (values.empty()) return {};
      std::vector<double> numbers;
      for (std::size_t i = 0; i < values.size(); i += static_cast<std::size_t>(stride)) {
        numbers.push_back(values[i]);
      }
      RETARGET_TRY_ASSIGN(errors[key], packer_.add(1, step, numbers));
      return {};
    };
    RETARGET_TRY(add("position", kErrorStepCm, row.position_errors_cm));
    RETARGET_TRY(add("rotation", kErrorStepDeg, row.rotation_errors_deg));
    if (errors.empty()) continue;
    errors["body"] = row.body;
    errors["bone"] = row.bone;
    json.push_back(std::move(errors));
  }
  return json;
}

Result<void> PageWriter::add(const PageMotion& motion) {
  const RobotClip& clip = *motion.clip;
  const Robot& robot = clip.robot();
  RETARGET_TRY_ASSIGN(const int robot_index, robot_of(motion));
  Json json = {{"label", motion.label.empty() ? robot.name() : motion.label},
               {"robot", robot_index},
               {"frames", clip.frame_count()},
               {"rate", {clip.rate().frames, clip.rate().seconds}}};
  if (motion.file_rate) json["file_rate"] = {motion.file_rate->frames, motion.file_rate->seconds};
  RETARGET_TRY_ASSIGN(json["tracks"], tracks_of(clip));
  json["limits"] =
      limits_json(robot, motion.limits != nullptr ? *motion.limits : robot.model_limits());
  json["contacts"] = robot_contacts(clip);
  if (motion.human != nullptr) {
    RETARGET_TRY_ASSIGN(json["human"], human_of(motion));
    const HumanPlacement placement = place_human(clip, *motion.human);
    json["placement"] = {placement.scale, placement.shift.x(), placement.shift.y(), placement.yaw};
    Json feet = Json::array();
    const SourceContacts contacts =
        motion.report != nullptr ? motion.report->contacts : find_contacts(*motion.human).of_ends();
    for (const auto& phases : contacts) feet.push_back(phases_json(phases));
    json["source_contacts"] = std::move(feet);
  }
  if (motion.scene != nullptr) {
    if (scene_excess(motion.scene->robot).empty()) {
      RETARGET_TRY_ASSIGN(json["scene"], scene_of(*motion.scene));
    }
    json["touches"] = page_touches(motion.scene->contacts, clip.frame_count());
  }
  if (motion.report != nullptr) {
    json["report"] = page_report(*motion.report, robot);
    const int stride = std::max(1, static_cast<int>(std::ceil(clip.rate().fps() / kErrorRate)));
    json["error_stride"] = stride;
    RETARGET_TRY_ASSIGN(json["errors"], error_tracks_of(*motion.report, stride));
  }
  motions_.push_back(std::move(json));
  return {};
}

Json links_json(const PageLinks& links) {
  return {{"index", links.index}, {"previous", links.previous}, {"next", links.next}};
}

Result<PageData> PageWriter::finish() const {
  Json header = {{"title", options_.title},
                 {"tool", "retarget " + version_number()},
                 {"precision",
                  {{"joint", 0.5 * kAngleStep},
                   {"root_m", 0.5 * kPageRootStep},
                   {"quaternion", 0.5 * kPageQuaternionStep},
                   {"bone_m", 0.5 * kBoneStep},
                   {"error_cm", 0.5 * kErrorStepCm},
                   {"error_deg", 0.5 * kErrorStepDeg}}},
                 {"figure", page_figure()},
                 {"robots", robots_},
                 {"humans", humans_},
                 {"motions", motions_},
                 {"tracks", tracks_json(packer_)}};
  if (!scenes_.empty()) header["scenes"] = scenes_;
  if (!options_.links.index.empty()) header["links"] = links_json(options_.links);
  return packed_page(header, packer_);
}

}  // namespace

namespace {

// Returns the rotation on the ground as a complex number: cosine, sine, times the lengths of both
// vectors.
Eigen::Vector2d turn_between(const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  return {from.dot(to), from.x() * to.y() - from.y() * to.x()};
}

Eigen::Vector2d turned(const Eigen::Vector2d& turn, const Eigen::Vector2d& point) {
  return {turn.x() * point.x() - turn.y() * point.y(), turn.y() * point.x() + turn.x() * point.y()};
}

// Returns the mean rotation from the human's to the robot's facing direction; not normalised.
Eigen::Vector2d turn_of_facing(const RobotClip& motion, const HumanClip& human, int frames) {
  // The T-pose faces x.
  const Eigen::Vector3d forward_in_hips =
      canonical_t_pose(Bone::kHips).transpose() * Eigen::Vector3d::UnitX();
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (int frame = 0; frame < frames; ++frame) {
    const Eigen::Vector3d robot =
        root_rotation(motion.qpos(frame)).normalized() * Eigen::Vector3d::UnitX();
    const Eigen::Vector3d body = human.frame(frame)[Bone::kHips].rotation * forward_in_hips;
    sum += turn_between(body.head<2>(), robot.head<2>());
  }
  return sum;
}

}  // namespace

HumanPlacement place_human(const RobotClip& motion, const HumanClip& human) {
  constexpr double kPathSpread = 0.25;  // Metres, root mean square: a smaller spread is not a path.
  constexpr double kMinSpread = 0.05;   // Likewise, minimum spread that defines a direction.
  constexpr double kAlike = 0.9;        // Minimum correlation of paths that belong together.
  constexpr double kMinTurn =
      0.3;  // Radians: the facing directions of hips and pelvis may differ slightly.
  const int frames = std::min(motion.frame_count(), human.frame_count);
  HumanPlacement placement;
  if (frames == 0) return placement;
  Eigen::Vector3d root = Eigen::Vector3d::Zero(), hips = Eigen::Vector3d::Zero();
  const auto root_at = [&](int frame) { return Eigen::Vector3d(motion.qpos(frame).data()); };
  const auto hips_at = [&](int frame) { return human.frame(frame)[Bone::kHips].translation; };
  for (int frame = 0; frame < frames; ++frame) {
    root += root_at(frame) / frames;
    hips += hips_at(frame) / frames;
  }
  Eigen::Vector2d both = Eigen::Vector2d::Zero();  // Rotation times scale.
  double own = 0.0, other = 0.0;
  for (int frame = 0; frame < frames; ++frame) {
    const Eigen::Vector2d from = (hips_at(frame) - hips).head<2>();
    both += turn_between(from, (root_at(frame) - root).head<2>());
    own += from.squaredNorm();
    other += (root_at(frame) - root).head<2>().squaredNorm();
  }
  const bool alike =
      own > kMinSpread * kMinSpread * frames && both.norm() > kAlike * std::sqrt(own * other);
  const bool walks = alike && own > kPathSpread * kPathSpread * frames;
  const auto plausible = [](double scale) {
    return std::isfinite(scale) && scale > 0.2 && scale < 3.0;
  };
  const double of_paths = both.norm() / own;
  const double scale = walks && plausible(of_paths) ? of_paths : root.z() / hips.z();
  // An implausible scale means that the motion does not belong to this human: keep 1.
  if (plausible(scale)) placement.scale = scale;
  const Eigen::Vector2d turn = alike ? both : turn_of_facing(motion, human, frames);
  const double yaw = atan2(turn.y(), turn.x());
  if (alike || std::abs(yaw) > kMinTurn) placement.yaw = yaw;
  const Eigen::Vector2d direction =
      placement.yaw != 0.0 ? turn.normalized() : Eigen::Vector2d(1.0, 0.0);
  placement.shift = root.head<2>() - placement.scale * turned(direction, hips.head<2>());
  return placement;
}

Json tracks_json(const TrackPacker& packer) {
  Json tracks = Json::array();
  for (const TrackPacker::Track& track : packer.tracks()) {
    tracks.push_back(
        {{"channels", track.channels}, {"frames", track.frames}, {"step", track.step}});
  }
  return tracks;
}

Result<PageData> packed_page(const Json& header, const TrackPacker& packer) {
  PageData page;
  // ASCII output; invalid UTF-8 becomes U+FFFD.
  RETARGET_TRY_ASSIGN(page.header,
                      packed_text(header.dump(-1, ' ', true, Json::error_handler_t::replace)));
  RETARGET_TRY_ASSIGN(page.tracks, packer.finish());
  return page;
}

Result<PageData> page_data(std::span<const PageMotion> motions, const PageOptions& options) {
  PageWriter writer(options);
  // Errors name the motion, because a page may contain several files.
  for (const PageMotion& motion : motions) {
    auto added = writer.add(motion);
    if (added) continue;
    Error& error = added.error();
    if (error.kind == ErrorKind::kInput && error.location.file.empty()) {
      error.location.file = motion.label;
    }
    return failure(std::move(error));
  }
  return writer.finish();
}

}  // namespace retarget
