#include "formats/containers/torch_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>

#include "formats/containers/npz.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using ::testing::ElementsAre;

TEST(TorchWriterTest, WrittenFilesCanBeRead) {
  const std::array<double, 6> numbers = {1.0, 2.0, 3.0, 4.0, 5.0, 6.5};
  const std::array<std::uint8_t, 2> flags = {0, 7};
  const auto write = [&] {
    TorchWriter torch;
    torch.integer("fps", 30);
    torch.number("rate", 29.97);
    torch.enum_member("state_conversion", "protomotions.simulator.base_simulator.simulator_state",
                      "StateConversion", "common");
    torch.tensor("pose", float32_array(numbers, {2, 3}));
    torch.tensor("flags", bool_array(flags, {2}));
    return torch.finish("motion");
  };
  const auto bytes = value_of(write());
  EXPECT_EQ(bytes, *write());
  EXPECT_TRUE(is_torch_file(bytes));
  const auto file = value_of(TorchFile::open(bytes, "file.pt"));
  const PickleDocument& document = file.document();
  EXPECT_EQ(document.number(*document.find(document.root(), "fps")), 30.0);
  EXPECT_EQ(document.number(*document.find(document.root(), "rate")), 29.97);
  EXPECT_EQ(document.find(document.root(), "state_conversion")->text, "common");
  const auto pose = value_of(file.read(*document.find(document.root(), "pose"), "pose"));
  EXPECT_THAT(pose.shape, ElementsAre(2, 3));
  EXPECT_THAT(pose.numbers(), ElementsAre(1.0, 2.0, 3.0, 4.0, 5.0, 6.5));
  const auto read = value_of(file.read(*document.find(document.root(), "flags"), "flags"));
  EXPECT_THAT(read.numbers(), ElementsAre(0.0, 1.0));
}

}  // namespace
}  // namespace retarget
