#include "robot/model/model_pack.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cstddef>
#include <filesystem>
#include <string>

#include "retarget/error.h"
#include "retarget/model_pack.h"
#include "retarget/robots.h"
#include "robot/model/load_model.h"
#include "support/value_of.h"

namespace retarget {
namespace {

RobotFiles files_of_robot(const std::string& name) {
  return value_of(find_robot(name, {std::filesystem::path(RETARGET_SOURCE_DIR) / "robots"}));
}

std::string pack_of(const std::string& name) {
  return value_of(make_model_pack(files_of_robot(name)));
}

TEST(ModelPack, HoldsTheArraysOfTheModel) {
  const auto packed = value_of(parse_model_pack(pack_of("unitree_g1"), "g1.pack"));
  // The whole robot, and the variant with its own model.
  ASSERT_EQ(packed.size(), 2U);
  const auto loaded = value_of(load_model(files_of_robot("unitree_g1").model.string()));
  const mjModel& model = *loaded.model;
  const PackedModel& read = packed.front();
  EXPECT_EQ(read.file, "model.xml");
  EXPECT_EQ(read.nbody, model.nbody);
#define RETARGET_COMPARE(type, name, elements, numbers)                              \
  ASSERT_EQ(read.name.size(), static_cast<std::size_t>(model.elements) * (numbers)); \
  for (std::size_t i = 0; i < read.name.size(); ++i)                                 \
    EXPECT_EQ(read.name[i], model.name[i]) << #name;
  RETARGET_PACKED_ARRAYS(RETARGET_COMPARE)
#undef RETARGET_COMPARE
  EXPECT_EQ(read.loaded.couplings.size(), loaded.couplings.size());
}

TEST(ModelPack, EqualRobotsGiveEqualBytes) {
  EXPECT_EQ(pack_of("unitree_h1"), pack_of("unitree_h1"));
}

TEST(ModelPack, EveryTruncationIsAnError) {
  const std::string pack = pack_of("unitree_h1");
  for (std::size_t size = 0; size < pack.size(); size += size < 400 ? 1 : 97) {
    EXPECT_FALSE(parse_model_pack(std::string_view(pack).substr(0, size), "cut").has_value())
        << size;
  }
  EXPECT_FALSE(parse_model_pack(pack + "x", "longer").has_value());
}

// Whichever byte is damaged, the indices of an accepted model stay inside its arrays.
TEST(ModelPack, DamagedBytesGiveErrorsOrSafeArrays) {
  const std::string pack = pack_of("unitree_h1");
  for (std::size_t at = 0; at < pack.size(); at += at < 400 ? 1 : 61) {
    std::string damaged = pack;
    damaged[at] = static_cast<char>(~damaged[at]);
    const auto read = parse_model_pack(damaged, "damaged");
    if (!read) continue;
    for (const PackedModel& model : *read) {
      for (const int parent : model.body_parentid) {
        EXPECT_TRUE(parent >= 0 && parent < model.nbody);
      }
      for (const int address : model.name_bodyadr) {
        EXPECT_TRUE(address >= 0 && address < model.nnames);
      }
      EXPECT_EQ(model.names.back(), '\0');
    }
  }
}

TEST(ModelPack, OtherFilesAndVersionsAreNamed) {
  const auto other = parse_model_pack("a file", "walk.bvh");
  ASSERT_FALSE(other.has_value());
  EXPECT_EQ(other.error().kind, ErrorKind::kConfig);
  std::string newer = pack_of("unitree_h1");
  newer[4 + 15] = 2;
  const auto refused = parse_model_pack(newer, "newer.pack");
  ASSERT_FALSE(refused.has_value());
  EXPECT_NE(refused.error().message.find("version 2"), std::string::npos);
}

}  // namespace
}  // namespace retarget
