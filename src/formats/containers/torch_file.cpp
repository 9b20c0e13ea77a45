#include "formats/containers/torch_file.h"

#include <fmt/format.h>
#include <map>
#include <utility>

#include "base/try.h"
#include "formats/containers/pickle_reader.h"
#include "formats/containers/zip_writer.h"
#include "retarget/bytes.h"
#include "retarget/text.h"
#include "retarget/zip.h"

namespace retarget {
namespace {

using namespace std::string_view_literals;

constexpr std::string_view kPickleName = "data.pkl";
constexpr std::string_view kBrainFloat = "bf16";

// Checks the first local header, so that truncated archives are recognised too.
bool first_entry_is_pickle(std::string_view bytes) {
  constexpr std::size_t kHeader = 30, kNameLength = 26;
  if (bytes.size() < kHeader) return false;
  const std::size_t length = little_endian(bytes, kNameLength, 2);
  return bytes.substr(kHeader, length).ends_with("/data.pkl");
}

// The top-level folder of all entries with its slash. Returns nothing when there is no pickle.
std::optional<std::string> folder_of(const ZipArchive& archive) {
  for (const ZipEntry& entry : archive.entries()) {
    const std::string_view name = entry.name;
    if (!name.ends_with(kPickleName)) continue;
    const std::string_view folder = name.substr(0, name.size() - kPickleName.size());
    if (folder.empty() || folder.find('/') == folder.size() - 1) return std::string(folder);
  }
  return std::nullopt;
}

// Copies the elements of a view in C order.
std::string dense_bytes(const std::string& storage, const PickleTensor& tensor,
                        std::size_t item_size, std::size_t count) {
  std::string dense;
  dense.reserve(count * item_size);
  std::vector<std::size_t> index(tensor.shape.size(), 0);
  std::size_t at = static_cast<std::size_t>(tensor.offset);
  for (std::size_t i = 0; i < count; ++i) {
    dense.append(storage, at * item_size, item_size);
    for (std::size_t axis = index.size(); axis-- > 0;) {
      at += tensor.strides[axis];
      if (++index[axis] < tensor.shape[axis]) break;
      at -= tensor.strides[axis] * tensor.shape[axis];
      index[axis] = 0;
    }
  }
  return dense;
}

// A bfloat16 is the upper half of a float32.
std::string floats_from_brain_floats(const std::string& halves, bool big_endian) {
  std::string floats;
  floats.reserve(2 * halves.size());
  for (std::size_t at = 0; at + 2 <= halves.size(); at += 2) {
    if (!big_endian) floats.append(2, '\0');
    floats.append(halves, at, 2);
    if (big_endian) floats.append(2, '\0');
  }
  return floats;
}

bool is_much(std::uint64_t bytes, std::uint64_t packed, const TorchReadOptions& options) {
  return bytes > options.free_bytes && bytes / options.max_ratio > packed;
}

std::string_view storage_name(const NpyArray& array) {
  if (array.kind == NpyKind::kBool) return "BoolStorage";
  if (array.kind == NpyKind::kSigned) return "LongStorage";
  return array.item_size == 4 ? "FloatStorage" : "DoubleStorage";
}

}  // namespace

struct TorchFile::Contents {
  std::string file_name;
  TorchReadOptions options;
  ZipArchive archive;
  std::string folder;
  std::map<std::string, std::size_t, std::less<>> index;  // Index in the archive, by name.
  bool big_endian = false;
  PickleDocument document;

  // Adds the file and, if given, the tensor to an error.
  [[nodiscard]] Failure complete(Error error, std::string_view tensor = {}) const {
    error.kind = ErrorKind::kInput;
    error.location.file = file_name;
    if (!tensor.empty()) error.message = fmt::format("tensor \"{}\": {}", tensor, error.message);
    return failure(std::move(error));
  }

  [[nodiscard]] Result<std::string> read_entry(std::size_t place) const {
    const ZipEntry& entry = archive.entries()[place];
    if (is_much(entry.size, entry.packed_size, options)) {
      return format_failure(
          fmt::format("its {} would be unpacked from {}", count_text(entry.size, "byte"),
                      entry.packed_size),
          "the compression ratio is implausible for a motion; torch.save does not compress");
    }
    TRY_ASSIGN(ZipEntryReader reader, archive.entry_reader(place));
    TRY_ASSIGN(std::string bytes, reader.read(static_cast<std::size_t>(entry.size)));
    TRY(reader.finish());
    return bytes;
  }

  [[nodiscard]] Result<void> read_directory() {
    const auto found = folder_of(archive);
    if (!found) {
      return format_failure("the archive has no data.pkl, which torch.save writes",
                            "the file was modified, or torch.save did not write it");
    }
    folder = *found;
    const std::vector<ZipEntry>& entries = archive.entries();
    for (std::size_t i = 0; i < entries.size(); ++i) {
      if (entries[i].name.starts_with(folder + "code/")) {
        return format_failure("expected a motion, found a TorchScript program",
                              "save a dictionary of tensors with torch.save");
      }
      if (!index.emplace(entries[i].name, i).second) {
        return format_failure(
            fmt::format("the archive has two entries \"{}\"", printable(entries[i].name)));
      }
    }
    const auto order = index.find(folder + "byteorder");
    if (order == index.end()) return {};
    TRY_ASSIGN(const auto word, read_entry(order->second));
    big_endian = word.starts_with("big");
    return {};
  }

  [[nodiscard]] Result<NpyArray> lay_out(const PickleTensor& tensor) const {
    const bool brain = tensor.type == kBrainFloat;
    NpyHeader header;
    header.type = (big_endian ? ">" : "<") + std::string(brain ? "f4" : tensor.type);
    header.shape = tensor.shape;
    TRY_ASSIGN(auto layout, npy_layout(header));
    const std::size_t item_size = brain ? 2 : layout.array.item_size;
    const std::size_t count = layout.data_size / layout.array.item_size;
    const auto place = index.find(fmt::format("{}data/{}", folder, tensor.storage));
    if (place == index.end()) {
      return format_failure(
          fmt::format("its storage \"data/{}\" is not in the archive", printable(tensor.storage)));
    }
    const ZipEntry& entry = archive.entries()[place->second];
    if (entry.size % item_size != 0 || entry.size / item_size != tensor.storage_count) {
      return format_failure(fmt::format("its storage should have {} numbers of {}, found {}",
                                        tensor.storage_count, count_text(item_size, "byte"),
                                        count_text(entry.size, "byte")));
    }
    const std::size_t max = options.max_number_bytes / sizeof(double);
    if (count > max || is_much(count * sizeof(double), entry.packed_size, options)) {
      return format_failure(fmt::format("its {} numbers need {} of memory, but its storage has {}",
                                        count, count_text(count * sizeof(double), "byte"),
                                        count_text(entry.packed_size, "byte")),
                            "too many for a motion; otherwise allow more memory");
    }
    TRY_ASSIGN(const auto storage, read_entry(place->second));
    std::string data = dense_bytes(storage, tensor, item_size, count);
    if (brain) data = floats_from_brain_floats(data, big_endian);
    return npy_with_data(std::move(layout), std::move(data), false);
  }
};

TorchFile::TorchFile(std::shared_ptr<const Contents> contents) : contents_(std::move(contents)) {}

const PickleDocument& TorchFile::document() const {
  return contents_->document;
}

Result<TorchFile> TorchFile::open(std::string_view bytes, std::string file_name,
                                  const TorchReadOptions& options) {
  auto contents = std::make_shared<Contents>();
  contents->file_name = std::move(file_name);
  contents->options = options;
  Result<ZipArchive> archive = ZipArchive::open(bytes);
  if (!archive) {
    Error error = std::move(archive.error());
    if (!error.hint.empty()) error.hint = "the file was cut off: download or copy it again";
    return contents->complete(std::move(error));
  }
  contents->archive = std::move(*archive);
  const Result<void> directory = contents->read_directory();
  if (!directory) return contents->complete(directory.error());
  Result<std::string> pickle = contents->read_entry(
      contents->index.find(contents->folder + std::string(kPickleName))->second);
  if (!pickle) return contents->complete(pickle.error(), kPickleName);
  TRY_ASSIGN(contents->document, read_torch_pickle(std::move(*pickle), contents->file_name));
  return TorchFile(std::move(contents));
}

Result<NpyArray> TorchFile::read(const PickleNode& node, std::string_view what) const {
  Result<NpyArray> array = contents_->lay_out(contents_->document.tensor(node));
  if (!array) return contents_->complete(array.error(), what);
  return array;
}

bool is_torch_file(std::string_view bytes) {
  if (!bytes.starts_with("PK\x03\x04")) return false;
  if (first_entry_is_pickle(bytes)) return true;
  const auto archive = ZipArchive::open(bytes);
  return archive && folder_of(*archive).has_value();
}

bool is_old_torch_file(std::string_view bytes) {
  // Each of these files begins with a pickled magic number.
  return bytes.starts_with("\x80\x02\x8a\x0a\x6c\xfc\x9c\x46\xf9\x20\x6a\xa8\x50\x19."sv);
}

TorchWriter::TorchWriter() {
  append_opcode(pickle_, PickleOp::kProto);
  pickle_ += '\x02';
  append_opcode(pickle_, PickleOp::kEmptyDict);
  append_opcode(pickle_, PickleOp::kMark);
}

void TorchWriter::text(std::string_view value) {
  const std::string utf8 = valid_utf8(value);
  append_opcode(pickle_, PickleOp::kBinUnicode);
  append_little_endian(pickle_, utf8.size(), 4);
  pickle_ += utf8;
}

void TorchWriter::tuple_of(const std::vector<std::size_t>& sizes) {
  append_opcode(pickle_, PickleOp::kMark);
  for (const std::size_t size : sizes) append_integer(pickle_, static_cast<std::int64_t>(size));
  append_opcode(pickle_, PickleOp::kTuple);
}

void TorchWriter::global(std::string_view module, std::string_view name) {
  append_opcode(pickle_, PickleOp::kGlobal);
  pickle_ += module;
  pickle_ += '\n';
  pickle_ += name;
  pickle_ += '\n';
}

void TorchWriter::integer(std::string_view key, std::int64_t value) {
  text(key);
  append_integer(pickle_, value);
}

void TorchWriter::number(std::string_view key, double value) {
  text(key);
  append_number(pickle_, value);
}

void TorchWriter::tensor(std::string_view key, const NpyArray& array) {
  text(key);
  global("torch._utils", "_rebuild_tensor_v2");
  append_opcode(pickle_, PickleOp::kMark);
  // The storage: ('storage', class, key, device, element count).
  append_opcode(pickle_, PickleOp::kMark);
  text("storage");
  global("torch", storage_name(array));
  text(std::to_string(storages_.size()));
  text("cpu");
  append_integer(pickle_, static_cast<std::int64_t>(array.element_count()));
  append_opcode(pickle_, PickleOp::kTuple);
  append_opcode(pickle_, PickleOp::kBinPersId);
  append_integer(pickle_, 0);  // Offset.
  tuple_of(array.shape);
  std::vector<std::size_t> strides(array.shape.size(), 1);
  for (std::size_t i = strides.size(); i-- > 1;) strides[i - 1] = strides[i] * array.shape[i];
  tuple_of(strides);
  append_opcode(pickle_, PickleOp::kNewFalse);  // requires_grad
  global("collections", "OrderedDict");
  append_opcode(pickle_, PickleOp::kEmptyTuple);
  append_opcode(pickle_, PickleOp::kReduce);
  append_opcode(pickle_, PickleOp::kTuple);
  append_opcode(pickle_, PickleOp::kReduce);
  storages_.push_back(array.data);
}

void TorchWriter::enum_member(std::string_view key, std::string_view module, std::string_view name,
                              std::string_view value) {
  text(key);
  global(module, name);
  text(value);
  append_opcode(pickle_, PickleOp::kTuple1);
  append_opcode(pickle_, PickleOp::kReduce);
}

Result<std::string> TorchWriter::finish(std::string_view folder) {
  append_opcode(pickle_, PickleOp::kSetItems);
  append_opcode(pickle_, PickleOp::kStop);
  const std::string place = std::string(folder) + "/";
  ZipWriter zip;
  zip.add(place + "data.pkl", pickle_);
  zip.add(place + "byteorder", "little");
  for (std::size_t i = 0; i < storages_.size(); ++i) {
    zip.add(place + "data/" + std::to_string(i), storages_[i]);
    storages_[i] = {};
  }
  zip.add(place + "version", "3\n");
  return zip.finish();
}

}  // namespace retarget
