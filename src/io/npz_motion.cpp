// Motions in tracking NPZ files: which order joints and bodies are in is found by kinematics.

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/npz.h"
#include "base/number_text.h"
#include "base/option_name.h"
#include "base/suggest.h"
#include "base/try.h"
#include "io/raw_motion.h"
#include "retarget/motion_io.h"
#include "retarget/options.h"
#include "retarget/pose.h"
#include "retarget/robot.h"
#include "robot/variant.h"

namespace retarget {
namespace {

// metres by which bodies may lie elsewhere than the robot's model has them
constexpr double kSamePlace = 0.01;
constexpr std::size_t kFramesCompared = 40;
// position and quaternion
constexpr std::size_t kRootNumbers = 7;

struct TrackingArrays {
  std::size_t frames = 0, joint_count = 0, body_count = 0;
  std::vector<double> joint_pos, body_pos, body_quat;
};

Result<std::vector<double>> read_array(const NpzFile& npz, const char* name, std::size_t dimensions,
                                       std::vector<std::size_t>& shape) {
  TRY_ASSIGN(const auto array, npz.read(name));
  if (!array.is_number() || array.shape.size() != dimensions) {
    return npz.array_failure(name, "has the shape " + shape_text(array.shape) +
                                       " and should have " + std::to_string(dimensions) +
                                       " dimensions of numbers");
  }
  shape = array.shape;
  return array.numbers();
}

Result<TrackingArrays> read_arrays(const NpzFile& npz) {
  TrackingArrays arrays;
  std::vector<std::size_t> joints, positions, rotations;
  TRY_ASSIGN(auto joint_pos, read_array(npz, "joint_pos", 2, joints));
  TRY_ASSIGN(auto body_pos, read_array(npz, "body_pos_w", 3, positions));
  TRY_ASSIGN(auto body_quat, read_array(npz, "body_quat_w", 3, rotations));
  const bool fits = joints[0] == positions[0] && joints[0] == rotations[0] &&
                    positions[1] == rotations[1] && positions[1] > 0 && positions[2] == 3 &&
                    rotations[2] == 4;
  if (!fits) return npz.file_failure("its arrays disagree about frames or bodies");
  if (joints[0] == 0) return npz.file_failure("the file holds no frames");
  arrays.frames = joints[0];
  arrays.joint_count = joints[1];
  arrays.body_count = positions[1];
  arrays.joint_pos = std::move(joint_pos);
  arrays.body_pos = std::move(body_pos);
  arrays.body_quat = std::move(body_quat);
  return arrays;
}

// how far bodies lie at most from where a layout would have them, in a few frames
double largest_distance(const Robot& robot, const TrackingLayout& layout,
                        const TrackingArrays& arrays) {
  std::vector<Pose> world_from_body(robot.bodies().size());
  double largest = 0.0;
  const std::size_t step = std::max<std::size_t>(1, arrays.frames / kFramesCompared);
  for (std::size_t frame = 0; frame < arrays.frames; frame += step) {
    std::vector<double> qpos = robot.zero_configuration();
    const double* place = arrays.body_pos.data() + 3 * frame * arrays.body_count;
    const double* turn = arrays.body_quat.data() + 4 * frame * arrays.body_count;
    std::copy_n(place, 3, qpos.begin());
    std::copy_n(turn, 4, qpos.begin() + 3);
    if (!(turn[0] * turn[0] + turn[1] * turn[1] + turn[2] * turn[2] + turn[3] * turn[3] > 0.25)) {
      continue;
    }
    for (std::size_t j = 0; j < layout.joints.size(); ++j) {
      qpos[robot.joints()[layout.joints[j]].qpos_address] =
          arrays.joint_pos[frame * arrays.joint_count + j];
    }
    forward_kinematics(robot, qpos, world_from_body);
    for (std::size_t b = 0; b < layout.bodies.size(); ++b) {
      const Eigen::Vector3d found(place[3 * b], place[3 * b + 1], place[3 * b + 2]);
      const double distance = (found - world_from_body[layout.bodies[b]].translation).norm();
      if (!std::isfinite(distance)) return std::numeric_limits<double>::infinity();
      largest = std::max(largest, distance);
    }
  }
  return largest;
}

struct LayoutChoice {
  MotionFormat format = MotionFormat::kNpzMjlab;
  std::vector<int> joints;
  double distance = 0.0;
};

// the robot, its variants, and of those with bodies of their own what they were before they had
// them: the whole robot's without what its columns do not move
std::vector<std::shared_ptr<const Robot>> layout_candidates(
    const std::shared_ptr<const Robot>& robot) {
  std::vector<std::shared_ptr<const Robot>> candidates = {robot};
  for (RobotVariant variant : robot->profile().variants) {
    if (auto held = make_variant(robot, variant)) candidates.push_back(std::move(*held));
    if (variant.model.empty() && variant.bodies.empty()) continue;
    variant.model.clear();
    variant.bodies.clear();
    if (auto held = make_variant(robot, variant)) candidates.push_back(std::move(*held));
  }
  return candidates;
}

// joints of a variant, whose model may be another, among the robot's
std::vector<int> joints_among(const Robot& robot, const Robot& variant,
                              const std::vector<int>& joints) {
  std::vector<int> found;
  for (const int joint : joints) {
    if (const auto own = robot.find_joint(variant.joints()[joint].name)) found.push_back(*own);
  }
  return found;
}

// the layout of the robot or of a variant that fits best
Result<LayoutChoice> choose_layout(const std::shared_ptr<const Robot>& robot,
                                   const TrackingArrays& arrays, const NpzFile& npz,
                                   const ReadMotionOptions& options) {
  std::optional<LayoutChoice> best;
  bool joints_fit = false;
  for (const auto& candidate : layout_candidates(robot)) {
    for (const MotionFormat format : {MotionFormat::kNpzMjlab, MotionFormat::kNpzBeyondMimic}) {
      if (options.format && *options.format != format) continue;
      const TrackingLayout layout = tracking_layout(*candidate, format);
      if (layout.joints.size() != arrays.joint_count) continue;
      joints_fit = true;
      const bool same_bodies = layout.bodies.size() == arrays.body_count;
      if (!same_bodies && !options.format) continue;
      const double distance = same_bodies ? largest_distance(*candidate, layout, arrays) : 0.0;
      if (!best || distance < best->distance) {
        best = {format, joints_among(*robot, *candidate, layout.joints), distance};
      }
    }
  }
  if (!best) {
    return npz.file_failure(
        "it has " + std::to_string(arrays.joint_count) + " joints and " +
            std::to_string(arrays.body_count) + " bodies, which fits neither the robot " +
            robot->name() + " nor any of its variants",
        joints_fit ? OPTION("from") " npz-mjlab or npz-beyondmimic reads only the joints"
                   : "is it for another robot?");
  }
  if (!(best->distance <= kSamePlace) && !options.format) {
    return npz.file_failure(
        "its bodies lie up to " + number_text(best->distance, 3) +
            " m from where its joints put those of the robot " + robot->name() +
            ", in mjlab's order and in BeyondMimic's",
        "is it for another robot? " OPTION("from") " npz-mjlab or npz-beyondmimic sets the order");
  }
  return *best;
}

// what every tracker's file may have besides
Result<void> read_rate_and_contacts(const NpzFile& npz, RawMotion& raw) {
  if (npz.has("fps")) {
    TRY_ASSIGN(const auto fps, npz.read("fps"));
    const double value = fps.is_number() && fps.element_count() == 1 ? fps.numbers().front() : 0.0;
    if (!(value >= kMinFileRate && value <= kMaxFileRate))
      return npz.array_failure("fps", "is not a valid rate");
    raw.rate = frame_rate_from_fps(value);
  }
  if (npz.has("contacts")) {
    TRY_ASSIGN(const auto contacts, npz.read("contacts"));
    const std::vector<std::size_t> shape = {raw.frames, kContactNames.size()};
    if (!contacts.is_number() || contacts.shape != shape) {
      return npz.array_failure("contacts", "has the shape " + shape_text(contacts.shape) +
                                               " and should have " + shape_text(shape));
    }
    raw.contacts.emplace();
    for (const double value : contacts.numbers()) {
      raw.contacts->planted.push_back(value > 0.5 ? 1 : 0);
    }
  }
  return {};
}

// joint names of a file whose joints follow the root's seven numbers, as holosoma's do
Result<std::vector<std::string>> names_behind_root(const NpzFile& npz, std::size_t joint_count) {
  if (!npz.has("joint_names")) return std::vector<std::string>();
  TRY_ASSIGN(const auto names, npz.read("joint_names"));
  const bool behind =
      names.is_text() && names.shape.size() == 1 && joint_count == names.shape[0] + kRootNumbers;
  return behind ? names.texts() : std::vector<std::string>();
}

Result<RawMotion> read_holosoma(const NpzFile& npz, const TrackingArrays& arrays,
                                const std::vector<std::string>& names, const Robot& robot) {
  RawMotion raw;
  raw.format = MotionFormat::kNpzHolosoma;
  raw.order = raw.usual = QuaternionOrder::kWxyz;
  raw.degrees = false;
  raw.metres_per_unit = 1.0;
  raw.frames = arrays.frames;
  raw.joint_count = names.size();
  for (const std::string& name : names) {
    const auto joint = robot.find_joint(name);
    if (!joint) {
      return npz.array_failure("joint_names", "names the joint \"" + name + "\", which the robot " +
                                                  robot.name() + " does not have");
    }
    raw.joint_indices.push_back(*joint);
  }
  for (std::size_t frame = 0; frame < raw.frames; ++frame) {
    const auto row =
        arrays.joint_pos.begin() + static_cast<std::ptrdiff_t>(frame * arrays.joint_count);
    raw.position.insert(raw.position.end(), row, row + 3);
    raw.rotation.insert(raw.rotation.end(), row + 3, row + 7);
    raw.joints.insert(raw.joints.end(), row + 7,
                      row + static_cast<std::ptrdiff_t>(arrays.joint_count));
  }
  TRY(read_rate_and_contacts(npz, raw));
  return raw;
}

}  // namespace

Result<RawMotion> read_npz_motion(std::string_view bytes, const std::shared_ptr<const Robot>& robot,
                                  const std::string& file, const ReadMotionOptions& options) {
  NpzReadOptions npz_options;
  npz_options.max_number_bytes = options.max_bytes;
  TRY_ASSIGN(const auto npz, NpzFile::open(bytes, file, npz_options));
  for (const char* name : {"joint_pos", "body_pos_w", "body_quat_w"}) {
    if (npz.has(name)) continue;
    return npz.file_failure(
        "it is not a robot motion: there is no array \"" + std::string(name) + "\"",
        "it has " + list_names(npz.names(), 12));
  }
  if (npz.has("clip_starts")) {
    return npz.file_failure("the file holds many clips, packed for training",
                            "name the clips' own files");
  }
  TRY_ASSIGN(const auto arrays, read_arrays(npz));
  TRY_ASSIGN(const auto names, names_behind_root(npz, arrays.joint_count));
  if (!names.empty()) return read_holosoma(npz, arrays, names, *robot);
  TRY_ASSIGN(const auto layout, choose_layout(robot, arrays, npz, options));
  RawMotion raw;
  raw.format = layout.format;
  raw.frames = arrays.frames;
  raw.order = raw.usual = QuaternionOrder::kWxyz;
  raw.degrees = false;
  raw.metres_per_unit = 1.0;
  raw.joint_count = arrays.joint_count;
  raw.joint_indices = layout.joints;
  raw.joints = arrays.joint_pos;
  for (std::size_t frame = 0; frame < arrays.frames; ++frame) {
    const auto place =
        arrays.body_pos.begin() + static_cast<std::ptrdiff_t>(3 * frame * arrays.body_count);
    const auto turn =
        arrays.body_quat.begin() + static_cast<std::ptrdiff_t>(4 * frame * arrays.body_count);
    raw.position.insert(raw.position.end(), place, place + 3);
    raw.rotation.insert(raw.rotation.end(), turn, turn + 4);
  }
  TRY(read_rate_and_contacts(npz, raw));
  return raw;
}

}  // namespace retarget
