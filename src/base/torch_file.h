#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <string>
#include <string_view>

#include "base/npy.h"
#include "base/pickle.h"
#include "retarget/error.h"

namespace retarget {

struct TorchReadOptions {
  /// Of the numbers of a tensor as doubles, which they become: more are refused.
  std::size_t max_number_bytes = std::numeric_limits<std::size_t>::max();
  /// A tensor may have so many times the bytes of its storage, as a view that repeats it does.
  std::size_t max_ratio = 64;
  /// What is let pass in any case, of a tensor and of an entry that is unpacked.
  std::size_t free_bytes = std::size_t{8} << 20;
};

/// What torch.save wrote: a ZIP archive with a pickle, `NAME/data.pkl`, and the storages of its
/// tensors, `NAME/data/KEY`, as raw numbers. Nothing in it is ever executed; see read_torch_pickle.
///
/// Tensors are laid out when they are asked for, so a file that is something else costs no more
/// than its pickle. Memory follows the bytes that are there and not what pickle or directory claim.
class TorchFile {
 public:
  /// Reads the pickle. Errors: no ZIP archive, a damaged or cut off one, a program of TorchScript,
  /// read_torch_pickle's.
  /// @param bytes      the whole file; must outlive the object.
  /// @param file_name  as the user named it, for messages.
  [[nodiscard]] static Result<TorchFile> open(std::string_view bytes, std::string file_name,
                                              const TorchReadOptions& options = {});

  [[nodiscard]] const PickleDocument& document() const;

  /// A tensor's numbers; bfloat16 as float. Errors (`what` names the tensor in them): a storage that
  /// is not there, is damaged or has another size than the pickle claims, too many numbers.
  /// @pre node.kind is kTensor, of document()
  [[nodiscard]] Result<NpyArray> read(const PickleNode& node, std::string_view what) const;

 private:
  struct Contents;
  explicit TorchFile(std::shared_ptr<const Contents> contents);
  std::shared_ptr<const Contents> contents_;
};

/// Whether bytes are an archive that torch.save wrote, also one that was cut off.
[[nodiscard]] bool is_torch_file(std::string_view bytes);

/// Whether bytes are what torch.save wrote before PyTorch 1.6: pickles one after the other, without an
/// archive. These are not read.
[[nodiscard]] bool is_old_torch_file(std::string_view bytes);

}  // namespace retarget
