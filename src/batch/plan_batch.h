#pragma once

#include <cstdint>
#include <list>
#include <map>
#include <string>
#include <vector>

#include "batch/batch_runner.h"
#include "batch/duplicates.h"
#include "batch/manifest.h"
#include "batch/manifests.h"
#include "batch/resume.h"
#include "retarget/batch.h"

namespace retarget {

// Everything that a batch needs before its first clip.
struct BatchPlan {
  std::vector<BatchInput> inputs;
  BatchSelection selection;
  std::list<BatchRobot> robots;
  std::vector<BatchTask> tasks;         // Tasks that remain.
  std::vector<ManifestEntry> left_out;  // Skipped duplicates.
  std::vector<ManifestEntry> replaced;  // Clips that are gone, whose outputs others replace.
  std::size_t unchanged = 0;
  std::uint64_t bytes = 0;
};

// Checks options that contradict each other.
[[nodiscard]] Result<void> check_batch(const BatchRequest& request);

// Normalised so that it can be joined with names in the manifest.
[[nodiscard]] std::string folder_text(const std::string& folder);

// Loads robots and finds inputs.
[[nodiscard]] Result<BatchPlan> plan_batch(const BatchRequest& request, const Shard& shard,
                                           Observer& observer);

// Creates tasks, longest first, without clips that are done already or are duplicates.
void plan_tasks(const FinishedClips& finished, const std::map<std::string, RepeatedClip>& repeated,
                BatchPlan& plan);

// Own entries except those of clips that are done again or are gone.
[[nodiscard]] std::vector<ManifestEntry> kept_entries(const BatchManifests& manifests,
                                                      const BatchPlan& plan);

}  // namespace retarget
