// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "adjust/clock_offset.h"

#include <cmath>
#include <functional>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "camera/rolling_shutter.h"

namespace alidade {

namespace {

Camera camera() {
  return Camera(*Intrinsics::fromParameters(CameraModel::OpenCv5, 1280, 720, {800, 800, 639.5, 359.5, -0.1, 0.02, 0, 0, 0}));
}

/// A hand-held walk: sways and turns at frequencies that do not repeat together.
RigidTransform walking(double t) {
  const glm::dvec3 eye(0.9 * t + 0.02 * std::sin(9 * t), 0.03 * std::sin(5.3 * t), 1.6 + 0.02 * std::sin(11.7 * t));
  const glm::dvec3 target = eye + glm::dvec3(0.25 * std::sin(1.9 * t) + 0.1 * std::sin(4.3 * t), 1, 0.12 * std::sin(2.7 * t + 1));
  return RigidTransform::cameraLookingAt(eye, target);
}

using Motion = std::function<RigidTransform(double)>;

struct Scene {
  std::vector<TrackedPair> pairs;
  PoseTrack track;
};

/// Points seen in frames at 15 Hz on the pictures' clock, the trajectory at 50 Hz on its own: pose clock = picture clock
/// + offset. `outliers` of the tracks go anywhere. From every frame to the one `apart` later where that is not 1, so that pairs
/// overlap; tracks slide by a vector of `slidePx` that a patch of the picture keeps.
Scene scene(const Motion& motion, double offset, std::uint32_t seed, double noisePx, double outliers, double readoutSecs = 0,
            int apart = 1, double slidePx = 0) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, noisePx);
  std::uniform_real_distribution<double> part(0, 1);
  const Camera lens = camera();
  std::normal_distribution<double> slide(0, 1);
  std::vector<glm::dvec2> slides(8 * 6);
  for (glm::dvec2& s : slides) s = slidePx * glm::dvec2(slide(random), slide(random));
  Scene made;
  std::vector<PoseSample> samples;
  for (int i = 0; i <= 500; ++i) samples.push_back({100 + i * 0.02, motion(i * 0.02)});
  made.track = PoseTrack(samples);
  // Brute force for the rows: the row is looked up again and again with the motion itself, no twist.
  const auto see = [&](const glm::dvec3& world, double t) -> std::optional<glm::dvec2> {
    std::optional<glm::dvec2> pixel = lens.project(motion(t) * world);
    for (int i = 0; i < 8 && pixel && readoutSecs != 0; ++i)
      pixel = lens.project(motion(t + readoutSecs * (pixel->y - 359.5) / 720) * world);
    return pixel && lens.inPicture(*pixel) ? pixel : std::nullopt;
  };
  for (int frame = 10; frame + 1 < (apart > 1 ? 55 : 130); frame += apart > 1 ? 1 : 2) {
    const double t0 = frame / 15.0, t1 = (frame + apart) / 15.0;
    TrackedPair pair{100 + t0 - offset, 100 + t1 - offset, {}};
    const RigidTransform world = motion(t0).inverse();
    while (pair.tracks.size() < 80) {
      const double z = 2 + 10 * part(random);
      const glm::dvec3 p = world * glm::dvec3((1.4 * part(random) - 0.7) * z, (0.8 * part(random) - 0.4) * z, z);
      const auto a = see(p, t0), b = see(p, t1);
      if (!a || !b) continue;
      glm::dvec2 second = *b + glm::dvec2(normal(random), normal(random));
      second += slides[static_cast<std::size_t>(static_cast<int>(a->y / 120) * 8 + static_cast<int>(a->x / 160))];
      if (part(random) < outliers) second = {1280 * part(random), 720 * part(random)};
      pair.tracks.emplace_back(*a, second);
    }
    made.pairs.push_back(std::move(pair));
  }
  return made;
}

ClockOffset estimate(const Scene& scene, const ClockOffsetOptions& options = {}) {
  const auto answer = estimateClockOffset(scene.pairs, camera(), scene.track, options, Progress());
  EXPECT_TRUE(answer) << answer.error().text();
  return answer.value_or(ClockOffset());
}

}  // namespace

TEST(ClockOffset, AnInjectedOffsetIsFoundWithinItsOwnUncertainty) {
  double chiSquared = 0;
  int trials = 0;
  for (const double offset : {-0.73, -0.11, 0.0, 0.0437, 0.9}) {
    for (std::uint32_t seed = 1; seed <= 3; ++seed) {
      const ClockOffset found = estimate(scene(walking, offset, seed, 0.4, 0.2));
      ASSERT_TRUE(found.found) << found.report();
      EXPECT_LT(found.stdSecs, 0.002);
      EXPECT_NEAR(found.offsetSecs, offset, 5 * found.stdSecs) << found.report();
      chiSquared += std::pow((found.offsetSecs - offset) / found.stdSecs, 2);
      ++trials;
    }
  }
  // 99.8 % of chi-squared of 15: the stated deviation is neither boast nor false modesty.
  EXPECT_EQ(trials, 15);
  EXPECT_LT(chiSquared, 37.7);
  EXPECT_GT(chiSquared, 3.48);
}

/// Three seconds at 15 Hz, as tracks of a video are.
TEST(ClockOffset, TracksThatSlideAlongEdgesAndPairsThatOverlapAreNotTakenForIndependent) {
  double chiSquared = 0;
  constexpr int kTrials = 30;
  for (std::uint32_t seed = 1; seed <= kTrials; ++seed) {
    const ClockOffset found = estimate(scene(walking, 0.2, seed, 0.3, 0.05, 0, 4, 0.8));
    ASSERT_TRUE(found.found) << found.report();
    chiSquared += std::pow((found.offsetSecs - 0.2) / found.stdSecs, 2);
  }
  // 0.1 % and 99.9 % of chi-squared of 30.
  std::printf("chi-squared %.1f of %d\n", chiSquared, kTrials);
  EXPECT_GT(chiSquared, 11.6);
  EXPECT_LT(chiSquared, 59.7);
}

TEST(ClockOffset, ACameraThatOnlyTurnsTellsAsWell) {
  const auto turning = [](double t) {
    return RigidTransform::cameraLookingAt({0, 0, 1.6}, glm::dvec3(0, 0, 1.6) + glm::dvec3(std::sin(0.5 * std::sin(1.7 * t) + 0.2 * std::sin(4.1 * t)),
                                                                                            std::cos(0.5 * std::sin(1.7 * t)), 0.1 * std::sin(2.9 * t)));
  };
  const ClockOffset found = estimate(scene(turning, 0.2, 1, 0.4, 0.1));
  ASSERT_TRUE(found.found) << found.report();
  EXPECT_NEAR(found.offsetSecs, 0.2, 5 * found.stdSecs + 1e-5);
}

TEST(ClockOffset, TheRowsOfARollingShutterAreHeeded) {
  const Scene rolling = scene(walking, 0.1, 2, 0.2, 0.1, 0.03);
  ClockOffsetOptions options;
  options.readoutSecs = 0.03;
  const ClockOffset heeded = estimate(rolling, options), ignored = estimate(rolling);
  ASSERT_TRUE(heeded.found) << heeded.report();
  EXPECT_NEAR(heeded.offsetSecs, 0.1, 5 * heeded.stdSecs);
  EXPECT_LT(heeded.rmsPx, ignored.rmsPx);
}

TEST(ClockOffset, ItSaysWhenItCannotTell) {
  const auto still = [](double) { return RigidTransform::cameraLookingAt({0, 0, 1.6}, {0, 10, 1.6}); };
  // A constant screw: the relative pose of two frames does not depend on when they were taken.
  const auto even = [](double t) { return RigidTransform::cameraLookingAt({0.5 * t, 0, 1.6}, {0.5 * t, 10, 1.6}); };
  const auto back = [](double t) { return walking(2 + std::sin(2 * 3.141592653589793 * t / 0.5)); };
  const std::tuple<const char*, Motion, const char*> cases[] = {
      {"still", still, "hardly moves"}, {"even", even, "evenly"}, {"repeating", back, "repeats itself"}};
  for (const auto& [name, motion, words] : cases) {
    const ClockOffset found = estimate(scene(motion, 0.02, 3, 0.4, 0.1));
    EXPECT_FALSE(found.found) << name << ": " << found.report();
    EXPECT_THAT(found.reason, testing::HasSubstr(words)) << name;
  }
  // Beyond the range, and another trajectory altogether.
  const ClockOffset beyond = estimate(scene(walking, 2.5, 1, 0.4, 0.1));
  EXPECT_FALSE(beyond.found) << beyond.report();
  Scene other = scene(walking, 0, 1, 0.4, 0.1);
  other.track = scene([](double t) { return walking(3 * t + 40); }, 0, 1, 0.4, 0).track;
  EXPECT_FALSE(estimate(other).found);
  Scene few = scene(walking, 0, 1, 0.4, 0.1);
  few.pairs.resize(3);
  EXPECT_THAT(estimate(few).reason, testing::HasSubstr("only 3 pairs"));
  few.pairs.clear();
  EXPECT_FALSE(estimate(few).found);
  EXPECT_FALSE(estimateClockOffset({}, camera(), {}, {.rangeSecs = -1}, Progress()));
  EXPECT_FALSE(estimateClockOffset({}, camera(), {}, {.startSecs = std::nan("")}, Progress()));
}

}  // namespace alidade
