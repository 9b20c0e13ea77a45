// Reads motions from tracking NPZ files. Forward kinematics reveals the order of joints and bodies.

#include <algorithm>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/option_name.h"
#include "base/try.h"
#include "formats/containers/npz.h"
#include "formats/robot_motion/raw_motion.h"
#include "formats/robot_motion/trainer_arrays.h"
#include "retarget/motion_io.h"
#include "retarget/options.h"
#include "retarget/robot.h"
#include "retarget/text.h"
#include "robot/model/variant.h"

namespace retarget {
namespace {

// Tolerance of body positions against the robot's model, metres.
constexpr double kSamePlace = 0.01;
// Position and quaternion.
constexpr std::size_t kRootNumbers = 7;

// Maximum distance of bodies from their positions in a layout, over a sample of frames.
double layout_distance(const Robot& robot, const TrackingLayout& layout,
                       const TrainerArrays& arrays) {
  std::vector<PlacedBody> bodies;
  for (std::size_t b = 0; b < layout.bodies.size(); ++b) {
    bodies.push_back({b, {layout.bodies[b], Eigen::Vector3d::Zero()}});
  }
  const auto pose = [&](std::size_t frame, std::span<double> qpos) {
    std::copy_n(arrays.position.data() + 3 * frame * arrays.bodies, 3, qpos.begin());
    const double* turn = arrays.rotation.data() + 4 * frame * arrays.bodies;
    std::copy_n(turn, 4, qpos.begin() + 3);
    for (std::size_t j = 0; j < layout.joints.size(); ++j) {
      qpos[robot.joints()[layout.joints[j]].qpos_address] =
          arrays.raw.joints[frame * arrays.raw.joint_count + j];
    }
    return turn[0] * turn[0] + turn[1] * turn[1] + turn[2] * turn[2] + turn[3] * turn[3] > 0.25;
  };
  return largest_body_distance(robot, bodies, arrays.position, arrays.raw.frames, pose);
}

struct LayoutChoice {
  MotionFormat format = MotionFormat::kNpzMjlab;
  std::vector<int> joints;
  double distance = 0.0;
};

// The robot and its variants. Variants with their own bodies are also tried in their older form,
// which was the whole robot without the joints that they lack.
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

// Chooses the layout of the robot or of a variant that fits best.
Result<LayoutChoice> choose_layout(const std::shared_ptr<const Robot>& robot,
                                   const TrainerArrays& arrays, const ArraySource& npz,
                                   const ReadMotionOptions& options) {
  std::optional<LayoutChoice> best;
  bool joints_fit = false;
  for (const auto& candidate : layout_candidates(robot)) {
    for (const MotionFormat format : {MotionFormat::kNpzMjlab, MotionFormat::kNpzBeyondMimic}) {
      if (options.format && *options.format != format) continue;
      const TrackingLayout layout = tracking_layout(*candidate, format);
      if (layout.joints.size() != arrays.raw.joint_count) continue;
      joints_fit = true;
      const bool same_bodies = layout.bodies.size() == arrays.bodies;
      if (!same_bodies && !options.format) continue;
      const double distance = same_bodies ? layout_distance(*candidate, layout, arrays) : 0.0;
      if (!best || distance < best->distance) {
        best = {format, joints_among(*robot, *candidate, layout.joints), distance};
      }
    }
  }
  if (!best) {
    return npz.file_failure(
        "it has " + std::to_string(arrays.raw.joint_count) + " joints and " +
            std::to_string(arrays.bodies) + " bodies, which fits neither the robot " +
            robot->name() + " nor any of its variants",
        joints_fit ? OPTION("from") " npz-mjlab or npz-beyondmimic reads only the joints"
                   : "is it for another robot?");
  }
  if (!(best->distance <= kSamePlace) && !options.format) {
    return npz.file_failure(
        "its bodies are up to " + number_text(best->distance, 3) +
            " m away from the forward kinematics of the robot " + robot->name() +
            ", in mjlab's order and in BeyondMimic's",
        "is it for another robot? " OPTION("from") " npz-mjlab or npz-beyondmimic sets the order");
  }
  return *best;
}

// Contacts that retarget adds to every tracker's file.
Result<void> take_contacts(const ArraySource& npz, RawMotion& raw) {
  if (!npz.has("contacts")) return {};
  TRY_ASSIGN(const auto contacts, npz.read("contacts"));
  const std::vector<std::size_t> shape = {raw.frames, kContactNames.size()};
  if (!contacts.is_number() || contacts.shape != shape) {
    return npz.array_failure("contacts", "has the shape " + shape_text(contacts.shape) +
                                             ", expected " + shape_text(shape));
  }
  raw.contacts.emplace();
  for (const double value : contacts.numbers()) raw.contacts->planted.push_back(value > 0.5);
  return {};
}

// Joint names of a file whose joint arrays begin with the seven root numbers, as holosoma's do.
Result<std::vector<std::string>> names_behind_root(const ArraySource& npz,
                                                   std::size_t joint_count) {
  if (!npz.has("joint_names")) return std::vector<std::string>();
  TRY_ASSIGN(const auto names, npz.read("joint_names"));
  const bool behind =
      names.is_text() && names.shape.size() == 1 && joint_count == names.shape[0] + kRootNumbers;
  return behind ? names.texts() : std::vector<std::string>();
}

// Separates the root and the joints of holosoma's rows.
Result<void> take_holosoma(const ArraySource& npz, const std::vector<std::string>& names,
                           const Robot& robot, RawMotion& raw) {
  raw.format = MotionFormat::kNpzHolosoma;
  for (const std::string& name : names) {
    const auto joint = robot.find_joint(name);
    if (!joint) {
      return npz.array_failure("joint_names", "names the joint \"" + name + "\", which the robot " +
                                                  robot.name() + " does not have");
    }
    raw.joint_indices.push_back(*joint);
  }
  const std::vector<double> rows = std::exchange(raw.joints, {});
  raw.position.clear();
  raw.rotation.clear();
  for (auto row = rows.begin(); row != rows.end();
       row += static_cast<std::ptrdiff_t>(raw.joint_count)) {
    raw.position.insert(raw.position.end(), row, row + 3);
    raw.rotation.insert(raw.rotation.end(), row + 3, row + 7);
    raw.joints.insert(raw.joints.end(), row + 7,
                      row + static_cast<std::ptrdiff_t>(raw.joint_count));
  }
  raw.joint_count = names.size();
  return {};
}

}  // namespace

Result<RawMotion> read_npz_motion(std::string_view bytes, const std::shared_ptr<const Robot>& robot,
                                  const std::string& file, const ReadMotionOptions& options) {
  if (options.degrees || options.metres_per_unit) {
    return input_failure(
        file, "a tracking NPZ is in radians and metres",
        OPTION("source-angles") " and " OPTION("source-unit") " are for CSVs and pickles");
  }
  NpzReadOptions npz_options;
  npz_options.max_number_bytes = options.max_bytes;
  TRY_ASSIGN(auto opened, NpzFile::open(bytes, file, npz_options));
  const NpzArrays npz(std::move(opened));
  if (npz.has("clip_starts")) {
    return npz.file_failure("the file contains many clips, packed for training",
                            "give the files of the clips instead");
  }
  TRY_ASSIGN(auto arrays, read_trainer_arrays(npz, kTrackingLayout));
  TRY_ASSIGN(const auto names, names_behind_root(npz, arrays.raw.joint_count));
  if (names.empty()) {
    TRY_ASSIGN(auto choice, choose_layout(robot, arrays, npz, options));
    arrays.raw.format = choice.format;
    arrays.raw.joint_indices = std::move(choice.joints);
    arrays.raw.units_of_format = false;  // The bodies have confirmed them.
  } else {
    TRY(take_holosoma(npz, names, *robot, arrays.raw));
    take_named_bodies(npz, *robot, kTrackingLayout.position, "body_names", arrays.raw);
  }
  TRY(take_contacts(npz, arrays.raw));
  return std::move(arrays.raw);
}

}  // namespace retarget
