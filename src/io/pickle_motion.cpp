// Motions in Python pickles: GMR's dictionary, PBHC's and ASAP's dictionaries of dictionaries,
// MimicKit's rows.

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cstdint>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "base/npy.h"
#include "base/option_name.h"
#include "base/pickle.h"
#include "base/suggest.h"
#include "base/try.h"
#include "io/raw_motion.h"
#include "math/so3.h"
#include "retarget/motion_io.h"
#include "retarget/options.h"

namespace retarget {
namespace {

// what a dictionary calls what
struct PickleKeys {
  MotionFormat format;
  const char *position, *rotation, *joints;
};

// numbers of a row before its joints
constexpr std::ptrdiff_t kMimicKitRoot = 6;
// a file's lists may have so many numbers for each of its bytes, and so many in any case
constexpr std::size_t kNumbersOfByte = 4, kFreeNumbers = 1'000'000;
// radians; rotation vectors of other tools may pass half a turn
constexpr double kMaxTurn = 100.0;

constexpr PickleKeys kGmrKeys = {MotionFormat::kPklGmr, "root_pos", "root_rot", "dof_pos"};
constexpr PickleKeys kPbhcKeys = {MotionFormat::kPklPbhc, "root_trans_offset", "root_rot", "dof"};

// reads members of one dictionary
class PickledMotion {
 public:
  // `bytes`: of the file
  PickledMotion(const PickleDocument& document, const PickleNode& motion, const std::string& file,
                std::size_t bytes)
      : document_(document),
        motion_(motion),
        file_(file),
        max_numbers_(std::max(kFreeNumbers, kNumbersOfByte * bytes)) {}

  Result<RawMotion> read(const PickleKeys& keys) {
    RawMotion raw;
    raw.format = keys.format;
    raw.metres_per_unit = 1.0;
    raw.degrees = false;
    for (const auto& [key, width, values] :
         {Member{keys.position, 3, &raw.position}, Member{keys.rotation, 4, &raw.rotation},
          Member{keys.joints, 0, &raw.joints}}) {
      const NpyArray* array = find(key);
      if (array == nullptr) {
        return input_failure(file_, "the pickle has no array \"" + std::string(key) + "\"",
                             "it has " + list_names(document_.keys(motion_)));
      }
      const bool fits = array->shape.size() == 2 && array->shape[1] > 0 &&
                        (width == 0 || array->shape[1] == width);
      if (!fits) {
        return input_failure(file_, "the array \"" + std::string(key) + "\" has the shape " +
                                        shape_text(array->shape) + ", expected (frames, " +
                                        (width == 0 ? "joints" : std::to_string(width)) + ")");
      }
      if (raw.frames == 0) raw.frames = array->shape[0];
      if (array->shape[0] != raw.frames) {
        return input_failure(file_, "the array \"" + std::string(key) + "\" has " +
                                        std::to_string(array->shape[0]) +
                                        " frames, those before it " + std::to_string(raw.frames));
      }
      *values = array->numbers();
      if (width == 0) raw.joint_count = array->shape[1];
    }
    if (raw.frames == 0) return input_failure(file_, "the file holds no frames");
    // PBHC's rotation vectors have rows of nobody behind the joints', SONIC's have none
    const NpyArray* vectors = find("pose_aa");
    if (keys.format == MotionFormat::kPklPbhc && vectors != nullptr && vectors->shape.size() == 3 &&
        vectors->shape[1] == 1 + raw.joint_count) {
      raw.format = MotionFormat::kPklMotionLib;
    }
    TRY(read_rate(raw));
    read_contacts(raw);
    return raw;
  }

  // rows of root position, rotation vector and joints
  Result<RawMotion> read_mimickit() {
    RawMotion raw;
    raw.format = MotionFormat::kPklMimicKit;
    raw.order = raw.usual = QuaternionOrder::kXyzw;
    raw.metres_per_unit = 1.0;
    raw.degrees = false;
    TRY_ASSIGN(const auto frames, rows_of("frames"));
    raw.frames = frames.rows;
    raw.joint_count = frames.columns - static_cast<std::size_t>(kMimicKitRoot);
    for (std::size_t frame = 0; frame < frames.rows; ++frame) {
      const auto row = frames.values.begin() + static_cast<std::ptrdiff_t>(frame * frames.columns);
      raw.position.insert(raw.position.end(), row, row + 3);
      const Eigen::Vector3d turn(row[3], row[4], row[5]);
      // written so that NaN is caught
      if (!(turn.norm() <= kMaxTurn)) {
        return input_failure(file_, "the root's rotation vector of frame " + std::to_string(frame) +
                                        " is longer than any rotation");
      }
      const Eigen::Quaterniond rotation = exp_so3(turn);
      raw.rotation.insert(raw.rotation.end(),
                          {rotation.x(), rotation.y(), rotation.z(), rotation.w()});
      raw.joints.insert(raw.joints.end(), row + kMimicKitRoot,
                        row + static_cast<std::ptrdiff_t>(frames.columns));
    }
    TRY(read_rate(raw));
    return raw;
  }

 private:
  struct Member {
    const char* key;
    std::size_t width;  // 0: any
    std::vector<double>* values;
  };

  struct Rows {
    std::size_t rows = 0, columns = 0;
    std::vector<double> values;
  };

  // an array, or lists of numbers
  Result<Rows> rows_of(const char* key) const {
    Rows rows;
    const auto fault = [&](const std::string& message) {
      return input_failure(file_, "\"" + std::string(key) + "\" " + message);
    };
    if (const NpyArray* array = find(key)) {
      if (array->shape.size() != 2) return fault("should have rows of numbers");
      rows = {array->shape[0], array->shape[1], array->numbers()};
    } else {
      const PickleNode* list = document_.find(motion_, key);
      if (list == nullptr || list->kind != PickleNode::Kind::kList) {
        return fault("should be a list of rows");
      }
      for (const std::uint32_t item : list->items) {
        const PickleNode& row = document_.at(item);
        if (rows.rows++ == 0) rows.columns = row.items.size();
        if (row.kind != PickleNode::Kind::kList || row.items.size() != rows.columns) {
          return fault("has rows of different lengths");
        }
        // one list may stand for many rows
        if (rows.values.size() + rows.columns > max_numbers_) {
          return fault("has more numbers than a file of its size has room for");
        }
        for (const std::uint32_t number : row.items) {
          const auto value = document_.number(document_.at(number));
          if (!value) return fault("has something else than numbers");
          rows.values.push_back(*value);
        }
      }
    }
    if (rows.rows == 0) return fault("holds no frames");
    if (rows.columns <= static_cast<std::size_t>(kMimicKitRoot))
      return fault("has no joints behind the root's six numbers");
    return rows;
  }

  // PBHC's: left and right foot
  void read_contacts(RawMotion& raw) const {
    const NpyArray* mask = find("contact_mask");
    if (mask == nullptr || mask->shape != std::vector<std::size_t>{raw.frames, 2}) return;
    raw.contacts.emplace();
    for (const double value : mask->numbers()) {
      raw.contacts->planted.insert(raw.contacts->planted.end(), 2, value > 0.5 ? 1 : 0);
    }
  }

  const NpyArray* find(const char* key) const {
    const PickleNode* member = document_.find(motion_, key);
    if (member == nullptr || member->kind != PickleNode::Kind::kArray) return nullptr;
    const NpyArray& array = document_.array(*member);
    return array.is_number() ? &array : nullptr;
  }

  Result<void> read_rate(RawMotion& raw) const {
    const PickleNode* fps = document_.find(motion_, "fps");
    if (fps == nullptr) return {};
    const auto value = document_.number(*fps);
    if (!value || !(*value >= kMinFileRate && *value <= kMaxFileRate)) {
      return input_failure(file_, "the pickle's fps is not a valid rate",
                           "give it with " OPTION("source-fps"));
    }
    raw.rate = frame_rate_from_fps(*value);
    return {};
  }

  const PickleDocument& document_;
  const PickleNode& motion_;
  const std::string& file_;
  std::size_t max_numbers_;  // in lists
};

}  // namespace

Result<RawMotion> read_pickle_motion(std::string_view bytes, const std::string& file,
                                     const ReadMotionOptions& options) {
  TRY_ASSIGN(const auto document, read_pickle(bytes, file));
  const PickleNode& root = document.root();
  if (root.kind != PickleNode::Kind::kDict) {
    return input_failure(file, "the pickle does not hold a motion dictionary");
  }
  if (document.find(root, kGmrKeys.position) != nullptr ||
      document.find(root, kGmrKeys.joints) != nullptr) {
    return PickledMotion(document, root, file, bytes.size()).read(kGmrKeys);
  }
  if (document.find(root, "loop_mode") != nullptr && document.find(root, "frames") != nullptr) {
    return PickledMotion(document, root, file, bytes.size()).read_mimickit();
  }
  if (document.find(root, kPbhcKeys.position) != nullptr) {
    return PickledMotion(document, root, file, bytes.size()).read(kPbhcKeys);
  }
  std::vector<std::string> motions;
  // a member that stands there many times is looked at once
  std::set<const PickleNode*> seen;
  for (std::size_t i = 0; i + 1 < root.items.size(); i += 2) {
    const PickleNode &key = document.at(root.items[i]), &member = document.at(root.items[i + 1]);
    if (key.kind != PickleNode::Kind::kText || !seen.insert(&member).second) continue;
    if (document.find(member, kPbhcKeys.position) != nullptr) motions.emplace_back(key.text);
  }
  if (motions.empty()) {
    return input_failure(file, "the pickle does not hold a robot motion",
                         "GMR's dictionary (root_pos, root_rot, dof_pos), PBHC's "
                         "(root_trans_offset, root_rot, dof) and MimicKit's (loop_mode, fps, "
                         "frames) are supported");
  }
  std::string chosen = motions.front();
  if (!options.motion.empty()) {
    chosen = options.motion;
    if (std::find(motions.begin(), motions.end(), chosen) == motions.end()) {
      return input_failure(
          file, "the file has no motion \"" + chosen + "\"" + did_you_mean(chosen, motions),
          "its motions are " + list_names(motions, 10));
    }
  } else if (motions.size() > 1) {
    return input_failure(file, "the file holds " + std::to_string(motions.size()) + " motions",
                         "choose one with " OPTION("motion") ": " + list_names(motions, 10));
  }
  auto raw =
      PickledMotion(document, *document.find(root, chosen), file, bytes.size()).read(kPbhcKeys);
  if (raw) raw->notes.push_back("motion \"" + chosen + "\"");
  return raw;
}

}  // namespace retarget
