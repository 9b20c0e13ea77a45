// Motions in Python pickles: GMR's dictionary, PBHC's and ASAP's dictionaries of dictionaries.

#include <algorithm>
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
#include "retarget/motion_io.h"
#include "retarget/options.h"

namespace retarget {
namespace {

// what a dictionary calls what
struct PickleKeys {
  MotionFormat format;
  const char *position, *rotation, *joints;
};

constexpr PickleKeys kGmrKeys = {MotionFormat::kPklGmr, "root_pos", "root_rot", "dof_pos"};
constexpr PickleKeys kPbhcKeys = {MotionFormat::kPklPbhc, "root_trans_offset", "root_rot", "dof"};

// reads members of one dictionary
class PickledMotion {
 public:
  PickledMotion(const PickleDocument& document, const PickleNode& motion, const std::string& file)
      : document_(document), motion_(motion), file_(file) {}

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
    TRY(read_rate(raw));
    return raw;
  }

 private:
  struct Member {
    const char* key;
    std::size_t width;  // 0: any
    std::vector<double>* values;
  };

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
    return PickledMotion(document, root, file).read(kGmrKeys);
  }
  if (document.find(root, kPbhcKeys.position) != nullptr) {
    return PickledMotion(document, root, file).read(kPbhcKeys);
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
                         "GMR's dictionary (root_pos, root_rot, dof_pos) and PBHC's "
                         "(root_trans_offset, root_rot, dof) are supported");
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
  auto raw = PickledMotion(document, *document.find(root, chosen), file).read(kPbhcKeys);
  if (raw) raw->notes.push_back("motion \"" + chosen + "\"");
  return raw;
}

}  // namespace retarget
