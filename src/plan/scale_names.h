#pragma once

#include <array>

#include "options/enum_names.h"
#include "retarget/retargeting_config.h"

namespace retarget {

/// How scales that were chosen are written: as ScaleRule's, which chose them.
template <>
inline constexpr auto kEnumNames<HeightScale> =
    std::to_array<NamedValue<HeightScale>>({{HeightScale::kPublished, "table"},
                                            {HeightScale::kNormalised, "height"},
                                            {HeightScale::kLimbs, "limbs"}});

}  // namespace retarget
