#include "smpl/motion_file.h"

#include <array>
#include <set>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/printable.h"
#include "base/suggest.h"
#include "base/torch_file.h"
#include "base/try.h"
#include "smpl/intermimic.h"

namespace retarget {
namespace {

using Kind = PickleNode::Kind;

constexpr std::string_view kMotionHint =
    "read are GVHMR's results (smpl_params_global), InterMimic's tensors (frames, 591), and "
    "dictionaries with the arrays of an SMPL motion: docs/smpl.md";

// members by which dictionaries of robots' motions are known
constexpr std::array<std::string_view, 4> kOfRobots = {"dof_pos", "root_trans_offset",
                                                       "rigid_body_pos", "dof"};

std::string describe_names(const std::vector<std::string>& names) {
  constexpr std::size_t kShown = 8;
  std::vector<std::string> shown;
  shown.reserve(names.size());
  for (const std::string& name : names) shown.push_back(printable(name));
  return list_names(shown, kShown);
}

// in a few words, for the sentence that says what was found instead of a motion
std::string describe_value(const PickleDocument& document, const PickleNode& node) {
  switch (node.kind) {
    case Kind::kTensor:
      return "one tensor of shape " + shape_text(document.tensor(node).shape);
    case Kind::kArray:
      return "one array of shape " + shape_text(document.array(node).shape);
    case Kind::kList:
    case Kind::kTuple:
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

// the dictionaries in a dictionary or list, each with its key or number, and each once
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

// finds the motion in a document
class MotionFinder {
 public:
  MotionFinder(const PickleDocument& document, const std::string& file_name)
      : document_(document), file_name_(file_name) {}

  // the dictionary with the motion
  Result<const PickleNode*> find() {
    const PickleNode& root = document_.root();
    if (is_motion(root)) return &root;
    std::vector<Member> motions, robots;
    for (Member& member : dictionaries_in(document_, root)) {
      if (is_of_robot(document_, *member.node)) robots.push_back(member);
      if (is_motion(*member.node)) motions.push_back(std::move(member));
    }
    if (motions.size() == 1) return motions.front().node;
    if (motions.size() > 1) return several(motions);
    if (is_of_robot(document_, root) || !robots.empty()) {
      return input_failure(
          file_name_,
          "expected a motion of a human, found one of a robot: " +
              describe_value(document_, robots.empty() ? root : *robots.front().node),
          "it needs no retargeting; retarget convert reads robots' motions in CSV, NPZ and GMR's "
          "and "
          "PBHC's pickles");
    }
    return input_failure(file_name_,
                         "expected a motion of SMPL, found " + describe_value(document_, root),
                         std::string(kMotionHint));
  }

 private:
  bool is_motion(const PickleNode& node) const {
    if (node.kind != Kind::kDict) return false;
    MadeArrays names(file_name_);
    for (std::string& name : document_.keys(node)) names.add(std::move(name), {});
    return has_motion(names);
  }

  Failure several(const std::vector<Member>& motions) const {
    std::vector<std::string> names;
    names.reserve(motions.size());
    for (const Member& motion : motions) names.push_back(motion.name);
    return input_failure(
        file_name_,
        fmt::format("the file holds {} motions: {}", motions.size(), list_names(names, 8)),
        "save each in a file of its own: numpy.savez(name, **motions[key])");
  }

  const PickleDocument& document_;
  const std::string& file_name_;
};

// the results of GVHMR: a motion along gravity, one in the camera's axes, and what led to them
constexpr std::string_view kGvhmrWorld = "smpl_params_global", kGvhmrCamera = "smpl_params_incam";

// what a motion's arrays tell of the program that made it
MotionKind kind_of(const ArraySource& arrays) {
  MotionKind kind;
  const char* maker = nullptr;
  if (arrays.has("smpl_scaling") && arrays.has("smpl_poses")) {
    kind.fps = 60.0;
    maker = "AIST++";
  } else if (arrays.has("rest_offsets") && arrays.has("trans2joint")) {
    kind.fps = 30.0;
    maker = "OMOMO";
  }
  if (maker != nullptr) {
    kind.fps_reason = fmt::format(
        "the file states no frame rate: {:.0f} fps, as {} has, are assumed", *kind.fps, maker);
  }
  return kind;
}

MotionFile motion_file_of(std::unique_ptr<ArraySource> arrays) {
  MotionKind kind = kind_of(*arrays);
  return {std::move(arrays), std::move(kind), {}};
}

MotionKind gvhmr_kind() {
  MotionKind kind;
  kind.fps = 30.0;
  kind.fps_reason =
      "the file states no frame rate: 30 fps, to which GVHMR resamples videos, are assumed";
  kind.gender = "neutral";
  kind.family = SmplFamily::kSmplx;
  kind.y_is_up = true;
  return kind;
}

Result<MotionFile> open_torch(std::string_view bytes, const std::string& file_name,
                              std::size_t max_number_bytes) {
  TorchReadOptions options;
  options.max_number_bytes = max_number_bytes;
  TRY_ASSIGN(TorchFile torch, TorchFile::open(bytes, file_name, options));
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
        "the file has GVHMR's motion in the camera's axes alone, which do not tell "
        "where up is",
        "save smpl_params_global as well");
  }
  TRY_ASSIGN(const auto* motion, MotionFinder(document, file_name).find());
  return motion_file_of(std::make_unique<DictionaryArrays>(file_name, torch, *motion));
}

Result<MotionFile> open_pickle(std::string_view bytes, const std::string& file_name) {
  if (is_old_torch_file(bytes)) {
    return input_failure(file_name,
                         "the file is of PyTorch's form before 1.6, which is not an archive and is "
                         "not read",
                         "save it again with a newer PyTorch: "
                         "torch.save(torch.load(\"old.pt\"), \"new.pt\")");
  }
  TRY_ASSIGN(PickleDocument document, read_pickle(bytes, file_name));
  TRY_ASSIGN(const auto* motion, MotionFinder(document, file_name).find());
  return motion_file_of(
      std::make_unique<DictionaryArrays>(file_name, std::move(document), *motion));
}

bool is_array(std::string_view bytes) {
  return bytes.starts_with("\x93NUMPY");
}

// gzip is left to the reader of BVH files, which come packed more often
bool is_pickle(std::string_view bytes) {
  return looks_like_pickle(bytes) && !bytes.starts_with("\x1f\x8b");
}

}  // namespace

bool looks_like_motion_file(std::string_view bytes) {
  return bytes.starts_with("PK\x03\x04") || is_array(bytes) || is_pickle(bytes);
}

Result<MotionFile> open_motion_file(std::string_view bytes, const std::string& file_name,
                                    std::size_t max_number_bytes) {
  if (is_torch_file(bytes)) return open_torch(bytes, file_name, max_number_bytes);
  if (is_array(bytes)) return open_array_motion(bytes, file_name, max_number_bytes);
  if (is_pickle(bytes)) return open_pickle(bytes, file_name);
  NpzReadOptions options;
  options.max_number_bytes = max_number_bytes;
  TRY_ASSIGN(NpzFile file, NpzFile::open(bytes, file_name, options));
  return motion_file_of(std::make_unique<NpzArrays>(std::move(file)));
}

}  // namespace retarget
