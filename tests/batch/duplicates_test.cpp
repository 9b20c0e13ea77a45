#include "batch/duplicates.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "batch/motion_signature.h"
#include "retarget/clip.h"
#include "retarget/edit.h"
#include "retarget/load.h"
#include "retarget/plan.h"

namespace retarget {
namespace {

const std::string kSource = RETARGET_SOURCE_DIR;

// A sample and its human.
struct Sample {
  explicit Sample(const std::string& name)
      : clip(load_clip(kSource + "/data/" + name + ".bvh").value()),
        human(find_human(clip, {}, kSource).value()) {}

  [[nodiscard]] MotionSignature signature() const { return signature_of(clip); }
  [[nodiscard]] MotionSignature signature_of(const Clip& other) const {
    return motion_signature(other, human.calibration, 0, other.frame_count());
  }

  Clip clip;
  HumanInClip human;
};

Clip at_speed(const Clip& clip, double speed) {
  return change_timing(clip, {.speed = speed}).value();
}

// Rotates every joint a little, differently in every frame.
Clip with_noise(const Clip& clip, double degrees) {
  std::mt19937 random(1);
  std::normal_distribution<double> amount(0.0, degrees * 0.0174532925 / 2.0);
  Clip noisy = clip;
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    for (Eigen::Quaterniond& rotation : noisy.rotations(frame)) {
      rotation =
          (rotation *
           Eigen::Quaterniond(1.0, amount(random), amount(random), amount(random)).normalized());
    }
  }
  return noisy;
}

TEST(MotionSignature, DependsOnlyOnTheMovement) {
  for (const char* name : {"walk", "wave", "squat", "turn_in_place", "get_up"}) {
    const Sample sample(name);
    const MotionSignature original = sample.signature();
    const auto distance = [&](const Clip& other) {
      return signature_distance(original, sample.signature_of(other));
    };
    EXPECT_EQ(distance(sample.clip), 0.0) << name;
    // At another rate, with a few frames fewer at either end, and with noise.
    EXPECT_LT(distance(change_timing(sample.clip, {.rate = FrameRate{25, 1}}).value()), 1.0)
        << name;
    EXPECT_LT(distance(change_timing(sample.clip, {.rate = FrameRate{120, 1}}).value()), 1.0)
        << name;
    const int frames = sample.clip.frame_count();
    EXPECT_LT(distance(cut(sample.clip, 4, frames - 5)), 2.5) << name;
    EXPECT_LT(distance(with_noise(sample.clip, 2.0)), 2.0) << name;
  }
}

TEST(MotionSignature, RecognisesMirrorImages) {
  const Sample wave("wave");
  const Clip image = mirror(wave.clip, wave.human.calibration).value();
  EXPECT_LT(signature_distance(mirrored(wave.signature()), wave.signature_of(image)), 0.5);
  EXPECT_GT(signature_distance(wave.signature(), wave.signature_of(image)), 20.0);
}

TEST(MotionSignature, SeparatesOtherMotions) {
  const Sample walk("walk");
  // A speed difference twice as large as between the walks of different people.
  for (const double speed : {0.92, 1.08}) {
    MotionSignature other = walk.signature_of(at_speed(walk.clip, speed));
    other.seconds = walk.signature().seconds;  // The same length, but more cycles.
    EXPECT_GT(signature_distance(walk.signature(), other), 2.0 * kDuplicateDistance) << speed;
  }
}

TEST(MotionSignature, RoundTripsThroughBytes) {
  const MotionSignature original = Sample("walk").signature();
  const MotionSignature read = signature_from_bytes(signature_bytes(original));
  EXPECT_NEAR(read.seconds, original.seconds, 1e-3);
  EXPECT_EQ(read.samples, original.samples);
  EXPECT_TRUE(signature_bytes({}).empty());
  for (const char* bytes : {"", "abc", "abcde"}) {
    EXPECT_TRUE(signature_from_bytes(bytes).samples.empty());
  }
}

// Limbs that swing smoothly at random.
MotionSignature random_signature(std::mt19937& random) {
  std::uniform_real_distribution<double> even(-1.0, 1.0);
  MotionSignature signature;
  signature.seconds = 6.0 + 4.0 * even(random);
  const int count = static_cast<int>((signature.seconds - 0.4) * kSignatureRate) + 1;
  std::vector<double> middle(kSignatureNumbers), swing(kSignatureNumbers);
  for (double& number : middle) number = 60.0 * even(random);
  for (double& number : swing) number = 10.0 * even(random);
  for (int i = 0; i < count; ++i) {
    for (std::size_t j = 0; j < kSignatureNumbers; ++j) {
      swing[j] = 0.9 * swing[j] + 4.0 * even(random);
      signature.samples.push_back(static_cast<std::int8_t>(middle[j] + swing[j]));
    }
  }
  return signature;
}

TEST(FindDuplicates, FindsExactlyTheDuplicatesAmongMany) {
  constexpr std::size_t kCount = 20000, kTwins = 100;
  std::mt19937 random(7);
  std::vector<MotionSignature> clips;
  for (std::size_t i = 0; i < kCount; ++i) clips.push_back(random_signature(random));
  // The last clips repeat the first ones with noise, every second one mirrored.
  std::uniform_int_distribution<int> noise(-2, 2);
  for (std::size_t i = 0; i < kTwins; ++i) {
    MotionSignature twin = i % 2 == 0 ? clips[3 * i] : mirrored(clips[3 * i]);
    for (std::int8_t& number : twin.samples) {
      number = static_cast<std::int8_t>(number + noise(random));
    }
    clips.push_back(std::move(twin));
  }
  std::vector<const MotionSignature*> pointers;
  for (const MotionSignature& clip : clips) pointers.push_back(&clip);
  const auto found = find_duplicates(pointers);
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (i < kCount) {
      EXPECT_FALSE(found[i]) << i;
      continue;
    }
    ASSERT_TRUE(found[i]) << i;
    EXPECT_EQ(found[i]->index, 3 * (i - kCount));
    EXPECT_EQ(found[i]->mirrored, (i - kCount) % 2 == 1);
    EXPECT_GT(found[i]->distance, 0.0);
    EXPECT_LT(found[i]->distance, kDuplicateDistance);
  }
}

TEST(FindDuplicates, KeepsTheFirstOfSeveral) {
  std::mt19937 random(3);
  const MotionSignature clip = random_signature(random), other = random_signature(random), empty;
  const auto found = find_duplicates({&empty, &other, &clip, nullptr, &clip, &clip, &empty});
  ASSERT_EQ(found.size(), 7U);
  for (const std::size_t i : {0, 1, 2, 3, 6}) EXPECT_FALSE(found[i]) << i;
  EXPECT_EQ(found[4]->index, 2U);
  EXPECT_EQ(found[5]->index, 2U);
  EXPECT_TRUE(find_duplicates({}).empty());
  // The search stops when the callback returns false.
  EXPECT_FALSE(find_duplicates({&clip, &clip}, [] { return false; })[1]);
}

}  // namespace
}  // namespace retarget
