// Any bytes as a BVH file, read in every way; an accepted file must be valid and must survive a
// round trip through the writer.

#include <string>
#include <string_view>

#include "formats/bvh/read_bvh.h"
#include "fuzz/fuzz_target.h"
#include "retarget/bvh.h"

namespace retarget::fuzz {
namespace {

void check_error(const Error& error, bool has_place) {
  require(!error.message.empty(), "errors say something");
  require(!has_place || (error.location.line > 0 && error.location.column > 0),
          "errors have a place");
}

void check_round_trip(const Clip& clip) {
  const Result<std::string> text = format_bvh(clip);
  require(text.has_value(), "a clip that was read can be written");
  const Result<BvhFile> again = read_bvh(*text, "written.bvh");
  require(again.has_value(), "a written clip can be read");
  const Clip& back = again->clip;
  require(back.frame_count() == clip.frame_count(), "frames come back");
  require(back.skeleton().names() == clip.skeleton().names(), "names come back");
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    for (int joint = 0; joint < clip.skeleton().joint_count(); ++joint) {
      const auto& before = clip.rotations(frame)[joint];
      require(before.angularDistance(back.rotations(frame)[joint]) < 1e-9, "rotations come back");
      const auto gap = clip.translation(frame, joint) - back.translation(frame, joint);
      require(gap.cwiseAbs().maxCoeff() < 1e-9, "translations come back");
    }
  }
}

}  // namespace

void fuzz_bvh(std::string_view bytes) {
  for (int way = 0; way < 5; ++way) {
    BvhReadOptions options;
    options.lenient = way == 1;
    options.motion_optional = way == 2;
    if (way == 3) options.source_fps = 30.0;
    if (way == 4) options.root = "Two";
    const Result<BvhFile> file = read_bvh(bytes, "fuzz.bvh", options);
    if (!file) {
      check_error(file.error(), options.root.empty());
      continue;
    }
    check_frames(file->clip);
    check_round_trip(file->clip);
  }
}

}  // namespace retarget::fuzz
