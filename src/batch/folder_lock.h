#pragma once

#include <string>

#include "retarget/error.h"

namespace retarget {

/// Keeps a second batch out of an output folder while one of these lives.
///
/// The lock is the system's, on a file of the folder, and ends with the process however it ends: a
/// killed run leaves nothing that stands in the way of the next.
class FolderLock {
 public:
  /// Who may be there at the same time.
  enum class Kind {
    kAlone,   ///< Nobody.
    kShared,  ///< Others with kShared: the shards of one batch.
  };

  /// @param folder  exists.
  /// @param name    of the lock file in the folder.
  /// Errors (kRun): another process has the lock, which the message names; a folder that cannot be
  /// written.
  [[nodiscard]] static Result<FolderLock> take(const std::string& folder, const std::string& name,
                                               Kind kind);
  ~FolderLock();
  FolderLock(FolderLock&& other) noexcept;
  FolderLock& operator=(FolderLock&& other) noexcept;
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

  /// False where the file system knows no locks: then nothing keeps a second batch out.
  [[nodiscard]] bool is_held() const { return held_; }

 private:
  FolderLock() = default;
  void release();

  std::string path_;
  int descriptor_ = -1;
  bool held_ = false;
};

}  // namespace retarget
