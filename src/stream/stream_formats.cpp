#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "base/suggest.h"
#include "stream/formats.h"

namespace retarget {
namespace {

// formats with bones of their own
bool always(const Clip&) {
  return true;
}

constexpr auto kFormats = std::to_array<StreamFormat>({
    {"lines", "JSON, one object a line: time, named joints with position and quaternion", 0, true,
     make_line_decoder, make_line_encoder},
    {"bvh", "rows of a BVH file's motion, a line each, as text; ?fps=N: they have no other time",
     1118, true, make_bvh_row_decoder, make_bvh_row_encoder},
    {"vmc",
     "VMC over OSC: bones of a VRM avatar, as Virtual Motion Capture, Waidayo, ... send them",
     39539, false, make_vmc_decoder, make_vmc_encoder, always},
    {"rokoko", "Rokoko Studio's custom streaming, JSON v3; ?actor=NAME of several", 14043, false,
     make_rokoko_decoder, make_rokoko_encoder, always},
    {"smplx", "rotation vectors of SMPL-X, SMPL+H or SMPL, JSON, one object a line", 0, true,
     make_smplx_decoder, make_smplx_encoder, smplx_plays_human},
    {"mvn", "Xsens MVN's network streamer, poses as quaternions; ?actor=N: one of several", 9763,
     false, make_mvn_decoder, make_mvn_encoder, plays_human_as_mvn},
    {"natnet",
     "OptiTrack Motive, NatNet 3.0 to 4.x; ?server=ADDRESS: who is asked for the skeleton, "
     "?multicast=239.255.42.99, ?version=4.1, ?actor=N",
     1511, false, make_natnet_decoder, make_natnet_encoder, nullptr, true, 1510},
});

}  // namespace

std::span<const StreamFormat> stream_formats() {
  return kFormats;
}

Result<const StreamFormat*> find_stream_format(const std::string& name) {
  if (name.empty()) return &kFormats.front();
  const auto* const found = std::ranges::find(kFormats, name, &StreamFormat::name);
  if (found != kFormats.end()) return found;
  std::vector<std::string> names;
  for (const StreamFormat& format : kFormats) names.emplace_back(format.name);
  return usage_failure("there is no format of streams called \"" + name + "\"",
                       did_you_mean(name, names));
}

}  // namespace retarget
