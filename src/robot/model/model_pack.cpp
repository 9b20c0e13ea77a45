#include "robot/model/model_pack.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "base/try.h"
#include "retarget/bytes.h"
#include "retarget/load_robot.h"
#include "retarget/model_pack.h"

namespace retarget {
namespace {

constexpr std::string_view kMagic = "RETARGET-MODELS";
constexpr std::uint32_t kPackVersion = 1;

class PackWriter {
 public:
  void number(std::uint64_t value, int size) { append_little_endian(bytes_, value, size); }
  void text(std::string_view text) {
    number(text.size(), 4);
    bytes_ += text;
  }
  void real(double value) { number(std::bit_cast<std::uint64_t>(value), 8); }

  template <typename T>
  void array(const std::vector<T>& values) {
    for (const T value : values) {
      if constexpr (std::is_same_v<T, double>) {
        real(value);
      } else if constexpr (std::is_same_v<T, int>) {
        number(static_cast<std::uint32_t>(value), 4);
      } else {
        bytes_ += value;
      }
    }
  }
  void texts(const std::vector<std::string>& all) {
    number(all.size(), 4);
    for (const std::string& each : all) text(each);
  }
  [[nodiscard]] std::string take() && { return std::move(bytes_); }

 private:
  std::string bytes_;
};

// Reads what PackWriter writes. After a failed read everything is empty; check ok() before use.
class PackReader {
 public:
  explicit PackReader(std::string_view bytes) : reader_(bytes) {}

  [[nodiscard]] bool ok() const { return reader_.ok(); }
  [[nodiscard]] std::size_t left() const { return reader_.left(); }
  // A number of items that each take at least `size` bytes.
  std::size_t count(std::size_t size) {
    const auto count = reader_.number<std::uint32_t>();
    if (reader_.may_hold(count, size)) return count;
    reader_.bytes(reader_.left() + 1);  // clears ok()
    return 0;
  }
  std::uint32_t word() { return reader_.number<std::uint32_t>(); }
  double real() { return reader_.number<double>(); }
  std::string text() { return std::string(reader_.bytes(count(1))); }
  std::vector<std::string> texts() {
    std::vector<std::string> all(count(4));
    for (std::string& each : all) each = text();
    return all;
  }
  template <typename T>
  void array(std::vector<T>& values, std::size_t size) {
    if (!reader_.may_hold(size, sizeof(T))) {
      reader_.bytes(reader_.left() + 1);
      return;
    }
    values.resize(size);
    for (T& value : values) value = reader_.number<T>();
  }

 private:
  ByteReader<std::endian::little> reader_;
};

void write_loaded(const LoadedModel& loaded, PackWriter& out) {
  out.texts(loaded.warnings);
  out.text(loaded.floated_body);
  out.texts(loaded.sliding);
  out.texts(loaded.held);
  out.number(loaded.tied.size(), 4);
  for (const TiedBodies& tied : loaded.tied) {
    out.text(tied.first);
    out.text(tied.second);
  }
  out.number(loaded.couplings.size(), 4);
  for (const auto& [name, coupling] : loaded.couplings) {
    out.text(name);
    out.text(coupling.leader);
    out.real(coupling.ratio);
    out.real(coupling.offset);
  }
  out.number(loaded.excluded.size(), 4);
  for (const auto& [first, second] : loaded.excluded) {
    out.text(first);
    out.text(second);
  }
  out.texts(loaded.dropped);
}

LoadedModel read_loaded(PackReader& in) {
  LoadedModel loaded;
  loaded.warnings = in.texts();
  loaded.floated_body = in.text();
  loaded.sliding = in.texts();
  loaded.held = in.texts();
  loaded.tied.resize(in.count(8));
  for (TiedBodies& tied : loaded.tied) {
    tied.first = in.text();
    tied.second = in.text();
  }
  for (std::size_t left = in.count(24); left > 0 && in.ok(); --left) {
    const std::string name = in.text();
    JointCoupling& coupling = loaded.couplings[name];
    coupling.leader = in.text();
    coupling.ratio = in.real();
    coupling.offset = in.real();
  }
  loaded.excluded.resize(in.count(8));
  for (auto& [first, second] : loaded.excluded) {
    first = in.text();
    second = in.text();
  }
  loaded.dropped = in.texts();
  return loaded;
}

template <typename T>
bool all_finite(const std::vector<T>& values) {
  if constexpr (std::is_same_v<T, double>) {
    return std::ranges::all_of(values, [](double value) { return std::isfinite(value); });
  } else {
    return true;
  }
}

bool all_within(const std::vector<int>& values, std::int64_t min, std::int64_t end) {
  return std::ranges::all_of(values, [&](int value) { return value >= min && value < end; });
}

// Whether each range of elements [address, address + number) lies in an array of `size` elements.
bool ranges_fit(const std::vector<int>& addresses, const std::vector<int>& numbers,
                std::int64_t size) {
  for (std::size_t i = 0; i < addresses.size(); ++i) {
    const std::int64_t begin = addresses[i], number = numbers[i];
    if (number < 0 || (number > 0 && (begin < 0 || begin + number > size))) return false;
  }
  return true;
}

// Number of values in a configuration and a velocity for a joint type; nothing for an unknown type.
std::pair<int, int> joint_sizes(int type) {
  switch (type) {
    case mjJNT_FREE:
      return {7, 6};
    case mjJNT_BALL:
      return {4, 3};
    case mjJNT_SLIDE:
    case mjJNT_HINGE:
      return {1, 1};
    default:
      return {0, 0};
  }
}

// @return the first invalid array; null: all are valid.
const char* wrong_array(const PackedModel& model) {
#define RETARGET_FINITE(type, name, elements, numbers) \
  if (!all_finite(model.name)) return #name;
  RETARGET_PACKED_ARRAYS(RETARGET_FINITE)
#undef RETARGET_FINITE
  if (model.nbody < 1) return "bodies";
  for (int b = 0; b < model.nbody; ++b) {
    // The tree is built in this order.
    const int parent = model.body_parentid[static_cast<std::size_t>(b)];
    if (parent < 0 || parent >= std::max(b, 1)) return "body_parentid";
  }
  if (!all_within(model.body_rootid, 0, model.nbody)) return "body_rootid";
  if (!all_within(model.body_weldid, 0, model.nbody)) return "body_weldid";
  if (!ranges_fit(model.body_jntadr, model.body_jntnum, model.njnt)) return "body_jntadr";
  if (!ranges_fit(model.body_geomadr, model.body_geomnum, model.ngeom)) return "body_geomadr";
  if (!all_within(model.jnt_bodyid, 0, model.nbody)) return "jnt_bodyid";
  if (!all_within(model.geom_bodyid, 0, model.nbody)) return "geom_bodyid";
  std::int64_t position = 0, velocity = 0;
  for (std::size_t j = 0; j < model.jnt_type.size(); ++j) {
    const auto [positions, velocities] = joint_sizes(model.jnt_type[j]);
    const bool fits =
        positions > 0 && model.jnt_qposadr[j] == position && model.jnt_dofadr[j] == velocity;
    if (!fits) return "jnt_type";
    position += positions;
    velocity += velocities;
  }
  if (position != model.nq || velocity != model.nv) return "jnt_qposadr";
  if (model.names.empty() || model.names.back() != '\0') return "names";
  for (const auto* addresses : {&model.name_bodyadr, &model.name_jntadr, &model.name_geomadr}) {
    if (!all_within(*addresses, 0, model.nnames)) return "names";
  }
  return nullptr;
}

PackedModel read_model(PackReader& in) {
  PackedModel model;
  model.file = in.text();
  for (std::int64_t* size :
       {&model.nq, &model.nv, &model.nbody, &model.njnt, &model.ngeom, &model.nnames}) {
    *size = static_cast<std::int64_t>(in.count(1));
  }
#define RETARGET_READ(type, name, elements, numbers) \
  in.array(model.name, static_cast<std::size_t>(model.elements) * (numbers));
  RETARGET_PACKED_ARRAYS(RETARGET_READ)
#undef RETARGET_READ
  model.loaded = read_loaded(in);
  return model;
}

// Copies the parts of a loaded model that a pack needs.
PackedModel packed_model(std::string file, const LoadedModel& loaded) {
  const mjModel& from = *loaded.model;
  PackedModel model;
  model.file = std::move(file);
  model.nq = from.nq;
  model.nv = from.nv;
  model.nbody = from.nbody;
  model.njnt = from.njnt;
  model.ngeom = from.ngeom;
  model.nnames = from.nnames;
#define RETARGET_COPY(type, name, elements, numbers) \
  model.name.assign(from.name, from.name + from.elements * (numbers));
  RETARGET_PACKED_ARRAYS(RETARGET_COPY)
#undef RETARGET_COPY
  model.loaded.warnings = loaded.warnings;
  model.loaded.floated_body = loaded.floated_body;
  model.loaded.sliding = loaded.sliding;
  model.loaded.held = loaded.held;
  model.loaded.tied = loaded.tied;
  model.loaded.couplings = loaded.couplings;
  model.loaded.excluded = loaded.excluded;
  model.loaded.dropped = loaded.dropped;
  return model;
}

// Formats models as a pack. Equal models give equal bytes.
std::string format_model_pack(const std::vector<PackedModel>& models) {
  PackWriter out;
  out.text(kMagic);
  out.number(kPackVersion, 4);
  out.number(models.size(), 4);
  for (const PackedModel& model : models) {
    out.text(model.file);
    for (const std::int64_t size :
         {model.nq, model.nv, model.nbody, model.njnt, model.ngeom, model.nnames}) {
      out.number(static_cast<std::uint64_t>(size), 4);
    }
#define RETARGET_WRITE(type, name, elements, numbers) out.array(model.name);
    RETARGET_PACKED_ARRAYS(RETARGET_WRITE)
#undef RETARGET_WRITE
    write_loaded(model.loaded, out);
  }
  return std::move(out).take();
}

}  // namespace

Result<std::vector<PackedModel>> parse_model_pack(std::string_view bytes, const std::string& file) {
  const std::string hint = "make it again: retarget generate robot-pack";
  PackReader in(bytes);
  if (in.text() != kMagic) return config_failure(file, "the file is not a pack of models", hint);
  const std::uint32_t version = in.word();
  if (version != kPackVersion) {
    return config_failure(file,
                          "the pack has version " + std::to_string(version) + ", expected " +
                              std::to_string(kPackVersion),
                          hint);
  }
  std::vector<PackedModel> models;
  for (std::size_t left = in.count(1); left > 0 && in.ok(); --left) {
    models.push_back(read_model(in));
    if (!in.ok()) break;
    if (const char* wrong = wrong_array(models.back())) {
      return config_failure(file, "the pack is damaged: wrong values of " + std::string(wrong),
                            hint);
    }
  }
  if (!in.ok() || in.left() != 0) {
    return config_failure(file, "the pack is damaged: its sizes do not fit its length", hint);
  }
  return models;
}

Result<std::string> make_model_pack(const RobotFiles& files) {
  TRY_ASSIGN(const auto robot, load_robot_files(files.model.string(), files.profile.string()));
  std::vector<PackedModel> models;
  const auto add = [&](const std::filesystem::path& path, bool float_base) -> Result<void> {
    ModelChanges changes;
    changes.float_base = float_base;
    TRY_ASSIGN(const LoadedModel loaded, load_model(path.string(), changes));
    models.push_back(packed_model(path.filename().string(), loaded));
    return {};
  };
  TRY(add(files.model, robot->fixed_base()));
  for (const RobotVariant& variant : robot->profile().variants) {
    if (variant.model.empty()) continue;
    const std::filesystem::path path(variant.model);
    const bool has_it = std::ranges::any_of(
        models, [&](const PackedModel& model) { return model.file == path.filename(); });
    if (!has_it) TRY(add(path, false));
  }
  return format_model_pack(models);
}

}  // namespace retarget
