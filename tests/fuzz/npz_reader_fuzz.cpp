// Any bytes as an NPZ file, an NPY file, an SMPL motion or model, and as each array of files that
// are sound otherwise (whose checksums would keep most changes away); what is accepted must be sound.
//
//   npz_reader_fuzz CORPUS

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "retarget/base/npz.h"
#include "retarget/smpl/read_smpl.h"
#include "support/npz_builder.h"

namespace {

using retarget::NpyArray;
using retarget::NpzBuilder;
using retarget::NpzFile;
using retarget::Result;

void require(bool condition, const char* what) {
  if (condition) return;
  std::fprintf(stderr, "not true: %s\n", what);
  std::abort();
}

void check_array(const Result<NpyArray>& array) {
  if (!array) return require(!array.error().message.empty(), "errors say something");
  const std::size_t count = array->element_count();
  require(array->data.size() == count * array->item_size, "the shape explains the bytes");
  const std::size_t found = array->is_number() ? array->numbers().size() : array->texts().size();
  require(found == count, "every element is given");
}

void check_file(std::string_view bytes) {
  const Result<NpzFile> file = NpzFile::open(bytes, "fuzz.npz");
  if (!file) return require(!file.error().message.empty(), "errors say something");
  for (const std::string& name : file->names()) {
    (void)file->type_of(name);
    check_array(file->read(name));
  }
}

void check_motion(std::string_view bytes) {
  const auto motion = retarget::read_smpl(bytes, "fuzz.npz");
  if (!motion) return require(!motion.error().message.empty(), "errors say something");
  const retarget::Clip& clip = motion->clip;
  require(clip.frame_count() > 0 && clip.rate().fps() > 0.0, "motions have frames and a rate");
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    for (const auto& rotation : clip.rotations(frame)) {
      require(std::abs(rotation.norm() - 1.0) < 1e-9, "rotations are of unit length");
    }
    require(clip.translation(frame, 0).allFinite(), "translations are finite");
  }
}

// the arrays of a sound motion, one of them given
std::string motion_with(const std::string& name, const std::string& array) {
  NpzBuilder builder;
  const auto add = [&](const std::string& own_name, const std::string& own) {
    builder.add(own_name, own_name == name ? array : own);
  };
  add("poses", retarget::npy_doubles({2, 66}, std::vector<double>(2 * 66)));
  add("trans", retarget::npy_doubles({2, 3}, std::vector<double>(6)));
  add("betas", retarget::npy_doubles({1}, {0.5}));
  add("gender", retarget::npy_text("male"));
  add("fps", retarget::npy_doubles({}, {30}));
  return builder.build();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  check_file(bytes);
  check_array(retarget::read_npy(bytes, "fuzz.npy"));
  check_motion(bytes);
  (void)retarget::read_smpl_body(bytes, "fuzz.npz");
  for (const char* name : {"poses", "trans", "betas", "gender", "fps"}) {
    check_motion(motion_with(name, bytes));
  }
  return 0;
}
