#include <gtest/gtest.h>

#include "tools/studies/sweep/launch/slurm.h"

// Tests of how points are distributed to the tasks of a job array.

namespace tools::sweep {
namespace {

using Lines = std::vector<std::string>;

/// Returns points named a, b, c, ... The letters of `streams` name the recorded work that each uses; '-' is none.
Lines lines_of(const std::string& streams, std::uint64_t chunk) {
  std::vector<Point> points(streams.size());
  std::vector<const Point*> pointers;
  for (std::size_t p = 0; p < points.size(); ++p) {
    points[p].id = std::string(1, static_cast<char>('a' + p));
    if (streams[p] != '-') points[p].stream = std::string(1, streams[p]);
    pointers.push_back(&points[p]);
  }
  return task_lines(pointers, chunk);
}

TEST(SlurmTasks, ALineIsATaskOfAsManyPointsAsAChunkHas) {
  EXPECT_EQ(lines_of("-----", 1), (Lines{"a", "b", "c", "d", "e"}));
  EXPECT_EQ(lines_of("-----", 2), (Lines{"a b", "c d", "e"}));
  EXPECT_EQ(lines_of("-----", 9), (Lines{"a b c d e"}));
}

TEST(SlurmTasks, PointsWithTheSameRecordedWorkAreOfOneTask) {
  EXPECT_EQ(lines_of("XYXYXY", 3), (Lines{"a c e", "b d f"}));
  EXPECT_EQ(lines_of("XXYY", 3), (Lines{"a b", "c d"})) << "rather a short task than a stream in two";
  EXPECT_EQ(lines_of("XXYYZ", 5), (Lines{"a b c d e"}));
  EXPECT_EQ(lines_of("X-X-", 2), (Lines{"a c", "b d"}));
}

TEST(SlurmTasks, WhatIsTooLargeForATaskIsCut) {
  EXPECT_EQ(lines_of("XXXXX", 2), (Lines{"a b", "c d", "e"}));
  EXPECT_EQ(lines_of("XXXXXYY", 3), (Lines{"a b c", "d e", "f g"}));
}

}  // namespace
}  // namespace tools::sweep
