// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "targets/mark.h"

#include <functional>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "targets/mark_match.h"

namespace alidade {

namespace {

/// A picture of `dark` where the function holds, anti-aliased by 16×16 samples a pixel, blurred as optics do.
ColourImage drawn(int side, const std::function<bool(const glm::dvec2&)>& isDark, double noise = 0, unsigned seed = 1) {
  cv::Mat1f grey(side, side);
  constexpr int samples = 16;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      int dark = 0;
      for (int j = 0; j < samples; ++j)
        for (int i = 0; i < samples; ++i)
          dark += isDark({x - 0.5 + (i + 0.5) / samples, y - 0.5 + (j + 0.5) / samples});
      grey(y, x) = 210.0f - 170.0f * static_cast<float>(dark) / (samples * samples);
    }
  cv::GaussianBlur(grey, grey, {}, 0.7);
  std::mt19937 random(seed);
  std::normal_distribution<float> error(0, static_cast<float>(std::max(noise, 1e-9)));
  ColourImage picture(side, side);
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      const auto v = cv::saturate_cast<std::uint8_t>(grey(y, x) + (noise > 0 ? error(random) : 0));
      picture.at(x, y) = {v, v, v};
    }
  return picture;
}

cv::Mat1b greyOf(const ColourImage& picture) {
  cv::Mat1b grey(picture.height(), picture.width());
  for (int y = 0; y < picture.height(); ++y)
    for (int x = 0; x < picture.width(); ++x) grey(y, x) = picture.at(x, y).r;
  return grey;
}

/// Two dark quadrants that meet, turned by 20°: a chessboard's inner corner.
auto saddleAt(const glm::dvec2& at) {
  return [at](const glm::dvec2& p) {
    const double c = std::cos(0.35), s = std::sin(0.35);
    const glm::dvec2 q(c * (p.x - at.x) + s * (p.y - at.y), -s * (p.x - at.x) + c * (p.y - at.y));
    return q.x * q.y > 0;
  };
}

auto ringsAt(const glm::dvec2& at) {
  return [at](const glm::dvec2& p) {
    const double r = glm::length(p - at);
    return r < 2.5 || (r > 5 && r < 8);
  };
}

}  // namespace

TEST(Mark, FindsACrossingAsOpenCvDoes) {
  const glm::dvec2 truth(30.37, 29.81);
  const ColourImage picture = drawn(61, saddleAt(truth));
  const auto mark = refineMark(picture, truth + glm::dvec2(1.6, -1.2));
  ASSERT_TRUE(mark) << mark.error().text();
  EXPECT_EQ(mark->shape, MarkShape::Corner);
  EXPECT_LT(glm::length(mark->pixel - truth), 0.02);
  std::vector<cv::Point2f> peer{{static_cast<float>(truth.x + 1.6), static_cast<float>(truth.y - 1.2)}};
  cv::cornerSubPix(greyOf(picture), peer, {7, 7}, {-1, -1}, {cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 50, 1e-4});
  EXPECT_LT(glm::length(mark->pixel - glm::dvec2(peer[0].x, peer[0].y)), 0.03);
}

TEST(Mark, FindsTheMiddleOfATarget) {
  const glm::dvec2 truth(29.63, 30.42);
  const auto mark = refineMark(drawn(61, ringsAt(truth)), truth + glm::dvec2(-1.1, 1.5));
  ASSERT_TRUE(mark) << mark.error().text();
  EXPECT_EQ(mark->shape, MarkShape::Centre);
  EXPECT_LT(glm::length(mark->pixel - truth), 0.02);
}

TEST(Mark, SaysHowGoodItIs) {
  const glm::dvec2 truth(30.2, 30.4);
  for (const bool rings : {false, true}) {
    double squares = 0, promised = 0;
    constexpr int trials = 100;
    for (int i = 0; i < trials; ++i) {
      const auto picture = rings ? drawn(45, ringsAt(truth - 8.0), 6, i + 1) : drawn(45, saddleAt(truth - 8.0), 6, i + 1);
      const auto mark = refineMark(picture, truth - 8.0 + glm::dvec2(0.7, -0.4));
      ASSERT_TRUE(mark) << mark.error().text();
      const glm::dvec2 miss = mark->pixel - (truth - 8.0);
      squares += glm::dot(miss, miss) / 2;
      promised += mark->sigmaPx * mark->sigmaPx;
    }
    const double ratio = std::sqrt(squares / promised);
    // Never too good; a blurred crossing's promise is up to five times what noise alone does to it.
    EXPECT_GT(ratio, 0.2) << rings;
    EXPECT_LT(ratio, 1.2) << rings;
  }
}

TEST(Mark, RefusesWhatIsNoMark) {
  const auto even = refineMark(drawn(61, [](const glm::dvec2&) { return false; }, 1.5), {30, 30});
  ASSERT_FALSE(even);
  EXPECT_THAT(even.error().what, testing::HasSubstr("even"));
  const auto edge = refineMark(drawn(61, [](const glm::dvec2& p) { return p.x + 0.3 * p.y < 39; }), {30, 30});
  ASSERT_FALSE(edge);
  EXPECT_THAT(edge.error().what, testing::HasSubstr("one edge"));
  EXPECT_FALSE(refineMark(drawn(61, saddleAt({30, 30})), {3, 30}));
  EXPECT_FALSE(refineMark(drawn(61, saddleAt({30, 30})), {std::nan(""), 30}));
  EXPECT_FALSE(refineMark(ColourImage(), {0, 0}));
}

namespace {

/// Smooth random blobs, the same function at any place: what two cameras see of one wall.
class Wall {
 public:
  explicit Wall(unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> place(-60, 60), size(2, 6), shade(-90, 90);
    for (int i = 0; i < 500; ++i) m_blobs.push_back({{place(random), place(random)}, size(random), shade(random)});
  }
  double operator()(const glm::dvec2& p) const {
    double sum = 120;
    for (const Blob& b : m_blobs) {
      const glm::dvec2 d = (p - b.at) / b.size;
      if (const double q = glm::dot(d, d); q < 20) sum += b.shade * std::exp(-0.5 * q);
    }
    return std::clamp(sum, 0.0, 255.0);
  }

 private:
  struct Blob {
    glm::dvec2 at;
    double size, shade;
  };
  std::vector<Blob> m_blobs;
};

/// Pixel p shows the wall at wallFromPixel * (p - principal).
ColourImage look(const Wall& wall, const glm::dvec2& principal, const glm::dmat2& wallFromPixel, double gain = 1) {
  ColourImage picture(121, 121);
  for (int y = 0; y < 121; ++y)
    for (int x = 0; x < 121; ++x) {
      const auto v = cv::saturate_cast<std::uint8_t>(gain * wall(wallFromPixel * (glm::dvec2(x, y) - principal)));
      picture.at(x, y) = {v, v, v};
    }
  return picture;
}

}  // namespace

TEST(MarkMatch, FindsThePlaceInATurnedNearerBrighterPicture) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const Wall wall(seed);
    const glm::dmat2 shape(1.18, 0.12, -0.09, 1.1);  // picture from reference
    const glm::dvec2 truth(63.37, 55.71);
    const auto match = matchMark(look(wall, {60, 60}, glm::dmat2(1)), {60, 60}, look(wall, truth, glm::inverse(shape), 0.85),
                                 truth + glm::dvec2(9, -13), glm::dmat2(1.12));
    ASSERT_TRUE(match) << match.error().text();
    EXPECT_LT(glm::length(match->pixel - truth), 0.05) << seed;
    EXPECT_GT(match->correlation, 0.95) << seed;
    EXPECT_LT(match->sigmaPx, 0.1) << seed;
  }
}

TEST(MarkMatch, RefusesToGuess) {
  const Wall wall(3), other(4);
  const auto elsewhere = matchMark(look(wall, {60, 60}, glm::dmat2(1)), {60, 60}, look(other, {60, 60}, glm::dmat2(1)), {60, 60});
  EXPECT_FALSE(elsewhere);
  const auto stripes = drawn(121, [](const glm::dvec2& p) {
    return std::fmod(p.x + 120, 20) < 10 && std::fmod(p.y + 120, 20) < 10;
  });
  const auto repeated = matchMark(stripes, {60, 60}, stripes, {64, 58});
  ASSERT_FALSE(repeated);
  EXPECT_THAT(repeated.error().what, testing::HasSubstr("Several"));
  EXPECT_FALSE(matchMark(stripes, {2, 2}, stripes, {60, 60}));
  EXPECT_FALSE(matchMark(stripes, {60, 60}, stripes, {118, 60}));
  EXPECT_FALSE(matchMark(stripes, {60, 60}, stripes, {60, 60}, glm::dmat2(9)));
}

}  // namespace alidade
