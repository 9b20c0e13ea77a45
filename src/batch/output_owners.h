#pragma once

#include <list>
#include <set>
#include <string>
#include <vector>

#include "batch/batch_runner.h"
#include "batch/find_inputs.h"
#include "batch/manifest.h"
#include "retarget/batch.h"
#include "retarget/error.h"
#include "retarget/run.h"

namespace retarget {

/// Checks that the clips of a batch replace no output of another manifest entry, such as that of
/// another robot or of a file with the same stem. An entry whose clip is gone gives way.
/// @param known  entries of all manifests of the folder.
/// @param clips  relative names of all clips that the batch found.
/// @return the entries that give way. Errors: kUsage.
[[nodiscard]] Result<std::vector<ManifestEntry>> entries_that_give_way(
    const std::vector<BatchInput>& inputs, const BatchRequest& request,
    const std::list<BatchRobot>& robots, const std::vector<ManifestEntry>& known,
    const std::set<std::string>& clips);

/// Removes entries with an output file that another entry wrote later, and warns of them.
/// @param path  manifest of the whole batch.
void remove_replaced_entries(std::vector<ManifestEntry>& entries, const std::string& path,
                             Observer& observer);

}  // namespace retarget
