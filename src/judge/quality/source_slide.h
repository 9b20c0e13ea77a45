#pragma once

#include "judge/quality/draft.h"
#include "retarget/human.h"

namespace retarget {

/// Measures how much faster the slowest of the source's ankles and toes is than its hips. The gate
/// on it detects a source whose planted feet move because its root does not. Adds nothing for
/// bodies without feet or hips.
void measure_source_slide(const ReportBuilder& draft, const HumanClip& human, int frames);

}  // namespace retarget
