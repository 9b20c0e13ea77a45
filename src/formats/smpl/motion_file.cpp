#include "formats/smpl/motion_arrays.h"

#include <fmt/format.h>
#include <array>
#include <set>
#include <utility>
#include <vector>

#include "base/option_name.h"
#include "base/try.h"
#include "formats/containers/file_kind.h"
#include "formats/containers/torch_file.h"
#include "formats/smpl/joint_motion.h"
#include "formats/smpl/read_smpl.h"
#include "retarget/text.h"

namespace retarget {
namespace {

using Kind = PickleNode::Kind;

constexpr std::string_view kMotionHint =
    "supported: GVHMR's results (smpl_params_global), InterMimic's tensors (frames, 591), and "
    "dictionaries with the arrays of an SMPL motion or joint positions: docs/smpl.md";

// Keys that identify dictionaries of robot motions.
constexpr std::array<std::string_view, 4> kOfRobots = {"dof_pos", "root_trans_offset",
                                                       "rigid_body_pos", "dof"};

std::string describe_names(const std::vector<std::string>& names) {
  constexpr std::size_t kShown = 8;
  std::vector<std::string> shown;
  shown.reserve(names.size());
  for (const std::string& name : names) shown.push_back(printable(name));
  return list_names(shown, kShown);
}

// Describes a value in a few words, for the error that no motion was found.
std::string describe_value(const PickleDocument& document, const PickleNode& node) {
  switch (node.kind) {
    case Kind::kTensor:
      return "one tensor of shape " + shape_text(document.tensor(node).shape);
    case Kind::kArray:
      return "one array of shape " + shape_text(document.array(node).shape);
    case Kind::kList:
    case Kind::kTuple:
      // numpy.save wraps a dictionary in an array of one object.
      if (node.items.size() == 1 && document.at(node.items[0]).kind == Kind::kDict) {
        return describe_value(document, document.at(node.items[0]));
      }
      return fmt::format("a list of {} values", node.items.size());
    case Kind::kDict: {
      const std::vector<std::string> names = document.keys(node);
      if (names.empty()) return fmt::format("a dictionary of {} values", node.items.size() / 2);
      return "a dictionary of " + describe_names(names);
    }
    default:
      return "a single value";
  }
}

bool is_of_robot(const PickleDocument& document, const PickleNode& node) {
  for (const std::string_view name : kOfRobots) {
    if (document.find(node, name) != nullptr) return true;
  }
  return false;
}

// The distinct dictionaries in a dictionary or list, each with its key or index.
struct Member {
  std::string name;
  const PickleNode* node;
};
std::vector<Member> dictionaries_in(const PickleDocument& document, const PickleNode& root) {
  std::vector<Member> members;
  std::set<const PickleNode*> seen;
  const bool keyed = root.kind == Kind::kDict;
  if (!keyed && root.kind != Kind::kList && root.kind != Kind::kTuple) return members;
  for (std::size_t i = keyed ? 1 : 0; i < root.items.size(); i += keyed ? 2 : 1) {
    const PickleNode& node = document.at(root.items[i]);
    if (node.kind != Kind::kDict || !seen.insert(&node).second) continue;
    std::string name = std::to_string(i);
    if (keyed) {
      const PickleNode& key = document.at(root.items[i - 1]);
      name = key.kind == Kind::kText ? printable(key.text) : std::to_string(key.integer);
    }
    members.push_back({std::move(name), &node});
  }
  return members;
}

// Finds the motion in a document.
class MotionFinder {
 public:
  MotionFinder(const PickleDocument& document, const std::string& file_name,
               const std::string& take)
      : document_(document), file_name_(file_name), take_(take) {}

  // Whether the motion is one of several and was selected by name or number.
  [[nodiscard]] bool took() const { return took_; }

  // Finds the dictionary with the motion.
  Result<const PickleNode*> find() {
    const PickleNode& root = document_.root();
    if (is_motion(root)) return &root;
    std::vector<Member> motions, robots;
    for (Member& member : dictionaries_in(document_, root)) {
      if (is_of_robot(document_, *member.node)) robots.push_back(member);
      if (is_motion(*member.node)) motions.push_back(std::move(member));
    }
    // If `take` is not its name, it may select one of several motions inside this one.
    if (motions.size() == 1 && motions.front().name != take_) return motions.front().node;
    if (!motions.empty()) return choose(motions);
    if (is_of_robot(document_, root) || !robots.empty()) {
      return input_failure(
          file_name_,
          "expected a human motion, found a robot motion: " +
              describe_value(document_, robots.empty() ? root : *robots.front().node),
          "it needs no retargeting; retarget convert reads robots' motions in CSV, NPZ and GMR's "
          "and "
          "PBHC's pickles");
    }
    return input_failure(file_name_,
                         "expected an SMPL motion, found " + describe_value(document_, root),
                         std::string(kMotionHint));
  }

 private:
  bool is_motion(const PickleNode& node) const {
    if (node.kind != Kind::kDict) return false;
    MadeArrays names(file_name_);
    for (std::string& name : document_.keys(node)) names.add(std::move(name), {});
    return has_motion(names) || has_joint_positions(names);
  }

  // Selects a motion by name, otherwise by number.
  Result<const PickleNode*> choose(const std::vector<Member>& motions) {
    std::vector<std::string> names;
    names.reserve(motions.size());
    for (const Member& motion : motions) {
      names.push_back(motion.name);
      if (motion.name != take_) continue;
      took_ = true;
      return motion.node;
    }
    const auto number = parse_number<long long>(take_);
    if (number && *number >= 1 && *number <= static_cast<long long>(motions.size())) {
      took_ = true;
      return motions[static_cast<std::size_t>(*number) - 1].node;
    }
    return input_failure(file_name_,
                         fmt::format("{} {}: {}",
                                     take_.empty() ? std::string("the file holds")
                                                   : fmt::format("no motion \"{}\": the file holds",
                                                                 printable(take_)),
                                     count_text(motions.size(), "motion"), list_names(names, 8)),
                         OPTION("take") " NAME chooses one, by its name or its number from 1");
  }

  const PickleDocument& document_;
  const std::string& file_name_;
  const std::string& take_;
  bool took_ = false;
};

// Results of GVHMR: a motion aligned with gravity, one in camera axes, and intermediate data.
constexpr std::string_view kGvhmrWorld = "smpl_params_global", kGvhmrCamera = "smpl_params_incam";

// Infers from the arrays which program made the motion.
MotionKind kind_of(const ArraySource& arrays) {
  MotionKind kind;
  const char* maker = nullptr;
  if (arrays.has("smpl_scaling") && arrays.has("smpl_poses")) {
    kind.fps = 60.0;
    kind.up = Eigen::Vector3d::UnitY();
    maker = "AIST++";
  } else if (arrays.has("rest_offsets") && arrays.has("trans2joint")) {
    kind.fps = 30.0;
    maker = "OMOMO";
  }
  // AMASS defines z as up; OMOMO uses the same array names.
  if (!kind.up && has_amass_names(arrays)) kind.up = Eigen::Vector3d::UnitZ();
  if (maker != nullptr) {
    kind.fps_reason = fmt::format("the file states no frame rate: assuming {:.0f} fps, as in {}",
                                  *kind.fps, maker);
  }
  return kind;
}

MotionFile motion_file_of(std::unique_ptr<ArraySource> arrays, bool took = false) {
  MotionKind kind = kind_of(*arrays);
  const bool of_joints = !has_motion(*arrays) && has_joint_positions(*arrays);
  const auto content = of_joints ? MotionContent::kJoints : MotionContent::kSmpl;
  return {std::move(arrays), std::move(kind), {}, content, took};
}

MotionKind gvhmr_kind() {
  MotionKind kind;
  kind.fps = 30.0;
  kind.fps_reason = "the file states no frame rate: assuming GVHMR's 30 fps";
  kind.gender = "neutral";
  kind.family = SmplFamily::kSmplx;
  kind.y_is_up = true;
  kind.up = Eigen::Vector3d::UnitZ();
  return kind;
}

Result<MotionFile> open_torch(std::string_view bytes, const std::string& file_name,
                              const ArrayReadOptions& options) {
  TorchReadOptions read;
  read.max_number_bytes = options.max_clip_bytes;
  TRY_ASSIGN(TorchFile torch, TorchFile::open(bytes, file_name, read));
  const PickleDocument& document = torch.document();
  const PickleNode& root = document.root();
  if (root.kind == Kind::kTensor) {
    const std::vector<std::size_t>& shape = document.tensor(root).shape;
    if (shape.size() == 2 && shape[1] == kInterMimicColumns) {
      TRY_ASSIGN(const auto table, torch.read(root, "data"));
      TRY_ASSIGN(InterMimicMotion motion, read_intermimic(table, file_name));
      return MotionFile{std::move(motion.arrays), std::move(motion.kind), {}};
    }
  }
  const PickleNode* world = document.find(root, kGvhmrWorld);
  if (world != nullptr) {
    return MotionFile{
        std::make_unique<DictionaryArrays>(file_name, torch, *world), gvhmr_kind(), {}};
  }
  if (document.find(root, kGvhmrCamera) != nullptr) {
    return input_failure(
        file_name,
        "the file has GVHMR's motion only in camera axes, which do not determine the up axis",
        "save smpl_params_global as well");
  }
  MotionFinder finder(document, file_name, options.take);
  TRY_ASSIGN(const auto* motion, finder.find());
  return motion_file_of(std::make_unique<DictionaryArrays>(file_name, torch, *motion),
                        finder.took());
}

}  // namespace

Result<MotionFile> open_pickled_motion(std::string_view bytes, const std::string& file_name,
                                       const ArrayReadOptions& options) {
  if (is_old_torch_file(bytes)) {
    return input_failure(file_name,
                         "the file has PyTorch's format before 1.6, which is not supported",
                         "save it again with a newer PyTorch: "
                         "torch.save(torch.load(\"old.pt\"), \"new.pt\")");
  }
  TRY_ASSIGN(PickleDocument document, read_pickle(bytes, file_name));
  MotionFinder finder(document, file_name, options.take);
  TRY_ASSIGN(const auto* motion, finder.find());
  return motion_file_of(std::make_unique<DictionaryArrays>(file_name, std::move(document), *motion),
                        finder.took());
}

Result<MotionFile> open_motion_file(std::string_view bytes, const std::string& file_name,
                                    const ArrayReadOptions& options) {
  const FileKind kind = file_type(bytes).kind;
  if (kind == FileKind::kTorch) return open_torch(bytes, file_name, options);
  if (kind == FileKind::kNpy) return open_array_motion(bytes, file_name, options);
  if (kind == FileKind::kPickle || kind == FileKind::kGzip) {
    return open_pickled_motion(bytes, file_name, options);
  }
  NpzReadOptions read;
  read.max_number_bytes = options.max_clip_bytes;
  TRY_ASSIGN(NpzFile file, NpzFile::open(bytes, file_name, read));
  return motion_file_of(std::make_unique<NpzArrays>(std::move(file)));
}

bool may_hold_array_motion(std::string_view bytes) {
  ArrayReadOptions options;
  options.take = "1";  // Of several motions.
  const auto file = open_motion_file(bytes, {}, options);
  if (file) return has_motion(*file->arrays) || has_joint_positions(*file->arrays);
  const FileKind kind = file_type(bytes).kind;
  if (kind == FileKind::kPickle || kind == FileKind::kGzip) return is_damaged_pickle(bytes);
  return bytes.empty() || kind == FileKind::kNpz;
}

}  // namespace retarget
