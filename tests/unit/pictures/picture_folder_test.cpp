// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pictures/picture_folder_reader.h"

#include <algorithm>
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

namespace alidade {

namespace fs = std::filesystem;

class PictureFolderTest : public testing::Test {
 protected:
  PictureFolderTest() {
    std::string pattern = (fs::temp_directory_path() / "alidade-pictures-XXXXXX").string();
    m_folder = mkdtemp(pattern.data());
  }
  ~PictureFolderTest() override { fs::remove_all(m_folder); }

  void picture(const std::string& name, int width, int height, int gray) const {
    cv::imwrite((m_folder / name).string(), cv::Mat(height, width, CV_8UC3, cv::Scalar(gray, gray, gray)));
  }
  std::string write(const std::string& name, const std::string& bytes) const {
    std::ofstream(m_folder / name, std::ios::binary) << bytes;
    return (m_folder / name).string();
  }

  fs::path m_folder;
  PictureFolderReader m_reader;
};

TEST(NaturalOrder, ComparesNumbersByValue) {
  std::vector<std::string> names = {"img10.png", "img2.png", "IMG1.png", "img2b.png", "img02.png", "a9999999999999999999999.png",
                                    "a10000000000000000000000.png", "img.png"};
  std::sort(names.begin(), names.end(), naturallyLess);
  EXPECT_EQ(names, (std::vector<std::string>{"a9999999999999999999999.png", "a10000000000000000000000.png", "img.png", "IMG1.png",
                                             "img02.png", "img2.png", "img2b.png", "img10.png"}));
}

TEST(NaturalOrder, IsAStrictWeakOrder) {
  const std::vector<std::string> names = {"", "0", "00", "a", "A", "a0", "a00", "A0", "a1", "a01", "1a", "01A", "b", "-"};
  for (const auto& a : names)
    for (const auto& b : names) {
      EXPECT_EQ(naturallyLess(a, b) || naturallyLess(b, a), a != b) << a << " " << b;
      EXPECT_FALSE(naturallyLess(a, b) && naturallyLess(b, a)) << a << " " << b;
      for (const auto& c : names)
        EXPECT_TRUE(!(naturallyLess(a, b) && naturallyLess(b, c)) || naturallyLess(a, c)) << a << " " << b << " " << c;
    }
}

TEST_F(PictureFolderTest, ListsPicturesInNaturalOrderAndNothingElse) {
  picture("f10.png", 40, 30, 10);
  picture("f2.png", 20, 10, 2);
  write("notes.txt", "x");
  write(".hidden.png", "x");
  fs::create_directories(m_folder / "sub.png");
  const auto info = m_reader.inspect(m_folder.string());
  ASSERT_TRUE(info) << info.error().text();
  ASSERT_EQ(info->pictures.size(), 2u);
  EXPECT_EQ(info->pictures[0].name, "f2.png");
  EXPECT_EQ(info->width, 20);
  EXPECT_EQ(info->height, 10);
  EXPECT_FALSE(info->isVideo);
  auto source = m_reader.open(m_folder.string());
  ASSERT_TRUE(source);
  EXPECT_EQ((*source)->picture(1)->at(0, 0), (Rgba8{10, 10, 10, 255}));
  EXPECT_EQ((*source)->picture(0)->at(0, 0), (Rgba8{2, 2, 2, 255}));
  EXPECT_FALSE((*source)->picture(2));
}

TEST_F(PictureFolderTest, ReadsOnePictureFile) {
  picture("one.jpg", 33, 22, 128);
  const auto info = m_reader.inspect((m_folder / "one.jpg").string());
  ASSERT_TRUE(info) << info.error().text();
  EXPECT_EQ(info->pictures.size(), 1u);
  EXPECT_EQ(info->width, 33);
}

TEST_F(PictureFolderTest, ABrokenPictureIsAnErrorOfItsOwn) {
  picture("a.png", 20, 10, 1);
  write("b.png", "");
  write("c.jpg", "\xff\xd8\xff\xe0 cut");
  auto source = m_reader.open(m_folder.string());
  ASSERT_TRUE(source);
  EXPECT_TRUE((*source)->picture(0));
  for (const std::size_t index : {1, 2}) {
    const auto broken = (*source)->picture(index);
    ASSERT_FALSE(broken);
    EXPECT_FALSE(broken.error().where.empty());
  }
  EXPECT_TRUE((*source)->picture(0)) << "the source lives on";
}

TEST_F(PictureFolderTest, RefusesFoldersWithoutPictures) {
  EXPECT_THAT(m_reader.inspect(m_folder.string()).error().what, testing::HasSubstr("no pictures"));
  EXPECT_FALSE(m_reader.inspect((m_folder / "none").string()));
  EXPECT_FALSE(m_reader.inspect(write("text.png", "words")));
  FileProbe probe;
  probe.path = m_folder.string();
  probe.isFolder = true;
  fs::remove(m_folder / "text.png");
  EXPECT_EQ(m_reader.sniff(probe), 0);
}

TEST(PictureFolder, ReadsTheRealFolders) {
  const std::string folder = std::string(ALIDADE_SHARED_DATA_DIR) + "/indoor_video/images";
  if (!fs::exists(folder)) GTEST_SKIP() << "needs " << folder;
  const auto info = PictureFolderReader().inspect(folder);
  ASSERT_TRUE(info) << info.error().text();
  EXPECT_EQ(info->pictures.size(), 24u);
  EXPECT_EQ(info->pictures[0].name, "00003.png");
  EXPECT_EQ(info->width, 540);
  EXPECT_EQ(info->height, 360);
}

}  // namespace alidade
