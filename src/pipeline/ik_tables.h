#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "retarget/error.h"
#include "retarget/robot.h"

namespace retarget {

/// One row of a mapping: a robot body follows a human bone.
struct IkRow {
  std::string body;
  std::string bone;
  double position_weight = 0.0;
  double rotation_weight = 0.0;
  Eigen::Vector3d position_offset = Eigen::Vector3d::Zero();  ///< In the target's frame, metres.
  /// bone_from_body: turns the bone's axes into the body's.
  Eigen::Quaterniond rotation_offset = Eigen::Quaterniond::Identity();

  [[nodiscard]] bool has_weight() const { return position_weight != 0.0 || rotation_weight != 0.0; }
};

/// A table of a mapping, in file order: the order of the tasks.
struct IkTable {
  bool used = true;  ///< `use_ik_match_tableN`; a table that is not used is left out.
  std::vector<IkRow> rows;
};

/// A mapping from a human to a robot in the schema of GMR (General Motion Retargeting).
///
/// | key | meaning |
/// |---|---|
/// | `robot_root_name`, `human_root_name` | root body, root bone |
/// | `ground_height` | metres that every target is lowered by, in the target's frame |
/// | `human_height_assumption` | body height the scales are made for, metres |
/// | `human_scale_table` | scale of each bone's distance from the root (the root's own: from the
/// origin) | | `use_ik_match_table1`, `2` | whether the pass takes place | | `ik_match_table1`, `2`
/// | body: [bone, position weight, rotation weight, [x, y, z], [w, x, y, z]] |
struct IkTables {
  std::string file;  ///< Where it was read from, for messages.
  std::string robot_root;
  std::string human_root;
  double ground_height = 0.0;
  double human_height_assumption = 1.8;
  std::vector<std::pair<std::string, double>> scales;  ///< By bone.
  std::array<IkTable, 2> tables;

  [[nodiscard]] const double* find_scale(std::string_view bone) const;
  /// The first row of a bone that has a weight, else the first one; null: none. Tables that are not
  /// used count too.
  [[nodiscard]] const IkRow* find_row(std::string_view bone) const;
};

/// Reads a mapping. Syntax errors come with line and column; wrong types, missing keys and
/// quaternions whose norm is not 1 within 1e-3 are named all at once. Quaternions are normalised.
[[nodiscard]] Result<IkTables> parse_ik_tables(std::string_view text, const std::string& file);
/// @param robot  if given, check_ik_tables runs as well, so that all faults are named together.
[[nodiscard]] Result<IkTables> load_ik_tables(const std::string& path,
                                              const Robot* robot = nullptr);

/// Takes the rows of these bones out of both tables: for bodies that lack an arm or a leg.
/// @return how many rows that were.
int leave_out_bones(IkTables& tables, std::span<const std::string> bones);

/// Checks a mapping against a robot and the canonical human's bones and names every fault at
/// once: unknown bodies and bones (with the nearest name), bones without a scale, two rows on one
/// bone, a root that is not there. Tables that are not used are not looked at.
[[nodiscard]] Result<void> check_ik_tables(const IkTables& tables, const Robot& robot);

}  // namespace retarget
