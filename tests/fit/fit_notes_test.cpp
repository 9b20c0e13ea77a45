// Notes of a fit about the floor and surfaces that are not in the motion.

#include "solve/fit/fit_report.h"

#include <gtest/gtest.h>

#include <vector>

namespace retarget {
namespace {

TEST(FitNotes, NameSeatsOfManyFrames) {
  const auto notes = [](int frame_count, const std::vector<SeatRest>& seats) {
    FitClip clip;
    clip.frame_count = frame_count;
    FitReport report;
    note_seats(seats, clip, 0.0, report);
    return report.notes;
  };
  const SeatRest seat{{10, 40}, 0.45, {0.0, 0.0}};
  const auto found = notes(100, {seat});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_TRUE(found[0].starts_with("in 30 % of the frames, the human sits on something "));
  EXPECT_TRUE(notes(100, {}).empty());
  // Less than 5 % of the frames.
  EXPECT_TRUE(notes(10000, {seat}).empty());
  // Less than half a second.
  EXPECT_TRUE(notes(100, {{{10, 20}, 0.45, {0.0, 0.0}}}).empty());
}

}  // namespace
}  // namespace retarget
