// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cloud/colour_ramp.h"
#include "cloud/point_styler.h"
#include "survey/classification.h"
#include "unit/cloud/test_clouds.h"

namespace alidade {
namespace {

constexpr std::size_t kCount = 60000;
constexpr auto kBoth = PointStyler::Part::ColourAndFilter;

/// Points of three classes, whose intensity, time and normal follow from their place.
std::shared_ptr<const PointStore> richStore() {
  static const auto store = [] {
    PointBatch batch = test::unevenRoom(kCount, {402000, 5655000, 112});
    for (std::size_t i = 0; i < batch.size(); ++i) {
      const glm::dvec3& p = batch.position[i];
      batch.classification.push_back(i % 3 == 0 ? 2 : i % 3 == 1 ? 6 : 7);
      batch.intensity.push_back(static_cast<std::uint16_t>((p.x - 402000) * 1000));
      batch.gpsTime.push_back(1e8 + p.y);
      batch.returnNumber.push_back(static_cast<std::uint8_t>(1 + i % 4));
      batch.normal.push_back({0, 0, 1});
    }
    return test::storeFrom(batch, 3000);
  }();
  return store;
}

Selection wholeOf(const PointStore& store, double share = 1.0) {
  Selection selection;
  for (std::uint32_t n = 0; n < store.nodes().size(); ++n) {
    const CloudNode& node = store.nodes()[n];
    const auto count = static_cast<std::uint32_t>(share * node.count);
    if (count > 0) selection.ranges.push_back({n, node.first, count, node.spacing});
    selection.pointCount += count;
  }
  return selection;
}

/// What a style leaves of the store's first `share` of each node, point by point.
std::uint64_t expectedCount(const PointStore& store, const PointStyle& style, double share) {
  const auto planes = style.clipPlanes();
  const AttributeColumn* classes = store.attribute("classification");
  std::uint64_t left = 0;
  for (const CloudNode& node : store.nodes()) {
    const auto count = static_cast<std::uint64_t>(share * node.count);
    for (std::uint64_t i = node.first; i < node.first + count; ++i) {
      const glm::dvec3 p = store.sourcePosition(i);
      bool in = !style.hiddenClasses[static_cast<std::size_t>(classes->at(i))];
      for (const ClipPlane& plane : planes) in = in && glm::dot(plane.normal, p) >= plane.offset;
      left += in;
    }
  }
  return left;
}

void expectColours(const PointStyle& style, const glm::dvec3& eye, int scan,
                   const std::function<glm::u8vec3(const PointStore&, std::uint64_t)>& colourOf, int tolerance) {
  const auto store = richStore();
  PointStyler styler({store, std::make_shared<const PointSummary>(summarise(*store, kCount)), scan});
  Selection selection = wholeOf(*store);
  styler.apply(style, kBoth, eye, selection);
  ASSERT_EQ(selection.pointCount, kCount);
  for (const SelectedRange& range : selection.ranges) {
    ASSERT_NE(range.styled, nullptr);
    for (std::uint32_t i = 0; i < range.count; i += 7) {
      const std::uint16_t wanted = rgb565(colourOf(*store, range.first + i)), got = range.styled[i].rgb565;
      ASSERT_NEAR(wanted >> 11, got >> 11, tolerance);
      ASSERT_NEAR(wanted >> 5 & 63, got >> 5 & 63, 2 * tolerance);
      ASSERT_NEAR(wanted & 31, got & 31, tolerance);
      ASSERT_EQ(range.styled[i].x, store->points()[range.first + i].x);
    }
  }
}

TEST(PointStyler, LeavesAPlainStyleAlone) {
  const auto store = richStore();
  PointStyler styler({store, nullptr, 0});
  Selection selection = wholeOf(*store);
  styler.apply(PointStyle(), kBoth, {}, selection);
  for (const SelectedRange& range : selection.ranges) EXPECT_EQ(range.styled, nullptr);
}

TEST(PointStyler, FiltersAsAPointByPointTestDoes) {
  const auto store = richStore();
  PointStyler styler({store, nullptr, 0});
  PointStyle classes, box, section, both;
  classes.hiddenClasses.set(7);
  box.clipBox = {true, {402006, 5655004, 112.5}, {5, 4, 1.7}, 0.4};
  section.section = {true, {402006, 5655004, 112.5}, 0.7, 0.2, 0.35};
  both = classes;
  both.section = section.section;
  both.section.thicknessM = 0;
  for (const PointStyle& style : {classes, box, section, both})
    // Shares up and down: what was made for a longer prefix serves a shorter one.
    for (const double share : {0.3, 1.0, 0.11, 0.73}) {
      Selection selection = wholeOf(*store, share);
      styler.apply(style, PointStyler::Part::Filter, {}, selection);
      EXPECT_EQ(selection.pointCount, expectedCount(*store, style, share)) << share;
      EXPECT_GT(selection.pointCount, 0u);
    }
}

/// The points that a range draws.
std::vector<std::uint64_t> drawnBy(const PointStore& store, const SelectedRange& range) {
  std::vector<std::uint64_t> points(range.count);
  std::memcpy(points.data(), range.styled ? range.styled : store.points().data() + range.first, range.count * sizeof(DisplayPoint));
  return points;
}

TEST(PointStyler, WhatIsStyledCanBeCutPointByPoint) {
  const auto store = richStore();
  const Camera camera(*Intrinsics::fromParameters(CameraModel::Pinhole, 320, 240, {60, 60, 159.5, 119.5}));
  const auto pose = RigidTransform::cameraLookingAt({402005, 5655003, 114}, {402007, 5655006, 112});
  SelectionOptions options;
  options.byFacing = false;
  const Selection prefixes = select(*store, camera, pose, options);
  options.threshold = LevelThreshold::ByPoint;
  const Selection plain = select(*store, camera, pose, options);
  ASSERT_LT(plain.pointCount, prefixes.pointCount);

  // Every other class and the others: together all that is left without a style.
  PointStyle even, odd, coloured;
  for (std::size_t i = 0; i < 256; ++i) (i % 2 == 0 ? odd : even).hiddenClasses.set(i);
  coloured.colourBy = ColourBy::Height;
  std::uint64_t left = 0;
  for (const PointStyle& style : {even, odd, coloured}) {
    PointStyler styler({store, std::make_shared<const PointSummary>(summarise(*store, kCount)), 0});
    Selection styled = prefixes;
    styler.apply(style, kBoth, pose.centre(), styled);
    Selection cut = styled;
    cutByPoint(*store, camera, pose, options, cut);
    if (style == coloured) {
      EXPECT_EQ(cut.pointCount, plain.pointCount);
    } else {
      left += cut.pointCount;
    }
    // Some of the styled points, in their order and colour.
    auto before = styled.ranges.begin();
    for (const SelectedRange& range : cut.ranges) {
      while (before->node != range.node) ++before;
      const std::vector<std::uint64_t> all = drawnBy(*store, *before);
      auto at = all.begin();
      for (const std::uint64_t point : drawnBy(*store, range)) {
        at = std::find(at, all.end(), point);
        ASSERT_NE(at, all.end());
        ++at;
      }
    }
  }
  EXPECT_EQ(left, plain.pointCount);
}

TEST(PointStyler, AFilteredPrefixGrowsAndNeverChangesWhatItHad) {
  const auto store = richStore();
  PointStyler styler({store, nullptr, 0});
  PointStyle style;
  style.hiddenClasses.set(2);
  style.clipBox = {true, {402006, 5655004, 112.5}, {9, 9, 9}, 0};
  std::map<std::uint32_t, std::vector<std::uint64_t>> before;
  for (double share = 0.05; share <= 1.0; share += 0.05) {
    Selection selection = wholeOf(*store, share);
    styler.apply(style, PointStyler::Part::Filter, {}, selection);
    for (const SelectedRange& range : selection.ranges) {
      std::vector<std::uint64_t> points;
      const DisplayPoint* from = range.styled ? range.styled : store->points().data() + range.first;
      for (std::uint32_t i = 0; i < range.count; ++i) {
        std::uint64_t bits;
        std::memcpy(&bits, from + i, sizeof bits);
        points.push_back(bits);
      }
      auto& old = before[range.node];
      ASSERT_LE(old.size(), points.size());
      ASSERT_TRUE(std::equal(old.begin(), old.end(), points.begin()));
      old = std::move(points);
    }
  }
}

TEST(PointStyler, ColoursByTheAttributeOverItsRange) {
  PointStyle style;
  style.automaticRange = false;
  const auto at = [&](double value) {
    return rampColour(style.ramp, (value - style.rangeLow) / (style.rangeHigh - style.rangeLow));
  };
  style.colourBy = ColourBy::Height, style.rangeLow = 112, style.rangeHigh = 116;
  expectColours(style, {}, 0, [&](const auto& store, auto i) { return at(store.sourcePosition(i).z); }, 1);
  style.colourBy = ColourBy::Intensity, style.rangeLow = 0, style.rangeHigh = 20000;
  expectColours(style, {}, 0, [&](const auto& store, auto i) { return at((store.sourcePosition(i).x - 402000) * 1000); }, 1);
  style.colourBy = ColourBy::GpsTime, style.rangeLow = 1e8 + 5655000, style.rangeHigh = 1e8 + 5655012;
  expectColours(style, {}, 0, [&](const auto& store, auto i) { return at(1e8 + store.sourcePosition(i).y); }, 1);
  const glm::dvec3 eye(402003, 5654990, 115);
  style.colourBy = ColourBy::Distance, style.rangeLow = 5, style.rangeHigh = 30, style.ramp = ColourRamp::Grey;
  expectColours(style, eye, 0, [&](const auto& store, auto i) { return at(glm::length(store.sourcePosition(i) - eye)); }, 1);
}

TEST(PointStyler, ColoursByClassScanAndNormal) {
  PointStyle style;
  style.colourBy = ColourBy::Classification;
  expectColours(style, {}, 0, [](const auto& store, auto i) {
    return classificationColour(static_cast<std::uint8_t>(store.attribute("classification")->at(i)));
  }, 0);
  style.colourBy = ColourBy::Normal;
  expectColours(style, {}, 0, [](const auto&, auto) { return glm::u8vec3(127, 127, 255); }, 1);

  style.colourBy = ColourBy::Scan;
  const auto store = richStore();
  std::set<std::uint16_t> colours;
  for (int scan = 0; scan < 6; ++scan) {
    PointStyler styler({store, nullptr, scan});
    Selection selection = wholeOf(*store);
    styler.apply(style, kBoth, {}, selection);
    for (const SelectedRange& range : selection.ranges) colours.insert(range.styled[0].rgb565);
  }
  EXPECT_EQ(colours.size(), 6u);
}

TEST(PointStyler, AMissingColumnIsGrey) {
  const auto store = test::storeFrom(test::unevenRoom(5000));
  PointStyler styler({store, nullptr, 0});
  PointStyle style;
  style.colourBy = ColourBy::Classification;
  style.hiddenClasses.set(2);  // nothing has a class, nothing is left out
  Selection selection = wholeOf(*store);
  styler.apply(style, kBoth, {}, selection);
  EXPECT_EQ(selection.pointCount, 5000u);
  for (const SelectedRange& range : selection.ranges) EXPECT_EQ(range.styled[0].rgb565, rgb565({150, 150, 150}));
}

TEST(PointSummary, HasTheValuesOfTheCloud) {
  const auto store = richStore();
  const PointSummary summary = summarise(*store, kCount);
  EXPECT_EQ(summary.sampled, kCount);
  EXPECT_EQ(summary.classes[2], kCount / 3);
  EXPECT_EQ(summary.classes[6], kCount / 3);
  EXPECT_EQ(summary.classes[9], 0u);
  // unevenRoom: a third lies at x = 20, the others at 20 u², whose percentile q is 20 q².
  const ValueHistogram& intensity = summary.values.at(ColourBy::Intensity);
  EXPECT_NEAR(intensity.p01, 20000 * 0.015 * 0.015, 3);
  EXPECT_NEAR(intensity.p99, 20000, 1);
  std::uint64_t counted = 0;
  for (const auto count : intensity.counts) counted += count;
  EXPECT_EQ(counted, kCount);
  EXPECT_NEAR(summary.values.at(ColourBy::GpsTime).p99, 1e8 + 5655012, 0.01);
  EXPECT_TRUE(summary.has(ColourBy::Normal));
  EXPECT_FALSE(summarise(*test::storeFrom(test::unevenRoom(100))).has(ColourBy::Classification));
}

TEST(PointSummary, TwoScansShareOneRange) {
  PointSummary a, b;
  ValueHistogram low, high;
  low.low = 0, low.high = 10, low.p01 = 1, low.p99 = 9, low.counts.fill(2);
  high.low = 90, high.high = 100, high.p01 = 91, high.p99 = 99, high.counts.fill(3);
  a.values[ColourBy::Height] = low;
  b.values[ColourBy::Height] = high;
  const ValueHistogram both = merged(a, b).values.at(ColourBy::Height);
  EXPECT_EQ(both.low, 0);
  EXPECT_EQ(both.high, 100);
  EXPECT_EQ(both.p01, 1);
  EXPECT_EQ(both.p99, 99);
  std::uint64_t lower = 0, upper = 0;
  for (std::size_t i = 0; i < 128; ++i) (i < 64 ? lower : upper) += both.counts[i];
  EXPECT_EQ(lower, 256u);
  EXPECT_EQ(upper, 384u);
}

TEST(ColourRamp, EndsAreTheEndsAndLightnessGrows) {
  EXPECT_EQ(rampColour(ColourRamp::Viridis, 0), glm::u8vec3(68, 1, 84));
  EXPECT_EQ(rampColour(ColourRamp::Viridis, 1), glm::u8vec3(253, 231, 37));
  EXPECT_EQ(rampColour(ColourRamp::Viridis, -5), rampColour(ColourRamp::Viridis, 0));
  EXPECT_EQ(rampColour(ColourRamp::Viridis, std::nan("")), rampColour(ColourRamp::Viridis, 0));
  for (const ColourRamp ramp : {ColourRamp::Viridis, ColourRamp::Cividis, ColourRamp::Grey}) {
    double before = -1;
    for (double share = 0; share <= 1.0; share += 1.0 / 64) {
      const glm::dvec3 c(rampColour(ramp, share));
      const double luma = 0.2126 * c.r + 0.7152 * c.g + 0.0722 * c.b;
      EXPECT_GE(luma, before - 0.5) << share;
      before = luma;
    }
  }
}

}  // namespace
}  // namespace alidade
