#pragma once

#include "retarget/options.h"
#include "solve/fit/fit_model.h"

namespace retarget {

/// Adapts the tasks of upper arms and hands to the other tasks and joints of the same arm.
///
/// The rotation of an upper arm about its length shows only in a bent elbow: FitTask::forearm and
/// FitTask::straight_twist lower its weight while the elbow is straight.
///
/// A hand's rotation must not bend the elbow. If fewer than two joints between the forearm and the
/// hand can move, the hand cannot reach its target rotation without moving the forearm. Its task
/// then contains only the rotation about the axis of the one joint, or no rotation.
void relate_arm_tasks(const TrackingWeights& weights, FitModel& model);

}  // namespace retarget
