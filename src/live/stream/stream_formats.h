#pragma once

#include <memory>

#include "live/stream/decoder.h"

namespace retarget {

// Declared here for the table of formats, so that a new format does not affect users of decoder.h.

[[nodiscard]] std::unique_ptr<Decoder> make_line_decoder(const StreamAddress& from);
[[nodiscard]] std::unique_ptr<Encoder> make_line_encoder();
[[nodiscard]] std::unique_ptr<Decoder> make_bvh_row_decoder(const StreamAddress& from);
[[nodiscard]] std::unique_ptr<Encoder> make_bvh_row_encoder();
[[nodiscard]] std::unique_ptr<Decoder> make_vmc_decoder(const StreamAddress& from);
[[nodiscard]] std::unique_ptr<Encoder> make_vmc_encoder();
[[nodiscard]] std::unique_ptr<Decoder> make_rokoko_decoder(const StreamAddress& from);
[[nodiscard]] std::unique_ptr<Encoder> make_rokoko_encoder();
[[nodiscard]] std::unique_ptr<Decoder> make_smplx_decoder(const StreamAddress& from);
[[nodiscard]] std::unique_ptr<Encoder> make_smplx_encoder();
[[nodiscard]] bool smplx_plays_human(const Clip& clip);
[[nodiscard]] std::unique_ptr<Decoder> make_xrobot_decoder(const StreamAddress& from);
[[nodiscard]] std::unique_ptr<Encoder> make_xrobot_encoder();
[[nodiscard]] std::unique_ptr<Decoder> make_mvn_decoder(const StreamAddress& from);
[[nodiscard]] std::unique_ptr<Encoder> make_mvn_encoder();
/// Whether a clip lacks MVN's segments, the unit or the up axis.
[[nodiscard]] bool plays_human_as_mvn(const Clip& clip);
[[nodiscard]] std::unique_ptr<Decoder> make_natnet_decoder(const StreamAddress& from);
[[nodiscard]] std::unique_ptr<Encoder> make_natnet_encoder();

}  // namespace retarget
