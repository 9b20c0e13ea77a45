#pragma once

#include <optional>
#include <string>
#include <vector>

#include "batch/batch_runner.h"
#include "batch/manifest.h"
#include "batch/process_pool.h"
#include "retarget/batch.h"
#include "retarget/error.h"
#include "retarget/run.h"

namespace retarget {

/// Solves the clips of a batch in worker processes, and records their results in the batch process.
class BatchWorker {
 public:
  /// @param threads  threads per clip
  BatchWorker(const BatchContext& context, const BatchRequest& request, int threads)
      : context_(context), request_(request), threads_(threads) {}

  /// Called in a worker. Returns the answer about the clip; empty if it was interrupted.
  [[nodiscard]] std::string work(const BatchTask& task, double memory_gb) const;
  /// Called in the batch process.
  void take(const BatchTask& task, const TaskEnd& end);
  [[nodiscard]] bool keep_going();
  [[nodiscard]] Result<void> result();

 private:
  [[nodiscard]] ManifestEntry entry_of(const BatchTask& task) const;
  Result<void> solve(const BatchTask& task, double memory_gb, ManifestEntry& entry) const;
  Result<void> run(const BatchTask& task, double memory_gb, const std::string& output,
                   ManifestEntry& entry) const;
  Result<void> certify(const BatchTask& task, const Run& run, const RunOutcome& outcome,
                       ManifestEntry& entry, std::vector<std::string>& files) const;
  void remove_outputs(const BatchTask& task, const std::vector<MissingFile>& only = {}) const;
  [[nodiscard]] std::optional<ManifestEntry> done_already(const BatchTask& task) const;
  [[nodiscard]] ManifestEntry entry_of_ended(const BatchTask& task, const TaskEnd& end) const;

  const BatchContext& context_;
  const BatchRequest& request_;
  const int threads_;
  std::optional<Error> fatal_;
};

}  // namespace retarget
