#pragma once

#include "quality/draft.h"
#include "retarget/human.h"

namespace retarget {

/// In how many of the frames the source lies or crawls, for gates on posture and feet, which are
/// about bodies that stand. Nothing of bodies without a trunk or a leg, whose posture is not known.
void measure_lying(const ReportBuilder& draft, const HumanClip& human, int frames);

}  // namespace retarget
