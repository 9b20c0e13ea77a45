// Reads motions from dictionaries of training frameworks: the pickles of GMR, PBHC, ASAP, SONIC and
// MimicKit, and the PyTorch files of ProtoMotions.

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/option_name.h"
#include "base/try.h"
#include "formats/containers/npy.h"
#include "formats/containers/pickle.h"
#include "formats/containers/torch_file.h"
#include "formats/robot_motion/raw_motion.h"
#include "formats/robot_motion/trainer_arrays.h"
#include "retarget/motion_io.h"
#include "retarget/options.h"
#include "retarget/so3.h"
#include "retarget/text.h"

namespace retarget {
namespace {

// Numbers of a row before its joints.
constexpr std::ptrdiff_t kMimicKitRoot = 6;
// Limits on the numbers in lists: per byte of the file, and a count that is always accepted.
constexpr std::size_t kNumbersOfByte = 4, kFreeNumbers = 1'000'000;
// Radians; rotation vectors of other tools may exceed half a turn.
constexpr double kMaxTurn = 100.0;

// Heel and toe of a foot are planted together in files with one value per foot.
void add_foot(bool planted, FootContacts& contacts) {
  contacts.planted.insert(contacts.planted.end(), 2, planted ? 1 : 0);
}

// The first body of each frame, which is the root.
std::vector<double> first_rows(const std::vector<double>& values, std::size_t frames,
                               std::size_t width) {
  std::vector<double> first;
  const std::size_t step = values.size() / frames;
  for (std::size_t at = 0; at < values.size(); at += step) {
    const auto begin = values.begin() + static_cast<std::ptrdiff_t>(at);
    first.insert(first.end(), begin, begin + static_cast<std::ptrdiff_t>(width));
  }
  return first;
}

// MimicKit's rows of numbers.
class MimicKitRows {
 public:
  // @param bytes  size of the file
  MimicKitRows(const PickleDocument& document, const std::string& file, std::size_t bytes)
      : document_(document),
        file_(file),
        max_numbers_(std::max(kFreeNumbers, kNumbersOfByte * bytes)) {}

  // Reads rows of root position, rotation vector and joint positions.
  Result<RawMotion> read() {
    RawMotion raw;
    raw.format = MotionFormat::kPklMimicKit;
    raw.order = raw.usual = QuaternionOrder::kXyzw;
    set_units_of_format(raw);
    TRY_ASSIGN(const auto frames, rows_of("frames"));
    raw.frames = frames.rows;
    raw.joint_count = frames.columns - static_cast<std::size_t>(kMimicKitRoot);
    for (std::size_t frame = 0; frame < frames.rows; ++frame) {
      const auto row = frames.values.begin() + static_cast<std::ptrdiff_t>(frame * frames.columns);
      raw.position.insert(raw.position.end(), row, row + 3);
      const Eigen::Vector3d turn(row[3], row[4], row[5]);
      // Negated comparison: also rejects NaN.
      if (!(turn.norm() <= kMaxTurn)) {
        return input_failure(file_, "the root rotation vector in frame " + std::to_string(frame) +
                                        " is longer than any rotation");
      }
      const Eigen::Quaterniond rotation = exp_so3(turn);
      raw.rotation.insert(raw.rotation.end(),
                          {rotation.x(), rotation.y(), rotation.z(), rotation.w()});
      raw.joints.insert(raw.joints.end(), row + kMimicKitRoot,
                        row + static_cast<std::ptrdiff_t>(frames.columns));
    }
    return raw;
  }

 private:
  struct Rows {
    std::size_t rows = 0, columns = 0;
    std::vector<double> values;
  };

  // Reads a 2-D array or a list of lists of numbers.
  Result<Rows> rows_of(const char* key) const {
    Rows rows;
    const auto fault = [&](const std::string& message) {
      return input_failure(file_, "\"" + std::string(key) + "\" " + message);
    };
    const PickleNode* list = document_.find(document_.root(), key);
    if (list != nullptr && list->kind == PickleNode::Kind::kArray) {
      const NpyArray& array = document_.array(*list);
      if (!array.is_number() || array.shape.size() != 2) {
        return fault("must have rows of numbers");
      }
      rows = {array.shape[0], array.shape[1], array.numbers()};
    } else {
      if (list == nullptr || list->kind != PickleNode::Kind::kList) {
        return fault("must be a list of rows");
      }
      for (const std::uint32_t item : list->items) {
        const PickleNode& row = document_.at(item);
        if (rows.rows++ == 0) rows.columns = row.items.size();
        if (row.kind != PickleNode::Kind::kList || row.items.size() != rows.columns) {
          return fault("has rows of different lengths");
        }
        // A pickle can repeat one list without storing it again, so limit the total.
        if (rows.values.size() + rows.columns > max_numbers_) {
          return fault("has more numbers than the file size allows");
        }
        for (const std::uint32_t number : row.items) {
          const auto value = document_.number(document_.at(number));
          if (!value) return fault("has non-numeric values");
          rows.values.push_back(*value);
        }
      }
    }
    if (rows.rows == 0) return fault("has no frames");
    if (rows.columns <= static_cast<std::size_t>(kMimicKitRoot))
      return fault("has no joints after the six numbers of the root");
    return rows;
  }

  const PickleDocument& document_;
  const std::string& file_;
  std::size_t max_numbers_;  // In lists.
};

// Reads the dictionary of PBHC, ASAP and SONIC.
Result<RawMotion> read_motion_lib(const ArraySource& file) {
  TRY_ASSIGN(TrainerArrays arrays, read_trainer_arrays(file, kMotionLibLayout));
  RawMotion raw = std::move(arrays.raw);
  // PBHC's rotation vectors have extra rows after the joints; SONIC's have none.
  if (file.has("pose_aa")) {
    const auto vectors = file.read("pose_aa");
    if (vectors && vectors->shape.size() == 3 && vectors->shape[1] == 1 + raw.joint_count) {
      raw.format = MotionFormat::kPklMotionLib;
    }
  }
  if (!file.has("contact_mask")) return raw;
  const auto mask = file.read("contact_mask");
  if (mask && mask->is_number() && mask->shape == std::vector<std::size_t>{raw.frames, 2}) {
    raw.contacts.emplace();
    for (const double value : mask->numbers()) add_foot(value > 0.5, *raw.contacts);
  }
  return raw;
}

Result<void> take_body_contacts(const ArraySource& file, const Robot& robot, std::size_t body_count,
                                RawMotion& raw) {
  if (!file.has("rigid_body_contacts")) return {};
  TRY_ASSIGN(const auto array, read_numbers(file, "rigid_body_contacts", 2));
  const std::vector<ProtoBody> bodies = proto_bodies(robot);
  if (array.shape != std::vector<std::size_t>{raw.frames, body_count} ||
      body_count != bodies.size()) {
    return {};
  }
  const auto left = proto_foot(robot, bodies, "left"), right = proto_foot(robot, bodies, "right");
  if (!left || !right) return {};
  const std::vector<double> values = array.numbers();
  raw.contacts.emplace();
  for (std::size_t frame = 0; frame < raw.frames; ++frame) {
    for (const std::size_t foot : {*left, *right}) {
      add_foot(values[frame * body_count + foot] > 0.5, *raw.contacts);
    }
  }
  return {};
}

// Takes the bodies if there are as many as the robot has, because the file does not name them.
void take_proto_places(const Robot& robot, TrainerArrays& arrays, RawMotion& raw) {
  const std::vector<ProtoBody> bodies = proto_bodies(robot);
  if (arrays.bodies != bodies.size()) return;
  for (std::size_t column = 0; column < bodies.size(); ++column) {
    const auto carrier = robot.find_body(bodies[column].carrier);
    if (carrier) raw.places.bodies.push_back({column, {*carrier, bodies[column].place}});
  }
  raw.places.positions = std::move(arrays.position);
}

// The motion to read from a dictionary of motions.
Result<std::string> choose_motion(const PickleDocument& document, const std::string& file,
                                  const ReadMotionOptions& options) {
  const PickleNode& root = document.root();
  std::vector<std::string> motions;
  std::map<const PickleNode*, bool> is_motion;  // By member, which may have many references.
  for (std::size_t i = 0; i + 1 < root.items.size(); i += 2) {
    const PickleNode &key = document.at(root.items[i]), &member = document.at(root.items[i + 1]);
    if (key.kind != PickleNode::Kind::kText) continue;
    const auto [found, is_new] = is_motion.try_emplace(&member, false);
    if (is_new) found->second = document.find(member, kMotionLibLayout.position) != nullptr;
    if (found->second) motions.emplace_back(key.text);
  }
  if (motions.empty()) {
    return input_failure(file, "the pickle does not contain a robot motion",
                         "GMR's dictionary (root_pos, root_rot, dof_pos), PBHC's "
                         "(root_trans_offset, root_rot, dof) and MimicKit's (loop_mode, fps, "
                         "frames) are supported");
  }
  const std::string chosen = options.motion.empty() ? motions.front() : options.motion;
  if (std::ranges::find(motions, chosen) == motions.end()) {
    return input_failure(
        file, "the file has no motion \"" + chosen + "\"" + did_you_mean(chosen, motions),
        "its motions are " + list_names(motions, 10));
  }
  if (options.motion.empty() && motions.size() > 1) {
    return input_failure(file, "the file holds " + std::to_string(motions.size()) + " motions",
                         "choose one with " OPTION("motion") ": " + list_names(motions, 10));
  }
  return chosen;
}

}  // namespace

Result<NpyArray> read_numbers(const ArraySource& file, std::string_view name,
                              std::size_t dimensions) {
  TRY_ASSIGN(auto array, file.read(name));
  if (array.is_number() && array.shape.size() == dimensions) return array;
  return file.array_failure(name, "has the shape " + shape_text(array.shape) + ", expected " +
                                      std::to_string(dimensions) + " dimensions of numbers");
}

Result<void> take_rate(const ArraySource& file, RawMotion& raw) {
  if (!file.has("fps")) return {};
  const auto fps = file.read("fps");
  const bool is_one = fps && fps->is_number() && fps->element_count() == 1;
  const double value = is_one ? fps->numbers().front() : 0.0;
  if (!(value >= kMinFileRate && value <= kMaxFileRate)) {
    return file.array_failure("fps", "is not a valid rate", "give it with " OPTION("source-fps"));
  }
  raw.rate = frame_rate_from_fps(value);
  return {};
}

void set_units_of_format(RawMotion& raw) {
  raw.metres_per_unit = 1.0;
  raw.degrees = false;
  raw.units_of_format = true;
}

Result<TrainerArrays> read_trainer_arrays(const ArraySource& file, const TrainerLayout& layout) {
  for (const std::string_view name : {layout.joints, layout.position, layout.rotation}) {
    if (file.has(name)) continue;
    return file.file_failure(
        "it is not a robot motion: it has no array \"" + std::string(name) + "\"",
        "it has " + list_names(file.names(), 12));
  }
  const std::size_t dimensions = layout.bodies ? 3 : 2;
  TRY_ASSIGN(const auto joints, read_numbers(file, layout.joints, 2));
  TRY_ASSIGN(const auto position, read_numbers(file, layout.position, dimensions));
  TRY_ASSIGN(const auto rotation, read_numbers(file, layout.rotation, dimensions));
  const std::vector<std::size_t>&place = position.shape, &turn = rotation.shape;
  const bool fits = place[0] == joints.shape[0] && turn[0] == joints.shape[0] &&
                    joints.shape[1] > 0 && place.back() == 3 && turn.back() == 4 && place[1] > 0 &&
                    (!layout.bodies || place[1] == turn[1]);
  if (!fits) {
    return file.file_failure(
        "its arrays have different numbers of frames or bodies: " + shape_text(joints.shape) +
        ", " + shape_text(place) + ", " + shape_text(turn));
  }
  if (joints.shape[0] == 0) return file.file_failure("the file has no frames");
  TrainerArrays arrays;
  RawMotion& raw = arrays.raw;
  raw.format = layout.format;
  raw.usual = layout.order;
  if (layout.order_known) raw.order = layout.order;
  set_units_of_format(raw);
  raw.frames = joints.shape[0];
  raw.joint_count = joints.shape[1];
  raw.joints = joints.numbers();
  arrays.position = position.numbers();
  arrays.rotation = rotation.numbers();
  if (layout.bodies) arrays.bodies = place[1];
  raw.position = first_rows(arrays.position, raw.frames, 3);
  raw.rotation = first_rows(arrays.rotation, raw.frames, 4);
  TRY(take_rate(file, raw));
  return arrays;
}

Result<RawMotion> read_pickle_motion(std::string_view bytes,
                                     const std::shared_ptr<const Robot>& robot,
                                     const std::string& file, const ReadMotionOptions& options) {
  TRY_ASSIGN(auto document, read_pickle(bytes, file));
  const PickleNode& root = document.root();
  if (root.kind != PickleNode::Kind::kDict) {
    return input_failure(file, "the pickle does not contain a motion dictionary");
  }
  const auto has = [&](std::string_view key) { return document.find(root, key) != nullptr; };
  if (has(kGmrLayout.position) || has(kGmrLayout.joints)) {
    const DictionaryArrays arrays(file, std::move(document), root);
    TRY_ASSIGN(auto motion, read_trainer_arrays(arrays, kGmrLayout));
    take_named_bodies(arrays, *robot, "local_body_pos", "link_body_list", motion.raw);
    motion.raw.places.of_root = true;
    return std::move(motion.raw);
  }
  if (has("loop_mode") && has("frames")) {
    TRY_ASSIGN(auto raw, MimicKitRows(document, file, bytes.size()).read());
    TRY(take_rate(DictionaryArrays(file, std::move(document), root), raw));
    return raw;
  }
  if (has(kMotionLibLayout.position)) {
    return read_motion_lib(DictionaryArrays(file, std::move(document), root));
  }
  TRY_ASSIGN(const std::string chosen, choose_motion(document, file, options));
  const PickleNode& motion = *document.find(root, chosen);
  auto raw = read_motion_lib(DictionaryArrays(file, std::move(document), motion));
  if (raw) raw->notes.push_back("motion \"" + chosen + "\"");
  return raw;
}

Result<RawMotion> read_protomotions(std::string_view bytes,
                                    const std::shared_ptr<const Robot>& robot,
                                    const std::string& file, const ReadMotionOptions& options) {
  TorchReadOptions torch_options;
  torch_options.max_number_bytes = options.max_bytes;
  TRY_ASSIGN(const auto torch, TorchFile::open(bytes, file, torch_options));
  const PickleNode& root = torch.document().root();
  if (root.kind != PickleNode::Kind::kDict) {
    return input_failure(file, "the PyTorch file does not contain a robot motion",
                         "ProtoMotions' dictionary (dof_pos, rigid_body_pos, rigid_body_rot) is "
                         "supported");
  }
  const PickleNode* state = torch.document().find(root, "state_conversion");
  const DictionaryArrays arrays(file, torch, root);
  TRY_ASSIGN(auto motion, read_trainer_arrays(arrays, kProtoLayout));
  RawMotion raw = std::move(motion.raw);
  if (state != nullptr && state->kind == PickleNode::Kind::kText && state->text != "common") {
    raw.warnings.push_back("its state_conversion is \"" + printable(state->text) +
                           "\"; it is read as \"common\", in the order of the model");
  }
  // A layout lists joints in the model's order.
  const TrackingLayout layout = tracking_layout(*robot, MotionFormat::kProtoMotions);
  if (layout.joints.size() == raw.joint_count) raw.joint_indices = layout.joints;
  take_proto_places(*robot, motion, raw);
  TRY(take_body_contacts(arrays, *robot, motion.bodies, raw));
  return raw;
}

namespace {

// A body that ProtoMotions' model of the G1 (g1_bm_box_feet.xml) adds to Unitree's: the body that
// it precedes, its name, the body that it is fixed to, and its position there in metres.
struct OwnBody {
  std::string_view before, name, carrier;
  double x, z;
};
constexpr OwnBody kOwnBodiesOfG1[] = {
    {"left_hip_pitch_link", "head", "pelvis", 0.0, 0.4},
    {"right_shoulder_pitch_link", "left_rubber_hand", "left_wrist_yaw_link", 0.12, 0.0},
    {"", "right_rubber_hand", "right_wrist_yaw_link", 0.12, 0.0}};

void add_own_bodies(std::string_view before, std::vector<ProtoBody>& bodies) {
  for (const OwnBody& own : kOwnBodiesOfG1) {
    if (own.before != before) continue;
    bodies.push_back(
        {std::string(own.name), std::string(own.carrier), Eigen::Vector3d(own.x, 0.0, own.z)});
  }
}

}  // namespace

std::vector<ProtoBody> proto_bodies(const Robot& robot) {
  const TrackingLayout layout = tracking_layout(robot, MotionFormat::kProtoMotions);
  constexpr std::size_t kJointsOfG1 = 29;
  const bool is_g1 = robot.name() == "unitree_g1" && layout.joints.size() == kJointsOfG1;
  std::vector<ProtoBody> bodies;
  for (const int body : layout.bodies) {
    const std::string& name = robot.bodies()[body].name;
    if (is_g1) add_own_bodies(name, bodies);
    bodies.push_back({name, name});
  }
  if (is_g1) add_own_bodies("", bodies);
  return bodies;
}

std::optional<std::size_t> proto_foot(const Robot& robot, const std::vector<ProtoBody>& bodies,
                                      std::string_view side) {
  for (const Sole& sole : robot.profile().soles) {
    if (sole.side != side) continue;
    // The sole's body itself, or the nearest ancestor in the list.
    for (int body = sole.body; body > 0; body = robot.bodies()[body].parent) {
      const auto found = std::ranges::find(bodies, robot.bodies()[body].name, &ProtoBody::name);
      if (found != bodies.end()) return static_cast<std::size_t>(found - bodies.begin());
    }
  }
  return std::nullopt;
}

}  // namespace retarget
