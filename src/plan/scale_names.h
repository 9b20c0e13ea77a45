#pragma once

#include <array>
#include <span>

#include "options/enum_names.h"
#include "retarget/ik_config.h"

namespace retarget {

/// How scales that were chosen are written: as ScaleRule's, which chose them.
inline std::span<const NamedValue<HeightScale>> named_values(HeightScale) {
  static constexpr std::array<NamedValue<HeightScale>, 3> kNames = {
      {{HeightScale::kPublished, "table"},
       {HeightScale::kNormalised, "height"},
       {HeightScale::kLimbs, "limbs"}}};
  return kNames;
}

}  // namespace retarget
