// Any bytes as an array file: NPY, NPZ, an SMPL motion or model, a pickle, a PyTorch file.

#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "formats/containers/npz.h"
#include "formats/containers/pickle.h"
#include "formats/containers/torch_file.h"
#include "formats/smpl/read_smpl.h"
#include "fuzz/fuzz_target.h"
#include "human/skeleton/joint_clip.h"
#include "support/npz_builder.h"
#include "support/read_npy.h"

namespace retarget::fuzz {
namespace {

void check_array(const Result<NpyArray>& array) {
  if (!good(array)) return;
  const std::size_t count = array->element_count();
  require(array->data.size() == count * array->item_size, "the shape explains the bytes");
  const std::size_t found = array->is_number() ? array->numbers().size() : array->texts().size();
  require(found == count, "every element is given");
}

void check_clip(const Clip& clip) {
  require(clip.frame_count() > 0 && clip.rate().fps() > 0.0, "motions have frames and a rate");
  for (const Joint& joint : clip.skeleton().joints()) {
    require(joint.offset.allFinite(), "offsets are finite");
  }
  check_frames(clip);
}

void check_motion(std::string_view bytes) {
  ArrayReadOptions options;
  // Of several motions, reads the first one.
  options.take = "1";
  const auto motion = read_array_motion(bytes, "fuzz.npz", options);
  if (!good(motion)) return;
  if (const auto* joints = std::get_if<JointMotion>(&*motion)) {
    const auto made = clip_of_joints(*joints, "fuzz.npz");
    if (good(made)) check_clip(*made);
    return;
  }
  check_clip(std::get<SmplMotion>(*motion).clip);
}

// SMPL's 22 joints of a standing body, in two frames.
std::vector<double> standing_twice() {
  constexpr std::array kBody = {0.0,  0.0,  0.0,  .09,  -.08, 0.0,  -.09, -.08, 0.0,  0.0,  .11,
                                0.0,  .09,  -.46, .02,  -.09, -.46, .02,  0.0,  .25,  0.0,  .09,
                                -.87, 0.0,  -.09, -.87, 0.0,  0.0,  .31,  0.0,  .09,  -.92, .12,
                                -.09, -.92, .12,  0.0,  .52,  0.0,  .07,  .43,  0.0,  -.07, .43,
                                0.0,  0.0,  .62,  0.0,  .18,  .45,  0.0,  -.18, .45,  0.0,  .44,
                                .45,  0.0,  -.44, .45,  0.0,  .68,  .45,  .05,  -.68, .45,  .05};
  std::vector<double> values(kBody.begin(), kBody.end());
  values.insert(values.end(), kBody.begin(), kBody.end());
  values[3] += 0.01;
  return values;
}

// The arrays of a valid motion, one of them from the input.
std::string motion_with(const std::string& name, const std::string& array) {
  NpzBuilder builder;
  const auto add = [&](const std::string& own_name, const std::string& own) {
    builder.add(own_name, own_name == name ? array : own);
  };
  add("poses", npy_doubles({2, 66}, std::vector<double>(2 * 66)));
  add("trans", npy_doubles({2, 3}, std::vector<double>(6)));
  add("betas", npy_doubles({1}, {0.5}));
  add("gender", npy_text("male"));
  add("fps", npy_doubles({}, {30}));
  return builder.build();
}

// The same for the arrays of joint positions.
std::string places_with(const std::string& name, const std::string& array) {
  NpzBuilder builder;
  const auto add = [&](const std::string& own_name, const std::string& own) {
    builder.add(own_name, own_name == name ? array : own);
  };
  const bool kimodo = name == "global_rot_mats";
  add(kimodo ? "posed_joints" : "joint_positions", npy_doubles({2, 22, 3}, standing_twice()));
  if (kimodo || name == "joint_names" || name == "height") add(name, array);
  add("fps", npy_doubles({}, {20}));
  return builder.build();
}

void check_pickle(std::string_view bytes) {
  const auto document = read_pickle(bytes, "fuzz.pkl");
  if (!good(document)) return;
  const auto& root = document->root();
  (void)document->number(root);
  for (const std::string& key : document->keys(root)) {
    const auto* member = document->find(root, key);
    require(member != nullptr, "keys are found");
    if (member->kind != PickleNode::Kind::kArray) continue;
    const auto& array = document->array(*member);
    require(array.data.size() == array.element_count() * array.item_size,
            "the shape explains the bytes");
  }
}

// Reads all tensors that the root names, each up to the end of its storage.
void check_torch(std::string_view bytes) {
  const auto file = TorchFile::open(bytes, "fuzz.pt");
  if (!good(file)) return;
  const PickleDocument& document = file->document();
  const auto check = [&](const PickleNode& node) {
    if (node.kind == PickleNode::Kind::kTensor) check_array(file->read(node, "tensor"));
  };
  check(document.root());
  for (const std::string& key : document.keys(document.root())) {
    check(*document.find(document.root(), key));
  }
}

}  // namespace

void fuzz_npy(std::string_view bytes) {
  check_array(read_npy(bytes, "fuzz.npy"));
}

void fuzz_npz(std::string_view bytes) {
  const Result<NpzFile> file = NpzFile::open(bytes, "fuzz.npz");
  if (!good(file)) return;
  for (const std::string& name : file->names()) {
    (void)file->type_of(name);
    check_array(file->read(name));
  }
}

void fuzz_smpl(std::string_view bytes) {
  check_motion(bytes);
}

// Checksums catch most changes of a whole file, so each array of a valid one is replaced in turn.
void fuzz_smpl_arrays(std::string_view bytes) {
  for (const char* name : {"poses", "trans", "betas", "gender", "fps"}) {
    check_motion(motion_with(name, std::string(bytes)));
  }
  for (const char* name : {"joint_positions", "joint_names", "fps", "height", "global_rot_mats"}) {
    check_motion(places_with(name, std::string(bytes)));
  }
}

void fuzz_smpl_body(std::string_view bytes) {
  const auto body = read_smpl_body(bytes, "fuzz.npz");
  if (!good(body)) return;
  const SmplRestBody rest = smpl_rest_body(*body, {});
  require(std::isfinite(rest.height), "bodies have a height");
}

void fuzz_pickle(std::string_view bytes) {
  check_pickle(bytes);
  check_pickle("\x80\x04" + std::string(bytes));
}

// Checksums catch most changes of a whole file, so the bytes are also used as its pickle.
void fuzz_torch(std::string_view bytes) {
  check_torch(bytes);
  check_motion(bytes);
  NpzBuilder archive;
  archive.add_entry("fuzz/data.pkl", "\x80\x02" + std::string(bytes), {});
  archive.add_entry("fuzz/byteorder", "little", {});
  for (const char* key : {"0", "1", "2", "3"}) {
    archive.add_entry(std::string("fuzz/data/") + key, std::string(396, '\x3c'), {});
  }
  const std::string file = archive.build();
  check_torch(file);
  check_motion(file);
}

}  // namespace retarget::fuzz
