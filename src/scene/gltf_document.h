#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/file.h"
#include "retarget/error.h"

namespace retarget {

using GltfJson = nlohmann::ordered_json;

/// A member of an object; null: there is none, or it is no object.
[[nodiscard]] const GltfJson* gltf_member(const GltfJson& object, const char* key);

/// A glTF 2.0 file: its JSON and the numbers that it refers to. Khronos, "glTF 2.0 Specification", 2021.
///
/// Buffers are the file's own (GLB), in it as text (`data:`), or files beside it: a relative name that leads
/// nowhere outside of the file's folder. They are read when numbers of them are asked for, so that
/// textures are not.
class GltfDocument {
 public:
  /// @param bytes      the whole file, GLB or JSON; must outlive the document.
  /// @param max_bytes  of all files beside it and all numbers together.
  [[nodiscard]] static Result<GltfDocument> open(std::string_view bytes,
                                                 const std::string& file_name,
                                                 std::size_t max_bytes);

  [[nodiscard]] const GltfJson& json() const { return json_; }
  [[nodiscard]] const std::string& file_name() const { return file_name_; }

  /// A list of the document, such as `nodes`; an empty one where there is none.
  [[nodiscard]] const GltfJson& list(const char* name) const;
  /// An element of a list; null: there is none of this number, or it is no object.
  [[nodiscard]] const GltfJson* element(const char* list, const GltfJson& number) const;

  /// All numbers of an accessor, one element after the other; whole numbers that are marked so are
  /// scaled to -1 ... 1.
  /// @param width  the numbers of an element that are expected; another is an error.
  /// Errors (kInput): what leads outside of a buffer, numbers that are not finite, compressed buffers.
  [[nodiscard]] Result<std::vector<double>> numbers(const GltfJson& accessor, int width);

  /// An error of this file.
  [[nodiscard]] Failure fault(std::string what, std::string hint = {}) const;

 private:
  // a run of elements in a buffer
  struct Run {
    std::string_view bytes;
    std::size_t stride = 0;
  };

  GltfDocument() = default;
  Result<void> split(std::string_view bytes);
  Result<std::string_view> buffer(const GltfJson& number);
  Result<std::shared_ptr<const std::string>> read_buffer(const GltfJson& buffer);
  // counts bytes that are kept; an error where they are too many
  Result<void> take_bytes(std::size_t bytes);
  Result<std::string_view> buffer_view(const GltfJson& number, std::size_t& stride);
  Result<Run> run_of(const GltfJson& view, const GltfJson& place, std::size_t count,
                     std::size_t element_bytes);
  Result<void> replace_sparse(const GltfJson& sparse, const GltfJson& accessor, int width,
                              std::vector<double>& numbers);

  std::string file_name_;
  GltfJson json_;
  std::optional<std::string_view> binary_;                   // of a GLB
  std::vector<std::shared_ptr<const std::string>> buffers_;  // read so far; null: not yet
  // files beside it, by where they are: many buffers may name one
  std::map<std::string, std::shared_ptr<const std::string>> files_;
  std::size_t max_bytes_ = 0;
  std::size_t taken_ = 0;      // bytes of numbers that were read
  std::size_t available_ = 0;  // of buffers that were read
  std::size_t kept_ = 0;       // of both
};

}  // namespace retarget
