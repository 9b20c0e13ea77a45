#include "formats/smpl/motion_arrays.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "formats/containers/file_kind.h"
#include "formats/smpl/read_smpl.h"
#include "motion_parts.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using ::testing::HasSubstr;

const Eigen::Quaterniond kZUpFromYUp(std::sqrt(0.5), std::sqrt(0.5), 0.0, 0.0);

TEST(MotionFileTest, GvhmrResultsEqualTheNpzMotionWithYUp) {
  const Parts parts;
  const SmplMotion expected = motion_of(parts.npz());
  const SmplMotion found = motion_of(parts.gvhmr());
  expect_same_motion(found, expected, 1e-15, kZUpFromYUp);
  EXPECT_EQ(found.family, SmplFamily::kSmplx);
  EXPECT_EQ(found.betas, parts.betas);
  EXPECT_THAT(warnings_of(found), HasSubstr("assuming GVHMR's 30 fps"));
  ArrayReadOptions given;
  given.source_fps = 25.0;
  EXPECT_EQ(motion_of(parts.gvhmr(), given).clip.rate(), (FrameRate{25, 1}));
  EXPECT_THAT(warnings_of(motion_of(parts.gvhmr(), given)), Not(HasSubstr("fps")));

  // The model's own pelvis position is rotated as well.
  const auto body = value_of(read_smpl_body(MadeUpModel(55, 3).bytes(), "smplx.npz"));
  ArrayReadOptions options;
  options.body = &body;
  expect_same_motion(motion_of(parts.gvhmr(), options), motion_of(parts.npz(), options), 1e-15,
                     kZUpFromYUp);

  EXPECT_THAT(error_of(parts.gvhmr("smpl_params_incam")), HasSubstr("only in camera axes"));
}

TEST(MotionFileTest, PicklesAndTorchFilesEqualAnNpz) {
  const Parts parts;
  const SmplMotion expected = motion_of(parts.npz());
  expect_same_motion(motion_of(parts.pickle()), expected);
  expect_same_motion(motion_of(parts.pickle(true)), expected);

  TorchBuilder builder;
  const auto frames = static_cast<std::int64_t>(kPartFrames);
  const std::vector<std::pair<std::string, std::string>> members = {
      {"root_orient", builder.doubles({frames, 3}, parts.root)},
      {"pose_body", builder.doubles({frames, 21, 3}, parts.body)},
      {"trans", builder.doubles({frames, 3}, parts.trans)},
      {"betas", builder.doubles({1, 3}, parts.betas)},
      {"gender", TorchBuilder::text("neutral")},
      {"mocap_framerate", "G" + std::string("\x40\x3E\0\0\0\0\0\0", 8)}};
  const std::string motion = TorchBuilder::dictionary(members);
  expect_same_motion(motion_of(builder.build(motion)), expected);
  // One level down, as the only motion there.
  expect_same_motion(
      motion_of(builder.build(TorchBuilder::dictionary({{"person", motion}, {"a", "}"}}))),
      expected);
  expect_same_motion(motion_of(builder.build("](" + motion + "e")), expected);
  EXPECT_THAT(error_of(builder.build(TorchBuilder::dictionary({{"ann", motion}, {"bob", motion}}))),
              HasSubstr("the file holds 2 motions: ann, bob"));
}

TEST(MotionFileTest, AcceptsOtherArrayNames) {
  const Parts parts;
  const SmplMotion expected = motion_of(parts.npz());
  std::vector<double> poses, scaled;
  for (std::size_t frame = 0; frame < kPartFrames; ++frame) {
    const auto root = parts.root.begin() + static_cast<long>(3 * frame);
    const auto body = parts.body.begin() + static_cast<long>(63 * frame);
    poses.insert(poses.end(), root, root + 3);
    poses.insert(poses.end(), body, body + 63);
    poses.insert(poses.end(), 6, 0.0);
  }
  for (const double value : parts.trans) scaled.push_back(64.0 * value);
  const auto with = [&](const char* rotations, const char* places) {
    NpzBuilder builder;
    builder.add(rotations, npy_doubles({kPartFrames, 72}, poses));
    builder.add(places, npy_doubles({kPartFrames, 3}, parts.trans));
    builder.add("betas", npy_doubles({3}, parts.betas));
    builder.add("gender", npy_text("neutral"));
    builder.add("fps", npy_doubles({}, {30}));
    return builder.build();
  };
  expect_same_motion(motion_of(with("fullpose", "transl")), expected);
  expect_same_motion(motion_of(with("pose_world", "trans_world")), expected);

  // AMASS's own names take precedence.
  const auto zeros = [](std::size_t width) {
    return npy_doubles({kPartFrames, width}, std::vector<double>(kPartFrames * width));
  };
  NpzBuilder both;
  both.add("global_orient", zeros(3)).add("body_pose", zeros(63)).add("transl", zeros(3));
  both.add("poses", npy_doubles({kPartFrames, 72}, poses));
  both.add("trans", npy_doubles({kPartFrames, 3}, parts.trans));
  both.add("betas", npy_doubles({3}, parts.betas)).add("gender", npy_text("neutral"));
  both.add("fps", npy_doubles({}, {30}));
  expect_same_motion(motion_of(both.build()), expected);

  // AIST++: 60 fps and its own unit.
  NpzBuilder dance;
  dance.add("smpl_poses", npy_doubles({kPartFrames, 72}, poses));
  dance.add("smpl_trans", npy_doubles({kPartFrames, 3}, scaled));
  dance.add("smpl_scaling", npy_doubles({1}, {64}));
  dance.add("betas", npy_doubles({3}, parts.betas));
  dance.add("gender", npy_text("neutral"));
  expect_same_motion(motion_of(dance.build()), motion_of(parts.npz(60)));
  for (const double scaling : {0.0, -1.0, 5e-324, std::nan("")}) {
    NpzBuilder wrong;
    wrong.add("smpl_poses", npy_doubles({kPartFrames, 72}, poses));
    wrong.add("smpl_trans", npy_doubles({kPartFrames, 3}, scaled));
    wrong.add("smpl_scaling", npy_doubles({1}, {scaling}));
    EXPECT_THAT(error_of(wrong.build()), HasSubstr("array \"smpl_"));
  }
}

TEST(MotionFileTest, KindsOfFilesDefineTheUpAxis) {
  const Parts parts;
  const auto up_of = [](const std::string& bytes) { return motion_of(bytes).up; };
  // AMASS, and GVHMR after rotation of its world.
  EXPECT_EQ(up_of(parts.npz()), Eigen::Vector3d(0, 0, 1));
  EXPECT_EQ(up_of(parts.gvhmr()), Eigen::Vector3d(0, 0, 1));
  // Names of video estimators do not determine the up axis.
  EXPECT_EQ(up_of(parts.pickle()), std::nullopt);
  NpzBuilder dance;
  dance.add("smpl_poses",
            npy_doubles({kPartFrames, 72}, std::vector<double>(kPartFrames * 72, 0.1)));
  dance.add("smpl_trans", npy_doubles({kPartFrames, 3}, parts.trans));
  dance.add("smpl_scaling", npy_doubles({1}, {1}));
  EXPECT_EQ(up_of(dance.build()), Eigen::Vector3d(0, 1, 0));
}

TEST(MotionFileTest, ReadsMotionXAndPhumaArrays) {
  const Parts parts;
  std::vector<double> motion_x, phuma;
  for (std::size_t frame = 0; frame < kPartFrames; ++frame) {
    std::vector<double> row(322, 7.0), short_row(69);
    const auto put = [&](std::vector<double>& target, std::size_t column,
                         const std::vector<double>& from, std::size_t width) {
      std::copy_n(from.begin() + static_cast<long>(frame * width), width,
                  target.begin() + static_cast<long>(column));
    };
    put(row, 0, parts.root, 3), put(row, 3, parts.body, 63), put(row, 309, parts.trans, 3);
    std::fill(row.begin() + 312, row.end(), 0.0);
    std::copy(parts.betas.begin(), parts.betas.end(), row.begin() + 312);
    put(short_row, 3, parts.root, 3), put(short_row, 6, parts.body, 63);
    put(short_row, 0, parts.trans, 3);
    motion_x.insert(motion_x.end(), row.begin(), row.end());
    phuma.insert(phuma.end(), short_row.begin(), short_row.end());
  }
  const SmplMotion expected = motion_of(parts.npz());
  const SmplMotion found = motion_of(npy_doubles({kPartFrames, 322}, motion_x));
  expect_same_motion(found, expected);
  EXPECT_EQ(found.family, SmplFamily::kSmplx);
  EXPECT_THAT(warnings_of(found), HasSubstr("may use camera axes"));
  Parts average = parts;
  average.betas = {0};
  expect_same_motion(motion_of(npy_doubles({kPartFrames, 69}, phuma)), motion_of(average.npz()),
                     1e-15, kZUpFromYUp);

  motion_x[2 * 322 + 3] = std::nan("");
  EXPECT_THAT(error_of(npy_doubles({kPartFrames, 322}, motion_x)),
              HasSubstr("array \"pose_body\": NaN in frame 2, column 0"));
  const std::string whole = npy_doubles({kPartFrames, 69}, phuma);
  for (std::size_t size = 0; size < whole.size(); size += 97) {
    EXPECT_FALSE(read_smpl(whole.substr(0, size), "walk.npy").has_value());
  }
  EXPECT_THAT(error_of(whole.substr(0, 500)), HasSubstr("hint: the file was cut off"));
  EXPECT_THAT(error_of(npy("<f8", "(1152921504606846976, 69)", "")), HasSubstr("shape"));
  EXPECT_THAT(error_of(npy_doubles({2, 22, 3}, std::vector<double>(132))),
              HasSubstr("expected an SMPL motion, found joint positions"));
  EXPECT_THAT(error_of(npy_doubles({1, 263}, std::vector<double>(263))),
              HasSubstr("HumanML3D features"));
  EXPECT_THAT(error_of(npy_doubles({4}, {1, 2, 3, 4})), HasSubstr("shape (4,)"));
  EXPECT_THAT(error_of(npy("|O", "()", "pickled")), HasSubstr("error: "));
  EXPECT_THAT(error_of(npy_text("x")), HasSubstr("expected an SMPL motion"));
}

TEST(MotionFileTest, NamesTheContentsOfOtherFiles) {
  TorchBuilder builder;
  const std::string tensor = builder.floats({2, 3}, {1, 2, 3, 4, 5, 6});
  EXPECT_THAT(error_of(builder.build(tensor)), HasSubstr("found one tensor of shape (2, 3)"));
  EXPECT_THAT(error_of(builder.build(tensor)), HasSubstr("hint: supported: GVHMR's results"));
  EXPECT_THAT(error_of(builder.build(TorchBuilder::dictionary({{"conv.weight", tensor}}))),
              HasSubstr("found a dictionary of conv.weight"));
  EXPECT_THAT(error_of(builder.build("](" + tensor + "e")), HasSubstr("found a list of 1 values"));
  EXPECT_THAT(error_of(builder.build("N")), HasSubstr("found a single value"));
  EXPECT_THAT(error_of(builder.build(TorchBuilder::dictionary({{"dof_pos", tensor}}))),
              HasSubstr("expected a human motion, found a robot motion"));
  const std::string evil =
      TorchBuilder::call(TorchBuilder::global("posix", "system"), {TorchBuilder::text("id")});
  EXPECT_THAT(error_of(builder.build(evil)), HasSubstr("names posix.system, which is not allowed"));
  EXPECT_THAT(error_of("\x80\x02" + evil + "."),
              HasSubstr("names posix.system, which is not allowed"));
  EXPECT_THAT(
      error_of(std::string("\x80\x02\x8a\x0a\x6c\xfc\x9c\x46\xf9\x20\x6a\xa8\x50\x19.", 15)),
      HasSubstr("before 1.6"));
  EXPECT_THAT(
      error_of(std::string("\x80\x02\x8a\x0a\x6c\xfc\x9c\x46\xf9\x20\x6a\xa8\x50\x19.", 15)),
      HasSubstr("torch.save(torch.load"));
  EXPECT_THAT(error_of(Parts().gvhmr().substr(0, 900)), HasSubstr("the file was cut off"));
  EXPECT_THAT(error_of(TorchBuilder().build(TorchBuilder::dictionary(
                  {{"smpl_params_global", TorchBuilder::dictionary({{"betas", "N"}})}}))),
              HasSubstr("found betas"));
  EXPECT_THAT(error_of(TorchBuilder().build(
                  TorchBuilder::dictionary({{"poses", "N"}, {"trans", "N"}, {"fps", "K\x1e"}}))),
              HasSubstr("array \"poses\": expected an array of numbers, found None"));
}

TEST(MotionFileTest, BytesDetermineTheReader) {
  EXPECT_EQ(file_type(Parts().npz()).kind, FileKind::kNpz);
  EXPECT_EQ(file_type(Parts().gvhmr()).kind, FileKind::kTorch);
  EXPECT_EQ(file_type(Parts().pickle()).kind, FileKind::kPickle);
  EXPECT_EQ(file_type(Parts().pickle(true)).kind, FileKind::kPickle);
  EXPECT_EQ(file_type(npy_doubles({1}, {1})).kind, FileKind::kNpy);
  EXPECT_EQ(file_type("HIERARCHY\nROOT Hips\n").kind, FileKind::kBvh);
  EXPECT_EQ(file_type("\x1f\x8b\x08").kind, FileKind::kGzip);
  EXPECT_EQ(file_type("").kind, FileKind::kForeign);
}

// WHAM writes camera translations under the usual name next to those of the world.
TEST(MotionFileTest, WorldRotationsHaveWorldTranslations) {
  const Parts parts;
  const std::vector<double> poses = float_numbers(5, kPartFrames * 72, 0.5);
  const auto wham = [&](bool has_camera) {
    PickleWriter pickle;
    pickle.begin_dict();
    const auto add = [&](const char* name, const std::vector<double>& values, std::size_t width) {
      pickle.text(name);
      pickle.array(float64_array(values, {values.size() / width, width}));
    };
    if (has_camera) {
      add("pose", float_numbers(6, kPartFrames * 72, 0.5), 72);
      add("trans", float_numbers(7, kPartFrames * 3, 4.0), 3);
    }
    add("pose_world", poses, 72);
    add("trans_world", parts.trans, 3);
    pickle.end_dict();
    return pickle.finish();
  };
  ArrayReadOptions options;
  options.source_fps = 30;
  expect_same_motion(motion_of(wham(true), options), motion_of(wham(false), options));
}

TEST(MotionFileTest, WarnsAboutGapsInTheNumbersOfFrames) {
  const Parts parts;
  const auto warnings = [&](const std::vector<double>& ids) {
    NpzBuilder builder;
    builder.add("poses", npy_doubles({kPartFrames, 66}, std::vector<double>(kPartFrames * 66, .1)));
    builder.add("trans", npy_doubles({kPartFrames, 3}, parts.trans));
    builder.add("fps", npy_doubles({}, {10}));
    builder.add("frame_ids", npy_doubles({ids.size()}, ids));
    return warnings_of(motion_of(builder.build()));
  };
  EXPECT_THAT(warnings({7, 8, 9, 40, 42}),
              HasSubstr("\"frame_ids\" leaves out 31 frames in 2 places, first after 9 (0.20 s"));
  EXPECT_THAT(warnings({7, 8, 9, 10, 11}), Not(HasSubstr("frame_ids")));
  // Every second frame of the video.
  EXPECT_THAT(warnings({0, 2, 4, 6, 8}), Not(HasSubstr("frame_ids")));
  EXPECT_THAT(warnings({0, 2, 4, 12, 14}), HasSubstr("leaves out 3 frames in 1 place, first"));
  EXPECT_THAT(warnings({3, 3, 3, 3, 3}), Not(HasSubstr("frame_ids")));
  EXPECT_THAT(warnings({7, 40}), Not(HasSubstr("frame_ids")));
}

// numpy.save wraps a dictionary in an array of one object.
TEST(MotionFileTest, NamesTheArraysOfAnotherDictionary) {
  PickleWriter pickle;
  pickle.begin_list();
  pickle.begin_dict();
  pickle.text("pred_rotmat");
  pickle.array(float64_array(std::vector<double>(2), {2}));
  pickle.end_dict();
  pickle.end_list();
  EXPECT_THAT(error_of(pickle.finish()), HasSubstr("found a dictionary of pred_rotmat"));
}

}  // namespace
}  // namespace retarget
