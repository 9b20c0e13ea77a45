#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "formats/containers/npy.h"
#include "formats/containers/npz.h"
#include "formats/containers/pickle.h"
#include "formats/containers/torch_file.h"
#include "retarget/error.h"

namespace retarget {

/// Named arrays from any kind of file. Errors name the file and, if applicable, the array.
class ArraySource {
 public:
  ArraySource() = default;
  ArraySource(const ArraySource&) = delete;
  ArraySource& operator=(const ArraySource&) = delete;
  virtual ~ArraySource() = default;

  [[nodiscard]] virtual std::vector<std::string> names() const = 0;
  [[nodiscard]] virtual bool has(std::string_view name) const = 0;
  /// NumPy's type string of an array; contains `O` for types that `read` rejects.
  [[nodiscard]] virtual Result<std::string> type_of(std::string_view name) const = 0;
  [[nodiscard]] virtual Result<NpyArray> read(std::string_view name) const = 0;

  /// Errors about an array or the file, for callers that reject the content.
  [[nodiscard]] Failure array_failure(std::string_view name, std::string message,
                                      std::string hint = {}) const {
    return fault(name, std::move(message), std::move(hint));
  }
  [[nodiscard]] Failure file_failure(std::string message, std::string hint = {}) const {
    return fault({}, std::move(message), std::move(hint));
  }

 private:
  /// @param array  empty: the error concerns the file.
  [[nodiscard]] virtual Failure fault(std::string_view array, std::string message,
                                      std::string hint) const = 0;
};

/// The arrays of an NPZ file.
class NpzArrays : public ArraySource {
 public:
  explicit NpzArrays(NpzFile file) : file_(std::move(file)) {}

  [[nodiscard]] std::vector<std::string> names() const override { return file_.names(); }
  [[nodiscard]] bool has(std::string_view name) const override { return file_.has(name); }
  [[nodiscard]] Result<std::string> type_of(std::string_view name) const override {
    return file_.type_of(name);
  }
  [[nodiscard]] Result<NpyArray> read(std::string_view name) const override {
    return file_.read(name);
  }

 private:
  [[nodiscard]] Failure fault(std::string_view array, std::string message,
                              std::string hint) const override {
    return array.empty() ? file_.file_failure(std::move(message), std::move(hint))
                         : file_.array_failure(array, message, std::move(hint));
  }
  NpzFile file_;
};

/// Base class that builds the error messages of a file.
class FileArrays : public ArraySource {
 public:
  explicit FileArrays(std::string file_name) : file_name_(std::move(file_name)) {}

  [[nodiscard]] Result<std::string> type_of(std::string_view name) const override;

 protected:
  [[nodiscard]] Failure no_such_array(std::string_view name) const;

 private:
  [[nodiscard]] Failure fault(std::string_view array, std::string message,
                              std::string hint) const override;
  std::string file_name_;
};

/// Arrays in memory, converted from another form in the file.
class MadeArrays : public FileArrays {
 public:
  using FileArrays::FileArrays;
  void add(std::string name, NpyArray array) { arrays_[std::move(name)] = std::move(array); }

  [[nodiscard]] std::vector<std::string> names() const override;
  [[nodiscard]] bool has(std::string_view name) const override { return arrays_.contains(name); }
  [[nodiscard]] Result<NpyArray> read(std::string_view name) const override;

 private:
  std::map<std::string, NpyArray, std::less<>> arrays_;
};

/// Members of a dictionary in a pickle or a PyTorch file: arrays, tensors, and numbers, strings and
/// lists of numbers that NumPy would convert to arrays.
class DictionaryArrays : public FileArrays {
 public:
  /// @param dictionary  belongs to the document, which this object keeps.
  DictionaryArrays(std::string file_name, PickleDocument document, const PickleNode& dictionary)
      : FileArrays(std::move(file_name)), own_(std::move(document)), dictionary_(dictionary) {}
  DictionaryArrays(std::string file_name, TorchFile torch, const PickleNode& dictionary)
      : FileArrays(std::move(file_name)), torch_(std::move(torch)), dictionary_(dictionary) {}

  [[nodiscard]] std::vector<std::string> names() const override;
  [[nodiscard]] bool has(std::string_view name) const override;
  [[nodiscard]] Result<std::string> type_of(std::string_view name) const override;
  [[nodiscard]] Result<NpyArray> read(std::string_view name) const override;

 private:
  [[nodiscard]] const PickleDocument& document() const {
    return torch_ ? torch_->document() : own_;
  }

  PickleDocument own_;
  std::optional<TorchFile> torch_;
  const PickleNode& dictionary_;  // Belongs to the document, whose nodes never move.
};

}  // namespace retarget
