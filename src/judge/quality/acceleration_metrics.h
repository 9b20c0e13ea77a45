#pragma once

#include "judge/quality/draft.h"

namespace retarget {

/// Measures the accelerations of the root and, for a robot with mass, of the centre of mass.
void measure_body_accelerations(const ReportBuilder& draft);

}  // namespace retarget
