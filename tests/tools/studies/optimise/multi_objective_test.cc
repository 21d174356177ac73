#include "tools/studies/optimise/multi_objective.h"

#include <gtest/gtest.h>

namespace test {
namespace {

using namespace tools::optimise;

const Score kOrigin = {0, 0};

TEST(ParetoFront, HasThePointsThatNoOtherDominates) {
  const std::vector<Score> scores = {{1, 3}, {2, 2}, {1, 2}, {3, 1}, {2, 1}};
  EXPECT_EQ(pareto_front_of(scores), (std::vector<std::size_t>{3, 1, 0})) << "the best in the first objective first";
}

TEST(ParetoFront, HasTheFirstOfEqualPoints) {
  EXPECT_EQ(pareto_front_of(std::vector<Score>{{1, 1}, {1, 1}}), (std::vector<std::size_t>{0}));
}

TEST(ParetoFront, IsTheBestPointOfOneObjective) {
  EXPECT_EQ(pareto_front_of(std::vector<Score>{{1}, {3}, {2}}), (std::vector<std::size_t>{1}));
}

TEST(Hypervolume, IsTheAreaBetweenTheCornerAndTheFront) {
  EXPECT_EQ(hypervolume(std::vector<Score>{{2, 3}}, kOrigin), 6);
  EXPECT_EQ(hypervolume(std::vector<Score>{{1, 3}, {2, 2}, {3, 1}}, kOrigin), 3 + 2 + 1);
  EXPECT_EQ(hypervolume(std::vector<Score>{{3, 1}, {1, 1}, {2, 2}, {1, 3}}, kOrigin), 3 + 2 + 1) << "in any order";
  EXPECT_EQ(hypervolume(std::vector<Score>{{2, 3}}, {1, 1}), 2);
}

TEST(Hypervolume, IgnoresPointsThatAreNotBetterThanTheCorner) {
  EXPECT_EQ(hypervolume(std::vector<Score>{{2, 0}, {0, 2}, {-1, 5}}, kOrigin), 0);
}

TEST(HypervolumeGain, IsTheIncreaseOfTheHypervolume) {
  const std::vector<Score> front = {{1, 4}, {3, 3}, {5, 1}};
  HypervolumeGain gain(kOrigin);
  for (const Score& score : front) gain.add(score);
  for (double x = -0.5; x < 7; x += 0.5) {
    for (double y = -0.5; y < 6; y += 0.5) {
      std::vector<Score> more = front;
      more.push_back({x, y});
      EXPECT_DOUBLE_EQ(gain.gain_of({x, y}), hypervolume(more, kOrigin) - hypervolume(front, kOrigin)) << x << " " << y;
    }
  }
  EXPECT_EQ(gain.gain_of({4, 2}), 1) << "by hand: from 3 to 4, from 1 to 2";
}

}  // namespace
}  // namespace test
