#pragma once

#include <string>

#include "retarget/error.h"

namespace retarget {

/// Excludes other batches from an output folder during its lifetime.
///
/// It is a system lock on a file in the folder, which the system releases when the process ends in
/// any way. A killed run therefore never blocks the next one.
class FolderLock {
 public:
  /// Compatible lock holders.
  enum class Kind {
    kAlone,   ///< None.
    kShared,  ///< Other kShared locks: the shards of one batch.
  };

  /// Takes the lock.
  /// @param folder  must exist.
  /// @param name    of the lock file in the folder.
  /// Errors (kRun): another process has the lock (the message names it); the folder is not
  /// writable.
  [[nodiscard]] static Result<FolderLock> take(const std::string& folder, const std::string& name,
                                               Kind kind);
  ~FolderLock();
  FolderLock(FolderLock&& other) noexcept;
  FolderLock& operator=(FolderLock&& other) noexcept;
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

  /// False if the file system does not support locks; nothing then excludes a second batch.
  [[nodiscard]] bool is_held() const { return held_; }

 private:
  FolderLock() = default;
  void release();

  std::string path_;
  int descriptor_ = -1;
  bool held_ = false;
};

}  // namespace retarget
