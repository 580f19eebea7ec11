// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "report/picture_export.h"

#include <algorithm>

#include <QGuiApplication>
#include <gtest/gtest.h>

namespace alidade {

namespace {

TitleBlock fullTitle() {
  TitleBlock title;
  title.project = "Bridge 12";
  title.frame = "frame_0012.png (13 of 45)";
  title.time = "0.80 s";
  title.camera = "cam0, OPENCV, 640 × 480 px";
  title.poseSource = "refined, ±3 mm";
  title.hidden = "design 62 % visible, 30 % hidden (as ghost), 8 % unknown";
  title.coordinates = "E 2683500.000  N 1247800.000  H 412.000 m";
  title.software = "Alidade";
  title.metresPerPixelAtCentre = 0.01;
  title.scaleDepthM = 6.2;
  return title;
}

/// Pixels of the title block from a column on that are nearly white: its text and scale bar.
std::size_t brightPixels(const ColourImage& image, int fromRow, int fromColumn) {
  std::size_t count = 0;
  for (int y = fromRow; y < image.height(); ++y)
    count += std::count_if(image.row(y) + fromColumn, image.row(y) + image.width(), [](const Rgba8& p) { return p.r > 200; });
  return count;
}

}  // namespace

TEST(TitleBlock, LeavesThePictureItselfUntouched) {
  ColourImage picture(640, 480);
  for (int y = 0; y < 480; ++y)
    for (int x = 0; x < 640; ++x) picture.at(x, y) = {static_cast<std::uint8_t>(x), static_cast<std::uint8_t>(y), 7, 255};
  const ColourImage exported = withTitleBlock(picture, fullTitle());
  EXPECT_EQ(exported.width(), 640);
  EXPECT_GT(exported.height(), 480 + 60);
  EXPECT_TRUE(std::equal(picture.data(), picture.data() + picture.size(), exported.data()));
}

TEST(TitleBlock, WritesItsTextAndAScaleBarOnlyWhereItHasMeaning) {
  const ColourImage picture(640, 480);
  TitleBlock title = fullTitle();
  const ColourImage with = withTitleBlock(picture, title);
  title.metresPerPixelAtCentre = 0;
  const ColourImage without = withTitleBlock(picture, title);
  const ColourImage empty = withTitleBlock(picture, TitleBlock{});
  EXPECT_GT(brightPixels(without, 480, 0), brightPixels(empty, 480, 0) + 200u) << "the text is drawn";
  EXPECT_GT(brightPixels(with, 480, 500), brightPixels(without, 480, 500) + 100u) << "the bar is drawn";
}

TEST(TitleBlock, RepeatsItsDataAsTextChunks) {
  const auto text = titleText(fullTitle());
  EXPECT_EQ(text.at("Alidade:frame"), "frame_0012.png (13 of 45)");
  EXPECT_EQ(text.at("Alidade:pose"), "refined, ±3 mm");
  EXPECT_EQ(text.at("Software"), "Alidade");
  EXPECT_FALSE(titleText(TitleBlock{}).contains("Alidade:metres_per_pixel"));
}

TEST(TitleBlock, FitsPicturesOfAnySize) {
  for (const auto& [width, height] : {std::pair{64, 48}, std::pair{540, 360}, std::pair{5472, 300}})
    EXPECT_GT(withTitleBlock(ColourImage(width, height), fullTitle()).height(), height);
}

}  // namespace alidade

int main(int argc, char** argv) {
  qputenv("QT_QPA_PLATFORM", "offscreen");
  const QGuiApplication application(argc, argv);
  ::testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
