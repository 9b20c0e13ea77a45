#include "robot/model/check_model.h"

#include <fmt/format.h>
#include <tinyxml2.h>
#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "base/parse_xml.h"
#include "base/try.h"
#include "retarget/file.h"
#include "retarget/text.h"
#include "robot/model/mujoco_messages.h"
#include "robot/model/urdf_extras.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;
using tinyxml2::XMLElement;

// The largest known humanoid models have a few thousand elements and half a megabyte of text.
constexpr std::size_t kMaxBytes = std::size_t{16} << 20;
constexpr std::uintmax_t kMaxMeshBytes = std::uintmax_t{256} << 20;
constexpr double kMaxElements = 20'000;
constexpr double kMaxFileDepth = 16;
constexpr int kMaxDepth = 300;
// MuJoCo's load time grows with the square of these counts.
constexpr double kMaxBodies = 2000;
constexpr double kMaxJoints = 1000;
constexpr double kMaxSensors = 2000;
constexpr double kMaxCells = 16e6;
constexpr double kMaxNumbers = 1e6;
constexpr double kMaxKeyNumbers = 8e6;
constexpr double kMaxPoints = 1000;
constexpr double kMaxDetail = 10'000;

// Bound on an attribute of <size>; 0 and negative values select MuJoCo's default.
struct SizeBound {
  std::string_view attribute;
  double at_most;
};
constexpr std::array kSizes = {
    SizeBound{"njmax", 1e6},          SizeBound{"nconmax", 1e6},
    SizeBound{"nstack", 1e8},         SizeBound{"nuserdata", 1e6},
    SizeBound{"nuser_body", 100},     SizeBound{"nuser_jnt", 100},
    SizeBound{"nuser_geom", 100},     SizeBound{"nuser_site", 100},
    SizeBound{"nuser_cam", 100},      SizeBound{"nuser_tendon", 100},
    SizeBound{"nuser_actuator", 100}, SizeBound{"nuser_sensor", 100},
};
constexpr double kMaxMemory = 4e9;

// Parses blank-separated numbers; returns nothing if the text contains anything else.
std::optional<std::vector<double>> numbers_in(std::string_view text) {
  std::vector<double> numbers;
  const char* at = text.data();
  const char* const end = at + text.size();
  for (;;) {
    while (at < end && std::isspace(static_cast<unsigned char>(*at)) != 0) ++at;
    if (at == end) return numbers;
    if (*at == '+') ++at;
    double number = 0.0;
    const auto [stop, error] = std::from_chars(at, end, number);
    if (error != std::errc()) return std::nullopt;
    if (stop < end && std::isspace(static_cast<unsigned char>(*stop)) == 0) return std::nullopt;
    numbers.push_back(number);
    at = stop;
  }
}

// Position of an element in the nested files of a model.
struct Place {
  const std::string& file;
  fs::path folder;           // Folder of the file.
  double copies = 1.0;       // Product of the counts of all enclosing <replicate> elements.
  int depth = 0;             // Number of enclosing elements, including those of including files.
  int files = 0;             // Number of enclosing files.
  bool is_template = false;  // The file must be expanded by xacro.
};

class ModelChecker {
 public:
  ModelChecker(fs::path root, bool meshes) : root_(std::move(root)), meshes_(meshes) {}

  Result<void> vet_file(const std::string& file, const Place& from);
  Result<void> check_total(const std::string& file) const;

 private:
  Result<void> vet(const XMLElement& element, Place place);
  Result<void> vet_children(const XMLElement& element, const Place& place);
  Result<void> vet_kind(const XMLElement& element, Place& place);
  Result<void> vet_size(const XMLElement& element, const Place& place);
  Result<void> vet_named_file(const XMLElement& element, const Place& place);
  Result<void> vet_attached(const XMLElement& element, const Place& place);
  Result<void> vet_mesh(const XMLElement& element, const Place& place);
  Result<double> product(const XMLElement& element, const char* attribute, const Place& place,
                         double at_most) const;
  [[nodiscard]] double total() const;

  const fs::path root_;  // Canonical folder of the model.
  const bool meshes_;
  std::size_t bytes_ = 0;
  double elements_ = 0.0, bodies_ = 0.0, joints_ = 0.0, cells_ = 0.0, numbers_ = 0.0;
  double keys_ = 0.0, sensors_ = 0.0;
  double attached_ = 0.0, copied_ = 0.0;  // <attach> elements of other models, and of the model
                                          // itself.
  double largest_model_ = 0.0;            // Elements of the largest model that may be attached.
  std::vector<std::string> mesh_folders_{""};
};

Failure fault(const XMLElement& element, const Place& place, const std::string& message,
              std::string hint = {}) {
  const auto line = static_cast<std::size_t>(std::max(0, element.GetLineNum()));
  return failure({ErrorKind::kConfig,
                  {place.file, line, 0},
                  fmt::format("<{}> {}", element.Name(), message),
                  {},
                  std::move(hint)});
}

double ModelChecker::total() const {
  constexpr double kMaxDoublings = 60.0;
  return std::ldexp(elements_ + attached_ * largest_model_,
                    static_cast<int>(std::min(copied_, kMaxDoublings)));
}

Result<void> ModelChecker::check_total(const std::string& file) const {
  const auto at_most = [&](const std::string& what, double bound) {
    return config_failure(
        file, "the model has more than " + number_text(bound, 0) + " " + what +
                  ", counting included files and replicates; no real robot has as many");
  };
  if (total() > kMaxElements) return at_most("elements", kMaxElements);
  if (bodies_ > kMaxBodies) return at_most("bodies", kMaxBodies);
  if (joints_ > kMaxJoints) return at_most("joints", kMaxJoints);
  if (sensors_ > kMaxSensors) return at_most("sensors", kMaxSensors);
  if (cells_ > kMaxCells) return at_most("cells of height fields", kMaxCells);
  if (numbers_ > kMaxNumbers) return at_most("custom numbers", kMaxNumbers);
  // A keyframe stores joint positions, velocities, mocap poses and controls; a free joint needs
  // most.
  constexpr double kMaxOfElement = 13.0;
  if (keys_ * kMaxOfElement * total() > kMaxKeyNumbers) {
    return at_most("numbers in its keyframes", kMaxKeyNumbers);
  }
  return {};
}

Result<void> ModelChecker::vet_file(const std::string& file, const Place& from) {
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored)) {
    return config_failure(file, "expected a regular file, found something else");
  }
  TRY_ASSIGN(const auto text, read_file(file, ErrorKind::kConfig, kMaxBytes));
  bytes_ += text.view().size();
  if (bytes_ > kMaxBytes) {
    return config_failure(file, "the model has more than " + std::to_string(kMaxBytes) +
                                    " bytes, including all included files");
  }
  tinyxml2::XMLDocument document;
  if (auto parsed = parse_xml(text.view(), document); !parsed) {
    if (document.Error()) {
      return model_failure(file, "XML parse error: " + std::string(document.ErrorStr()));
    }
    parsed.error().kind = ErrorKind::kConfig;
    parsed.error().location.file = file;
    return parsed;
  }
  const XMLElement* top = document.RootElement();
  if (top == nullptr) return {};
  if (is_urdf(*top)) TRY(check_urdf_names(*top, file));
  return vet(*top, {file, fs::path(file).parent_path(), from.copies, from.depth, from.files + 1,
                    is_xacro_template(*top)});
}

// Returns the product of an attribute's numbers; 1 if the attribute is missing.
Result<double> ModelChecker::product(const XMLElement& element, const char* attribute,
                                     const Place& place, double at_most) const {
  const std::string text = attribute_of(&element, attribute);
  const auto numbers = numbers_in(text);
  if (!numbers) {
    return fault(
        element, place,
        std::string(attribute) + ": expected numbers, found \"" + text.substr(0, 40) + "\"");
  }
  double result = 1.0;
  for (const double number : *numbers) result *= std::max(1.0, number);
  if (result <= at_most) return result;
  return fault(element, place,
               std::string(attribute) + " is " + text.substr(0, 40) + ": at most " +
                   number_text(at_most, 0) + " is allowed");
}

Result<void> ModelChecker::vet_size(const XMLElement& element, const Place& place) {
  for (const SizeBound& bound : kSizes) {
    TRY(product(element, bound.attribute.data(), place, bound.at_most));
  }
  // `nkey` reserves keyframes in addition to the <key> elements.
  TRY_ASSIGN(const auto keys, product(element, "nkey", place, kMaxKeyNumbers));
  keys_ += keys;
  std::string memory = attribute_of(&element, "memory");
  if (memory.empty()) return {};
  const auto power = std::string_view("KMGTPE").find(
      static_cast<char>(std::toupper(static_cast<unsigned char>(memory.back()))));
  if (power != std::string_view::npos) memory.pop_back();
  const double unit =
      power == std::string_view::npos ? 1.0 : std::ldexp(1.0, 10 * static_cast<int>(power + 1));
  const auto numbers = numbers_in(memory);
  if (numbers && numbers->size() == 1 && numbers->front() * unit <= kMaxMemory) return {};
  return fault(
      element, place,
      "memory is " + attribute_of(&element, "memory").substr(0, 40) + ": at most 3G is allowed");
}

// MuJoCo searches the model's folder and the folder of the including file.
Result<void> ModelChecker::vet_named_file(const XMLElement& element, const Place& place) {
  const std::string named = attribute_of(&element, "file");
  if (named.empty()) return {};
  if (place.files > kMaxFileDepth) return fault(element, place, "nests files too deeply");
  bool found = false;
  for (const fs::path& folder : {root_, place.folder}) {
    const fs::path file = folder / named;
    std::error_code ignored;
    if (!fs::exists(file, ignored)) continue;
    if (!is_below(file, root_)) {
      return fault(element, place,
                   "names \"" + named.substr(0, 200) + "\", which lies outside the model's folder",
                   "copy the file into the model's folder");
    }
    TRY(vet_file(file.string(), place));
    if (folder == place.folder || fs::equivalent(root_, place.folder, ignored)) return {};
    found = true;
  }
  if (found) return {};
  return fault(element, place, "names \"" + named.substr(0, 200) + "\", which does not exist",
               "the search folder is the model's folder");
}

// MuJoCo parses an attached model once and copies it for every attachment.
Result<void> ModelChecker::vet_attached(const XMLElement& element, const Place& place) {
  ModelChecker other(root_, meshes_);
  other.bytes_ = bytes_;
  TRY(other.vet_named_file(element, place));
  TRY(other.check_total(place.file));
  bytes_ = other.bytes_;
  largest_model_ = std::max(largest_model_, other.total());
  cells_ += other.cells_;
  keys_ += other.keys_;
  sensors_ += other.sensors_;
  numbers_ += other.numbers_;
  return {};
}

Result<void> ModelChecker::vet_mesh(const XMLElement& element, const Place& place) {
  const std::string named =
      attribute_of(&element, element.Attribute("filename") != nullptr ? "filename" : "file");
  if (!meshes_ || named.empty()) return {};
  const fs::path package = root_.parent_path();
  for (const std::string& folder : mesh_folders_) {
    for (const fs::path& name : {fs::path(named), fs::path(named).filename()}) {
      const fs::path file = root_ / folder / name;
      std::error_code ignored;
      if (!fs::exists(file, ignored)) continue;
      if (!is_below(file, package)) {
        return fault(
            element, place,
            "names \"" + named.substr(0, 200) + "\", which lies outside the model's package");
      }
      if (!fs::is_regular_file(file, ignored) || fs::file_size(file, ignored) > kMaxMeshBytes) {
        return fault(element, place,
                     "names \"" + named.substr(0, 200) +
                         "\", which is not a regular file of plausible size");
      }
    }
  }
  return {};
}

// Rejects elements and attributes that xacro would expand. File names may contain such text,
// because mesh files need not exist.
Result<void> refuse_template(const XMLElement& element, const Place& place) {
  const auto refuse = [&](const std::string& what) {
    return fault(
        element, place, what + ": the file is a template, not a robot",
        "expand it first: xacro " + fs::path(place.file).filename().string() + " > robot.urdf");
  };
  if (is_xacro(element)) return refuse("belongs to xacro");
  for (const auto* attribute = element.FirstAttribute(); attribute != nullptr;
       attribute = attribute->Next()) {
    const std::string_view name = attribute->Name(), value = attribute->Value();
    if (name == "filename" || name == "file") continue;
    if (value.find("${") == value.npos && value.find("$(") == value.npos) continue;
    return refuse(
        fmt::format("{} is \"{}\", which xacro must substitute", name, value.substr(0, 60)));
  }
  return {};
}

Result<void> ModelChecker::vet_kind(const XMLElement& element, Place& place) {
  const auto is = [name = lower_case(element.Name())](std::string_view word) {
    return name == word;
  };
  if (is("plugin")) {
    return fault(element, place, "requires a MuJoCo plugin; plugins are never loaded",
                 "remove the plugins: kinematics does not need them");
  }
  if (is("size")) return vet_size(element, place);
  if (is("include")) return vet_named_file(element, place);
  if (is("model")) return vet_attached(element, place);
  if (is("mesh")) {
    TRY(product(element, "params", place, kMaxDetail));
    return vet_mesh(element, place);
  }
  if (is("compiler")) {
    for (const char* folder : {"meshdir", "assetdir"}) {
      if (element.Attribute(folder) != nullptr)
        mesh_folders_.push_back(attribute_of(&element, folder));
    }
  } else if (is("body") || is("link")) {
    bodies_ += place.copies;
  } else if (is("joint") || is("freejoint")) {
    joints_ += place.copies;
  } else if (is("attach")) {
    (element.Attribute("model") != nullptr ? attached_ : copied_) += place.copies;
  } else if (is("replicate")) {
    TRY_ASSIGN(const auto count, product(element, "count", place, kMaxElements));
    place.copies *= count;
  } else if (is("composite") || is("flexcomp")) {
    TRY_ASSIGN(const auto count, product(element, "count", place, kMaxPoints));
    if (element.Attribute("file") != nullptr) {
      return fault(element, place, "reads a file, which robot kinematics does not need");
    }
    bodies_ += place.copies * count;
  } else if (is("hfield")) {
    TRY_ASSIGN(const auto rows, product(element, "nrow", place, kMaxCells));
    TRY_ASSIGN(const auto columns, product(element, "ncol", place, kMaxCells));
    cells_ += rows * columns;
  } else if (is("sensor")) {
    sensors_ += place.copies * static_cast<double>(children_of(element).size());
  } else if (is("key")) {
    keys_ += place.copies;
  } else if (is("numeric")) {
    TRY_ASSIGN(const auto count, product(element, "size", place, kMaxNumbers));
    numbers_ += count;
  }
  return {};
}

Result<void> ModelChecker::vet(const XMLElement& element, Place place) {
  if (++place.depth > kMaxDepth) {
    return fault(element, place, "is nested more than " + std::to_string(kMaxDepth) + " deep");
  }
  elements_ += place.copies;
  if (is_extension_of_urdf(element) || (!place.is_template && is_xacro(element))) return {};
  TRY(refuse_template(element, place));
  TRY(vet_kind(element, place));
  TRY(check_total(place.file));
  return vet_children(element, place);
}

Result<void> ModelChecker::vet_children(const XMLElement& element, const Place& place) {
  for (const XMLElement* child : children_of(element)) {
    TRY(vet(*child, place));
  }
  return {};
}

}  // namespace

Result<void> check_model(const std::string& path, bool meshes) {
  std::error_code error;
  const fs::path whole = fs::absolute(path, error);
  const fs::path root = error ? fs::path() : fs::canonical(whole.parent_path(), error);
  if (error) return config_failure(path, "cannot find the folder of the model");
  ModelChecker vetter(root, meshes);
  return vetter.vet_file(path, {path, root});
}

}  // namespace retarget
