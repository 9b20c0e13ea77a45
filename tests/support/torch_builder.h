#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "support/npz_builder.h"

namespace retarget {

/// Builds files as torch.save does, and malformed ones. A value is a piece of a pickle of protocol
/// 2 that creates one value.
class TorchBuilder {
 public:
  struct View {
    std::vector<std::int64_t> shape;
    std::int64_t offset = 0;
    std::vector<std::int64_t> strides;  ///< Empty: strides of C order.
  };

  static std::string text(const std::string& value) {
    return "X" + little_endian_bytes(value.size(), 4) + value;
  }
  static std::string integer(std::int64_t value) {
    return "\x8a\x08" + little_endian_bytes(static_cast<std::uint64_t>(value), 8);
  }
  static std::string tuple(const std::vector<std::string>& items) {
    std::string made = "(";
    for (const std::string& item : items) made += item;
    return made + "t";
  }
  static std::string dictionary(const std::vector<std::pair<std::string, std::string>>& members) {
    std::string made = "}(";
    for (const auto& [name, value] : members) made += text(name) + value;
    return made + "u";
  }
  static std::string global(const std::string& module, const std::string& name) {
    return "c" + module + "\n" + name + "\n";
  }
  static std::string call(const std::string& callee, const std::vector<std::string>& arguments) {
    return callee + tuple(arguments) + "R";
  }

  /// Adds a storage of a class such as `FloatStorage`. @param count  stated number of elements
  std::string storage(const std::string& type, const std::string& bytes, std::int64_t count) {
    const std::string key = std::to_string(storages_.size());
    storages_.push_back(bytes);
    return tuple({text("storage"), global("torch", type), text(key), text("cpu"), integer(count)}) +
           "Q";
  }

  static std::string rebuilt(const std::string& storage, const View& view) {
    std::vector<std::string> shape, strides;
    std::vector<std::int64_t> steps = view.strides;
    if (steps.empty()) {
      std::int64_t step = 1;
      for (auto size = view.shape.rbegin(); size != view.shape.rend(); ++size) {
        steps.insert(steps.begin(), step);
        step *= *size;
      }
    }
    for (const std::int64_t size : view.shape) shape.push_back(integer(size));
    for (const std::int64_t step : steps) strides.push_back(integer(step));
    return call(global("torch._utils", "_rebuild_tensor_v2"),
                {storage, integer(view.offset), tuple(shape), tuple(strides), "\x89",
                 global("collections", "OrderedDict") + ")R"});
  }

  /// Returns a float tensor in C order.
  std::string floats(const std::vector<std::int64_t>& shape, const std::vector<float>& values) {
    return rebuilt(
        storage("FloatStorage", element_bytes(values), static_cast<std::int64_t>(values.size())),
        {shape, 0, {}});
  }
  std::string doubles(const std::vector<std::int64_t>& shape, const std::vector<double>& values) {
    return rebuilt(
        storage("DoubleStorage", element_bytes(values), static_cast<std::int64_t>(values.size())),
        {shape, 0, {}});
  }

  /// Omits a storage from the file.
  void forget(std::size_t storage) { forgotten_ = storage; }
  /// Style of the storage entries.
  NpzBuilder::Style style;
  std::string byte_order = "little";

  /// Returns the whole file.
  [[nodiscard]] std::string build(const std::string& root) const {
    NpzBuilder archive;
    archive.add_entry("walk/data.pkl", "\x80\x02" + root + ".", {});
    archive.add_entry("walk/byteorder", byte_order, {});
    for (std::size_t i = 0; i < storages_.size(); ++i) {
      if (i != forgotten_) {
        archive.add_entry("walk/data/" + std::to_string(i), storages_[i], style);
      }
    }
    archive.add_entry("walk/version", "3\n", {});
    return archive.build();
  }

 private:
  std::vector<std::string> storages_;
  std::size_t forgotten_ = ~std::size_t{0};
};

}  // namespace retarget
