#pragma once

#include <array>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace retarget {

/// Ticks of the FBX clock per second.
inline constexpr long long kFbxSecond = 46186158000;

/// Builds a text FBX file: limbs with properties, takes with linear keys.
class FbxText {
 public:
  using Vector = std::array<double, 3>;

  struct Settings {
    int up_axis = 1, up_sign = 1;
    double centimetres_per_unit = 1.0;
    int time_mode = 6;  ///< 30 fps
  };

  FbxText() : FbxText(Settings()) {}
  explicit FbxText(Settings settings) {
    settings_ = fmt::format(
        "GlobalSettings: {{\n\tVersion: 1000\n\tProperties70: {{\n"
        "\t\tP: \"UpAxis\", \"int\", \"Integer\", \"\",{}\n"
        "\t\tP: \"UpAxisSign\", \"int\", \"Integer\", \"\",{}\n"
        "\t\tP: \"FrontAxis\", \"int\", \"Integer\", \"\",{}\n"
        "\t\tP: \"FrontAxisSign\", \"int\", \"Integer\", \"\",{}\n"
        "\t\tP: \"CoordAxis\", \"int\", \"Integer\", \"\",0\n"
        "\t\tP: \"CoordAxisSign\", \"int\", \"Integer\", \"\",1\n"
        "\t\tP: \"UnitScaleFactor\", \"double\", \"Number\", \"\",{}\n"
        "\t\tP: \"TimeMode\", \"enum\", \"\", \"\",{}\n\t}}\n}}\n",
        settings.up_axis, settings.up_sign, settings.up_axis == 1 ? 2 : 1,
        settings.up_axis == 1 ? 1 : -1, settings.centimetres_per_unit, settings.time_mode);
  }

  /// Adds a node. @param kind  `LimbNode`, `Null`, `Mesh` @return its number
  int node(const std::string& name, int parent, const Vector& place,
           const std::vector<std::pair<std::string, Vector>>& vectors = {}, int rotation_order = 0,
           const std::string& kind = "LimbNode") {
    const int id = next();
    std::string properties = vector_row("Lcl Translation", place);
    for (const auto& [key, value] : vectors) properties += vector_row(key, value);
    properties += "\t\t\tP: \"RotationActive\", \"bool\", \"\", \"\",1\n";
    properties +=
        fmt::format("\t\t\tP: \"RotationOrder\", \"enum\", \"\", \"\",{}\n", rotation_order);
    properties += "\t\t\tP: \"InheritType\", \"enum\", \"\", \"\",1\n";
    objects_ += fmt::format(
        "\tModel: {}, \"Model::{}\", \"{}\" {{\n\t\tVersion: 232\n\t\tProperties70: "
        "{{\n{}\t\t}}\n\t}}\n",
        id, name, kind, properties);
    connect(id, parent);
    if (kind == "LimbNode") {
      const int attribute = next();
      objects_ += fmt::format(
          "\tNodeAttribute: {}, \"NodeAttribute::\", \"LimbNode\" {{\n\t\tTypeFlags: "
          "\"Skeleton\"\n\t}}\n",
          attribute);
      connect(attribute, id);
    }
    return id;
  }

  /// Adds a take for the following curves.
  void take(const std::string& name, double begin, double end) {
    const int stack = next();
    layer_ = next();
    objects_ += fmt::format(
        "\tAnimationStack: {}, \"AnimStack::{}\", \"\" {{\n\t\tProperties70: {{\n"
        "\t\t\tP: \"LocalStart\", \"KTime\", \"Time\", \"\",{}\n"
        "\t\t\tP: \"LocalStop\", \"KTime\", \"Time\", \"\",{}\n\t\t}}\n\t}}\n",
        stack, name, ticks(begin), ticks(end));
    objects_ += fmt::format("\tAnimationLayer: {}, \"AnimLayer::Base\", \"\" {{\n\t}}\n", layer_);
    connect(layer_, stack);
  }

  /// Keys of a node: seconds and three values each.
  void keys(int node, const std::string& property,
            const std::vector<std::pair<double, Vector>>& values) {
    const int curve_node = next();
    objects_ += fmt::format(
        "\tAnimationCurveNode: {}, \"AnimCurveNode::\", \"\" {{\n\t\tProperties70: {{\n",
        curve_node);
    for (const char axis : {'X', 'Y', 'Z'}) {
      objects_ += fmt::format("\t\t\tP: \"d|{}\", \"Number\", \"\", \"A\",0\n", axis);
    }
    objects_ += "\t\t}\n\t}\n";
    connect(curve_node, layer_);
    connections_ += fmt::format("\tC: \"OP\",{},{}, \"{}\"\n", curve_node, node, property);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const int curve = next();
      std::string times, numbers;
      for (const auto& [seconds, value] : values) {
        times += fmt::format("{}{}", times.empty() ? "" : ",", ticks(seconds));
        numbers += fmt::format("{}{}", numbers.empty() ? "" : ",", value[axis]);
      }
      objects_ += fmt::format(
          "\tAnimationCurve: {}, \"AnimCurve::\", \"\" {{\n\t\tDefault: 0\n\t\tKeyVer: 4008\n"
          "\t\tKeyTime: *{} {{\n\t\t\ta: {}\n\t\t}}\n\t\tKeyValueFloat: *{} {{\n\t\t\ta: "
          "{}\n\t\t}}\n"
          "\t\tKeyAttrFlags: *1 {{\n\t\t\ta: 4\n\t\t}}\n\t\tKeyAttrDataFloat: *4 {{\n\t\t\ta: "
          "0,0,0,0\n\t\t}}\n"
          "\t\tKeyAttrRefCount: *1 {{\n\t\t\ta: {}\n\t\t}}\n\t}}\n",
          curve, values.size(), times, values.size(), numbers, values.size());
      connections_ += fmt::format("\tC: \"OP\",{},{}, \"d|{}\"\n", curve, curve_node, "XYZ"[axis]);
    }
  }

  [[nodiscard]] std::string text() const {
    return "; FBX 7.4.0 project file\nFBXHeaderExtension: {\n\tFBXHeaderVersion: "
           "1003\n\tFBXVersion: "
           "7400\n}\n" +
           settings_ + "Objects: {\n" + objects_ + "}\nConnections: {\n" + connections_ + "}\n";
  }

 private:
  static long long ticks(double seconds) {
    return static_cast<long long>(seconds * static_cast<double>(kFbxSecond) + 0.5);
  }
  static std::string vector_row(const std::string& name, const Vector& value) {
    return fmt::format("\t\t\tP: \"{}\", \"Vector3D\", \"Vector\", \"\",{},{},{}\n", name, value[0],
                       value[1], value[2]);
  }
  int next() { return ++last_id_; }
  void connect(int child, int parent) {
    connections_ += fmt::format("\tC: \"OO\",{},{}\n", child, parent);
  }

  int last_id_ = 1000;
  int layer_ = 0;
  std::string settings_, objects_, connections_;
};

}  // namespace retarget
