// Any bytes as one of the files that a stranger may have written. One target for each reader, chosen
// by RETARGET_FUZZED; tools/fuzz.sh runs them all. What is accepted must be sound, what is refused says
// why.

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/csv_table.h"
#include "retarget/base/file.h"
#include "retarget/base/npy.h"
#include "retarget/batch/manifest.h"
#include "retarget/edit/ground_path.h"
#include "retarget/human/bone_map_file.h"
#include "retarget/human/dialect.h"
#include "retarget/io/robot_motion.h"
#include "retarget/pipeline/ik_tables.h"
#include "retarget/refine/fit_options.h"
#include "retarget/robot/load_robot.h"
#include "robot/load_profile.h"
#include "robot/vet_model.h"
#include "support/temporary_folder.h"

namespace {

using retarget::Result;

void require(bool condition, const char* what) {
  if (condition) return;
  std::fprintf(stderr, "not true: %s\n", what);
  std::abort();
}

// whether it was read; if not, the error must say something
template <typename Value>
bool good(const Result<Value>& result) {
  if (!result) require(!result.error().message.empty(), "errors say something");
  return result.has_value();
}

const retarget::Skeleton& body() {
  static const retarget::Skeleton skeleton = [] {
    std::vector<retarget::Joint> joints;
    for (const char* name : {"Hips", "LeftUpLeg", "LeftLeg", "Spine", "Head", "Head", ""}) {
      retarget::Joint joint;
      joint.name = name;
      joint.parent = static_cast<int>(joints.size()) - 1;
      joints.push_back(joint);
    }
    return retarget::Skeleton(std::move(joints));
  }();
  return skeleton;
}

const std::shared_ptr<const retarget::Robot>& robot() {
  static const std::shared_ptr<const retarget::Robot> g1 = [] {
    const std::string folder = std::string(RETARGET_SOURCE_DIR) + "/robots/unitree_g1/";
    auto loaded = retarget::load_robot(folder + "model.xml", folder + "robot.json");
    require(loaded.has_value(), "the robot is there");
    return *loaded;
  }();
  return g1;
}

// readers of files alone: where these bytes are one
std::string file_of(std::string_view bytes, const std::string& name) {
  static const retarget::TemporaryFolder folder;
  return folder.write(name, std::string(bytes));
}

namespace reader {

[[maybe_unused]] void npy(std::string_view bytes) {
  const auto array = retarget::read_npy(bytes, "fuzz.npy");
  if (!good(array)) return;
  const std::size_t count = array->element_count();
  require(array->data.size() == count * array->item_size, "the shape explains the bytes");
  require((array->is_number() ? array->numbers().size() : array->texts().size()) == count,
          "every element is given");
}

[[maybe_unused]] void csv(std::string_view bytes) {
  const auto table = retarget::read_csv_table(bytes, "fuzz.csv");
  if (!good(table)) return;
  require(table->values.size() == table->rows() * table->columns, "rows are of one length");
  for (const double value : table->values) require(std::isfinite(value), "numbers are finite");
}

[[maybe_unused]] void motion(std::string_view bytes) {
  const auto read = retarget::parse_robot_motion(bytes, robot(), "fuzz.csv");
  if (!good(read)) return;
  for (int frame = 0; frame < read->clip.frame_count(); ++frame) {
    for (const double value : read->clip.qpos(frame)) {
      require(std::isfinite(value), "numbers are finite");
    }
  }
}

[[maybe_unused]] void mapping(std::string_view bytes) {
  if (const auto tables = retarget::parse_ik_tables(bytes, "fuzz.json"); good(tables)) {
    (void)good(retarget::check_ik_tables(*tables, *robot()));
  }
}

[[maybe_unused]] void dialect(std::string_view bytes) {
  (void)good(retarget::parse_dialect(bytes, "fuzz", "fuzz.json"));
}

[[maybe_unused]] void bone_map(std::string_view bytes) {
  const auto map = retarget::parse_bone_map(bytes, "fuzz.json", body());
  if (!good(map)) return;
  for (const int joint : map->joint_of_bone) {
    require(joint >= -1 && joint < body().joint_count(), "bones are joints of the skeleton");
  }
}

[[maybe_unused]] void path(std::string_view bytes) {
  const auto read = retarget::parse_path(bytes, "fuzz.json");
  if (!good(read)) return;
  require(std::isfinite(read->length()), "paths have a length");
  (void)read->at(0.5 * read->length());
  require(retarget::parse_path(retarget::format_path(*read), "again").has_value(),
          "what is written is read again");
}

[[maybe_unused]] void fit_options(std::string_view bytes) {
  (void)good(retarget::parse_fit_options(bytes, "fuzz.json", {}));
}

[[maybe_unused]] void manifest(std::string_view bytes) {
  const auto entry = retarget::parse_manifest_line(bytes);
  if (!entry) return;
  require(retarget::parse_manifest_line(retarget::manifest_line(*entry)).has_value(),
          "what is written is read again");
}

[[maybe_unused]] void profile(std::string_view bytes) {
  (void)good(retarget::load_profile(file_of(bytes, "robot.json"), *robot()));
}

// not MuJoCo's own reader, which is not ours to mend: what is looked at before it
[[maybe_unused]] void model(std::string_view bytes) {
  (void)good(retarget::vet_model(file_of(bytes, "model.xml"), true));
}

}  // namespace reader
}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  // ends where its memory ends, so that the sanitizer sees any read past it
  const std::vector<char> bytes(data, data + size);
  reader::RETARGET_FUZZED({bytes.data(), bytes.size()});
  return 0;
}
