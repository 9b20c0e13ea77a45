#pragma once

#include "quality/draft.h"

namespace retarget {

/// How fast the root and the centre of mass change their velocities; the latter of a robot with
/// mass.
void measure_body_accelerations(const ReportBuilder& draft);

}  // namespace retarget
