#include "retarget/concatenate_npz.h"

#include <fmt/format.h>
#include <algorithm>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "formats/containers/npz.h"
#include "retarget/file.h"
#include "retarget/text.h"
#include "retarget/try.h"

namespace retarget {
namespace {

constexpr const char* kUnlikeHint =
    "a packed file contains clips of one robot, format and rate; use separate folders for others";

struct NpzPart {
  std::string name, path;
  std::int64_t frames = 0;
};

struct PackedArray {
  std::string name;
  bool along_time = false;
  NpyArray array;        // Has elements only if they are equal in all parts.
  ZipChecksum elements;  // Of all parts, if the array is concatenated.
};

}  // namespace

class NpzConcatenation::Impl {
 public:
  Result<void> add(NpzPart part) {
    RETARGET_TRY_ASSIGN(const FileContent content, read_file(part.path));
    RETARGET_TRY_ASSIGN(const NpzFile npz, NpzFile::open(content.view(), part.path));
    if (arrays_.empty()) RETARGET_TRY(begin_arrays(npz));
    RETARGET_TRY(add_arrays(npz, part));
    parts_.push_back(std::move(part));
    return {};
  }

  Result<void> write(const std::string& path, const BeforePart& before) const {
    RETARGET_TRY_ASSIGN(OutputFile file, OutputFile::create(path));
    NpzStream npz([&file](std::string_view bytes) { return file.write(bytes); });
    for (const PackedArray& packed : arrays_) {
      if (packed.along_time) {
        RETARGET_TRY(in_file(write_parts(packed, npz, before), path));
      } else {
        RETARGET_TRY(npz.add(packed.name, packed.array));
      }
    }
    RETARGET_TRY(write_table(npz));
    RETARGET_TRY(npz.finish());
    return file.commit();
  }

  [[nodiscard]] std::int64_t frame_count() const { return frames_; }

 private:
  // Takes the arrays of the first part as the reference.
  Result<void> begin_arrays(const NpzFile& npz) {
    for (const std::string& name : npz.names()) {
      RETARGET_TRY_ASSIGN(NpyArray array, npz.read(name));
      PackedArray packed;
      packed.name = name;
      packed.along_time = array.is_number() && array.shape.size() > 1;
      if (packed.along_time) {
        array.data.clear();
        array.shape.front() = 0;
      }
      packed.array = std::move(array);
      arrays_.push_back(std::move(packed));
    }
    return {};
  }

  Result<void> add_arrays(const NpzFile& npz, NpzPart& part) {
    const std::string& first = parts_.empty() ? part.path : parts_.front().path;
    const bool same_names = std::ranges::equal(npz.names(), arrays_, {}, {}, &PackedArray::name);
    if (!same_names) {
      return npz.file_failure(
          fmt::format("its arrays differ from those of {}: {}", first, list_names(npz.names(), 12)),
          kUnlikeHint);
    }
    std::optional<std::size_t> frames;
    for (PackedArray& packed : arrays_) {
      RETARGET_TRY_ASSIGN(const NpyArray array, npz.read(packed.name));
      if (!is_like(array, packed)) {
        return npz.array_failure(
            packed.name,
            fmt::format("it differs from {}{}", first, difference(array, packed.array)),
            kUnlikeHint);
      }
      if (!packed.along_time) continue;
      if (frames.value_or(array.shape.front()) != array.shape.front()) {
        return npz.array_failure(packed.name, "its number of frames differs from the other arrays");
      }
      frames = array.shape.front();
      packed.array.shape.front() += *frames;
      packed.elements.add(array.data);
    }
    part.frames = static_cast<std::int64_t>(frames.value_or(0));
    frames_ += part.frames;
    return {};
  }

  static bool is_like(const NpyArray& array, const PackedArray& packed) {
    if (array.kind != packed.array.kind || array.item_size != packed.array.item_size) return false;
    if (!packed.along_time) {
      return array.shape == packed.array.shape && array.data == packed.array.data;
    }
    return array.shape.size() == packed.array.shape.size() &&
           std::equal(array.shape.begin() + 1, array.shape.end(), packed.array.shape.begin() + 1);
  }

  // Describes the difference of two arrays with one number, such as rates.
  static std::string difference(const NpyArray& array, const NpyArray& first) {
    const auto is_one = [](const NpyArray& one) {
      return one.is_number() && one.element_count() == 1 && !one.data.empty();
    };
    if (!is_one(array) || !is_one(first)) return {};
    return fmt::format(": {}, and {} there", number_text(array.numbers().front(), 3),
                       number_text(first.numbers().front(), 3));
  }

  Result<void> write_parts(const PackedArray& packed, NpzStream& npz,
                           const BeforePart& before) const {
    RETARGET_TRY(npz.begin(packed.name, packed.array, packed.elements));
    for (const NpzPart& part : parts_) {
      RETARGET_TRY(before(packed.name, part.name));
      RETARGET_TRY_ASSIGN(const FileContent content, read_file(part.path));
      RETARGET_TRY_ASSIGN(const NpzFile one, NpzFile::open(content.view(), part.path));
      RETARGET_TRY_ASSIGN(const NpyArray array, one.read(packed.name));
      RETARGET_TRY(npz.write(array.data));
    }
    return npz.end();
  }

  Result<void> write_table(NpzStream& npz) const {
    std::vector<std::string> names;
    std::vector<std::int64_t> starts, lengths;
    std::int64_t start = 0;
    for (const NpzPart& part : parts_) {
      names.push_back(part.name);
      starts.push_back(start);
      lengths.push_back(part.frames);
      start += part.frames;
    }
    RETARGET_TRY(npz.add("clip_names", text_array(names)));
    RETARGET_TRY(npz.add("clip_starts", int64_array(starts, {starts.size()})));
    return npz.add("clip_lengths", int64_array(lengths, {lengths.size()}));
  }

  static Result<void> in_file(Result<void> result, const std::string& path) {
    if (result || !result.error().location.file.empty()) return result;
    if (result.error().kind == ErrorKind::kRun) result.error().location.file = path;
    return result;
  }

  std::vector<NpzPart> parts_;
  std::vector<PackedArray> arrays_;
  std::int64_t frames_ = 0;
};

NpzConcatenation::NpzConcatenation() : impl_(std::make_unique<Impl>()) {}
NpzConcatenation::~NpzConcatenation() = default;
NpzConcatenation::NpzConcatenation(NpzConcatenation&&) noexcept = default;
NpzConcatenation& NpzConcatenation::operator=(NpzConcatenation&&) noexcept = default;

Result<void> NpzConcatenation::add(std::string name, std::string path) {
  return impl_->add({std::move(name), std::move(path)});
}
Result<void> NpzConcatenation::write(const std::string& path, const BeforePart& before) const {
  return impl_->write(path, before);
}
std::int64_t NpzConcatenation::frame_count() const {
  return impl_->frame_count();
}

}  // namespace retarget
