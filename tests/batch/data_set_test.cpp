#include "batch/data_set.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "batch/motion_signature.h"
#include "retarget/measure.h"
#include "support/temporary_folder.h"

namespace retarget {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

ManifestEntry done(const std::string& name, double jumps, std::optional<double> leg = 0.632) {
  ManifestEntry entry;
  entry.relative = name;
  entry.robot = "g1";
  entry.done = true;
  const std::string stem = name.substr(0, name.rfind('.'));
  for (const char* ending : {".csv", ".csv.json"})
    entry.outputs.push_back({stem + ending, 1, 1, ""});
  entry.quality =
      ClipQuality{{{"jumps", jumps}, {"stance_slip_mean", 0.0015}}, {}, "", 0.0, {}, leg};
  return entry;
}

// Two seconds of a pose that depends on the number.
std::string signature(int number) {
  MotionSignature of;
  of.seconds = 2.0;
  for (std::size_t i = 0; i < 10 * kSignatureNumbers; ++i) {
    of.samples.push_back(static_cast<std::int8_t>(number * static_cast<int>(i % 7)));
  }
  return signature_bytes(of);
}

class DataSetTest : public ::testing::Test {
 protected:
  void judge(const std::vector<std::string>& gates) {
    DataSetRules rules;
    rules.gates = changed_gates(gates, RETARGET_SOURCE_DIR).value();
    judge_entries(entries_, rules);
  }
  std::string written(const char* name) const {
    std::ifstream file(folder_.path() / name, std::ios::binary);
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
  }
  void write(const DataSetRules& rules) {
    const auto result = write_lists(folder_.path().string(), entries_, rules, observer_);
    ASSERT_TRUE(result) << describe(result.error());
  }

  TemporaryFolder folder_;
  Observer observer_;
  std::vector<ManifestEntry> entries_;
};

TEST_F(DataSetTest, SelectsByCertificateMetrics) {
  entries_ = {done("likely.bvh", 0.0), done("unlikely.bvh", 0.0), done("unknown.bvh", 0.0)};
  entries_[0].quality->figures.emplace_back("predicted_tracking_success", 0.7);
  entries_[1].quality->figures.emplace_back("predicted_tracking_success", 0.3);
  for (ManifestEntry& entry : entries_) {
    entry.outputs.push_back({entry.outputs.front().file + ".certificate.json", 1, 1, ""});
  }
  judge({"predicted_tracking_success>=0.5"});
  EXPECT_EQ(reason_of(entries_[0]), "");
  EXPECT_EQ(reason_of(entries_[1]), "predicted_tracking_success 0.3 (at least 0.5)");
  // A clip without a certificate is not selected, nor is it after a round trip through the file.
  EXPECT_EQ(reason_of(entries_[2]), "predicted_tracking_success unknown");
  const auto read = parse_manifest_line(manifest_line(entries_[2])).value();
  EXPECT_EQ(reason_of(read), reason_of(entries_[2]));
  EXPECT_FALSE(has_passed(read));
  write({});
  EXPECT_EQ(written("passed.txt"), "likely.csv\n");
  judge({});
  write({});
  EXPECT_EQ(written("passed.txt"), "likely.csv\nunknown.csv\nunlikely.csv\n");
}

TEST_F(DataSetTest, GatesOnCertificateMetricsRequireCertificates) {
  BatchRequest request;
  request.data_folder = RETARGET_SOURCE_DIR;
  request.gates = {"tracked_pct>=100"};
  const auto rules = data_set_rules(request, false);
  ASSERT_FALSE(rules);
  EXPECT_THAT(rules.error().message, HasSubstr("needs certificates"));
  EXPECT_TRUE(data_set_rules(request, true));
  request.certify = true;
  EXPECT_TRUE(data_set_rules(request, false));
}

TEST_F(DataSetTest, AppliesGatesToRecordedMetrics) {
  entries_ = {done("a.bvh", 0.0), done("b.bvh", 2.0)};
  judge({});
  EXPECT_TRUE(has_passed(entries_[0]));
  EXPECT_FALSE(has_passed(entries_[1]));
  EXPECT_EQ(reason_of(entries_[1]), "jumps 2 (at most 0)");
  // A line round-trips through the file.
  const auto read = parse_manifest_line(manifest_line(entries_[1])).value();
  EXPECT_EQ(reason_of(read), reason_of(entries_[1]));
  EXPECT_EQ(read.quality->leg, 0.632);
  judge({"jumps<=2", "stance_slip_mean<=0.001"});
  EXPECT_EQ(reason_of(entries_[0]), "stance_slip_mean 0.002 (at most 0.001)");
  EXPECT_EQ(entries_[1].quality->missed, std::vector<std::string>{"stance_slip_mean"});
  EXPECT_EQ(entries_[1].quality->worst, "stance_slip_mean");
}

TEST_F(DataSetTest, BoundsScaleWithTheRecordedLeg) {
  entries_ = {done("a.bvh", 0.0, 0.316)};
  judge({});
  EXPECT_EQ(reason_of(entries_[0]), "stance_slip_mean 0.002 (at most 0.001)");
}

TEST_F(DataSetTest, NaNMissesAGate) {
  entries_ = {done("a.bvh", std::nan(""))};
  judge({});
  EXPECT_FALSE(has_passed(entries_[0]));
  entries_[0] = parse_manifest_line(manifest_line(entries_[0])).value();
  judge({});
  EXPECT_FALSE(has_passed(entries_[0]));
}

TEST_F(DataSetTest, ListsPassedAndFailedClips) {
  ManifestEntry bad = done("=c.bvh", 0.0);
  bad.done = false;
  bad.quality.reset();
  bad.error = Error{ErrorKind::kInput, {"in/c.bvh", 3, 4}, "a tab\there", {}, {}};
  ManifestEntry odd = done("new\nline.bvh", 0.0);
  entries_ = {bad, done("a.bvh", 0.0), done("b.bvh", 1.0), odd};
  judge({});
  write({});
  EXPECT_EQ(written("passed.txt"), "a.csv\n");
  EXPECT_EQ(written("failed.tsv"),
            "file\treason\trobot\n'=c.bvh\tin/c.bvh:3:4: error: a tab here\tg1\n"
            "b.bvh\tjumps 1 (at most 0)\tg1\n");
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "duplicates.tsv"));
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "train.txt"));
}

TEST_F(DataSetTest, MotionsAreNeitherTheirSidecarsNorContacts) {
  const auto motions = [](const char* clip, const std::vector<const char*>& outputs) {
    ManifestEntry entry;
    entry.relative = clip;
    entry.robot = "g1";
    for (const char* output : outputs) entry.outputs.push_back({output});
    return motions_of(entry);
  };
  using Motions = std::vector<std::string>;
  EXPECT_EQ(motions("a/walk.bvh", {"a/walk.csv", "a/walk.csv.json", "a/walk.csv.certificate.json",
                                   "a/walk.contacts.csv"}),
            Motions({"a/walk.csv"}));
  EXPECT_EQ(motions("walk.bvh", {"g1/walk.sonic/joint_pos.csv", "g1/walk.sonic/metadata.txt",
                                 "g1/walk.sonic.json", "g1/walk.gmr.pkl", "g1/walk.contacts.csv"}),
            Motions({"g1/walk.gmr.pkl", "g1/walk.sonic"}));
  EXPECT_EQ(motions("walk.bvh", {"walk/joint_pos.csv", "walk/metadata.txt"}), Motions({"walk"}));
  // The folder of a robot is not a motion, whatever the name of the clip.
  EXPECT_EQ(motions("g1.bvh", {"g1/g1.csv", "g1/g1.csv.json"}), Motions({"g1/g1.csv"}));
}

TEST_F(DataSetTest, ListsAndOmitsDuplicates) {
  for (const char* name : {"a.bvh", "b.bvh", "c.bvh"}) entries_.push_back(done(name, 0.0));
  entries_[0].signature = entries_[2].signature = signature(3);
  entries_[1].signature = signature(-9);
  ManifestEntry image = done("c_mirrored.bvh", 0.0);
  image.variant = {"c.bvh", "", "c.bvh"};
  entries_.push_back(image);
  DataSetRules rules;
  rules.dedupe = true;
  judge_entries(entries_, rules);
  write(rules);
  EXPECT_EQ(written("passed.txt"), "a.csv\nb.csv\n");
  EXPECT_EQ(written("duplicates.tsv"),
            "file\tof\tkind\tdistance_deg\trobot\nc.bvh\ta.bvh\tsame\t0.00\tg1\n"
            "c_mirrored.bvh\ta.bvh\tmirrored\t0.00\tg1\n");
  // Merging keeps the recorded duplicates; a run without the option drops them.
  judge_entries(entries_, {});
  EXPECT_TRUE(entries_[2].repeated);
  rules.dedupe = false;
  judge_entries(entries_, rules);
  EXPECT_FALSE(entries_[2].repeated);
}

TEST_F(DataSetTest, SearchesDuplicatesAmongTheRequestedClips) {
  entries_ = {done("a.bvh", 0.0), done("b.bvh", 0.0)};
  entries_[0].signature = entries_[1].signature = signature(3);
  DataSetRules rules;
  rules.dedupe = true;
  judge_entries(entries_, rules);
  EXPECT_TRUE(entries_[1].repeated);
  const std::set<std::string> asked = {"b.bvh"};
  judge_entries(entries_, rules, &asked);
  EXPECT_FALSE(entries_[1].repeated);
}

TEST_F(DataSetTest, KeepsOmittedClipsOmitted) {
  ManifestEntry left_out = done("c.bvh", 0.0);
  left_out.done = false;
  left_out.quality.reset();
  left_out.repeated = RepeatedClip{"a.bvh", true, 1.25};
  EXPECT_THAT(manifest_line(left_out), HasSubstr("\"status\":\"duplicate\""));
  const auto read = parse_manifest_line(manifest_line(left_out)).value();
  EXPECT_TRUE(read.is_left_out());
  EXPECT_FALSE(read.has_failed());
  EXPECT_TRUE(read.repeated->mirrored);
  entries_ = {read};
  DataSetRules rules;
  rules.dedupe = false;
  judge_entries(entries_, rules);
  write({});
  EXPECT_EQ(written("passed.txt"), "");
  EXPECT_THAT(written("duplicates.tsv"), HasSubstr("c.bvh\ta.bvh\tmirrored\t1.25\tg1\n"));
  EXPECT_THAT(written("failed.tsv"), Not(HasSubstr("c.bvh")));
}

TEST_F(DataSetTest, SplitKeepsSubjectsAndTwinsTogether) {
  for (int subject = 1; subject <= 10; ++subject) {
    const std::string name = "walk_subject" + std::to_string(subject);
    entries_.push_back(done(name + ".bvh", 0.0));
    ManifestEntry image = done(name + "_mirrored.bvh", 0.0);
    image.variant = {name + ".bvh", "", name + ".bvh"};
    entries_.push_back(image);
  }
  entries_.push_back(done("bad_subject1.bvh", 5.0));
  judge({});
  write({std::nullopt, std::nullopt, Split{0.8, "1"}});
  const std::string train = written("train.txt"), validation = written("validation.txt");
  EXPECT_EQ(std::ranges::count(train, '\n'), 16);
  EXPECT_EQ(std::ranges::count(validation, '\n'), 4);
  for (int subject = 1; subject <= 10; ++subject) {
    const std::string name = "walk_subject" + std::to_string(subject);
    const std::string& side = train.find(name + ".csv") == std::string::npos ? validation : train;
    EXPECT_THAT(side, HasSubstr(name + ".csv\n"));
    EXPECT_THAT(side, HasSubstr(name + "_mirrored.csv\n"));
  }
  EXPECT_THAT(train + validation, Not(HasSubstr("bad")));
}

}  // namespace
}  // namespace retarget
