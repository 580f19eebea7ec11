// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

// Binary models: made from text models number by number, as COLMAP's manual lays them out.

#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <random>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "colmap/colmap_model.h"
#include "colmap/colmap_reader.h"

namespace alidade {

namespace fs = std::filesystem;
using testing::HasSubstr;

namespace {

class Bytes {
 public:
  template <class T>
  Bytes& put(T value) {
    const auto* raw = reinterpret_cast<const std::byte*>(&value);
    m_bytes.insert(m_bytes.end(), raw, raw + sizeof value);
    return *this;
  }
  Bytes& name(const std::string& text) {
    for (const char c : text) put(c);
    return put('\0');
  }
  std::vector<std::byte> take() const { return m_bytes; }
  void append(const Bytes& other) { m_bytes.insert(m_bytes.end(), other.m_bytes.begin(), other.m_bytes.end()); }

 private:
  std::vector<std::byte> m_bytes;
};

const std::map<std::string, int> kModelIds = {{"SIMPLE_PINHOLE", 0}, {"PINHOLE", 1},        {"SIMPLE_RADIAL", 2}, {"RADIAL", 3},
                                              {"OPENCV", 4},         {"OPENCV_FISHEYE", 5}, {"FULL_OPENCV", 6}};

std::vector<std::string> linesOf(const fs::path& path, bool keepEmpty) {
  std::ifstream file(path);
  std::vector<std::string> lines;
  for (std::string line; std::getline(file, line);)
    if (!line.starts_with('#') && (keepEmpty || !line.empty())) lines.push_back(line);
  return lines;
}

Bytes withCount(std::uint64_t count, const Bytes& records) {
  Bytes all;
  all.put(count);
  all.append(records);
  return all;
}

Bytes camerasOf(const fs::path& folder) {
  Bytes records;
  const auto lines = linesOf(folder / "cameras.txt", false);
  for (const std::string& line : lines) {
    std::istringstream in(line);
    std::uint32_t id;
    std::string model;
    std::uint64_t width, height;
    in >> id >> model >> width >> height;
    records.put(id).put(std::int32_t(kModelIds.at(model))).put(width).put(height);
    for (std::string number; in >> number;) records.put(std::stod(number));
  }
  return withCount(lines.size(), records);
}

Bytes imagesOf(const fs::path& folder) {
  Bytes records;
  const auto lines = linesOf(folder / "images.txt", true);
  for (std::size_t i = 0; i + 1 < lines.size(); i += 2) {
    std::istringstream in(lines[i]);
    std::uint32_t id, camera;
    in >> id;
    records.put(id);
    for (int k = 0; k < 7; ++k) {
      std::string number;
      in >> number;
      records.put(std::stod(number));
    }
    std::string name;
    in >> camera >> name;
    records.put(camera).name(name);
    Bytes features;
    std::uint64_t count = 0;
    std::istringstream points(lines[i + 1]);
    for (std::string x, y, point; points >> x >> y >> point; ++count)
      features.put(std::stod(x)).put(std::stod(y)).put(std::int64_t(std::stoll(point)));
    records.put(count);
    records.append(features);
  }
  return withCount(lines.size() / 2, records);
}

Bytes pointsOf(const fs::path& folder) {
  Bytes records;
  const auto lines = linesOf(folder / "points3D.txt", false);
  for (const std::string& line : lines) {
    std::istringstream in(line);
    std::uint64_t id;
    in >> id;
    records.put(id);
    std::string number;
    for (int k = 0; k < 3; ++k) in >> number, records.put(std::stod(number));
    for (int k = 0; k < 3; ++k) in >> number, records.put(std::uint8_t(std::stoi(number)));
    in >> number;
    records.put(std::stod(number));
    std::vector<std::uint32_t> track;
    for (std::uint32_t value; in >> value;) track.push_back(value);
    records.put(std::uint64_t(track.size() / 2));
    for (const std::uint32_t value : track) records.put(value);
  }
  return withCount(lines.size(), records);
}

Result<CameraSet> parsed(const std::vector<std::byte>& cameras, const std::vector<std::byte>& images,
                         const std::vector<std::byte>& points) {
  ColmapModel model;
  if (auto done = parseColmapBinaryCameras(cameras, "cameras.bin", model); !done) return fail(done.error());
  if (auto done = parseColmapBinaryImages(images, "images.bin", true, Progress(), model); !done) return fail(done.error());
  if (auto done = parseColmapBinaryPoints(points, "points3D.bin", Progress(), model); !done) return fail(done.error());
  return model.take();
}

Bytes oneCamera() {
  Bytes b;
  b.put(std::uint64_t(1)).put(std::uint32_t(7)).put(std::int32_t(1)).put(std::uint64_t(640)).put(std::uint64_t(480));
  for (const double v : {500.0, 510.0, 320.0, 240.0}) b.put(v);
  return b;
}

Bytes oneImage() {
  Bytes b;
  b.put(std::uint64_t(1)).put(std::uint32_t(3));
  for (const double v : {1.0, 0.0, 0.0, 0.0, 1.0, 2.0, 3.0}) b.put(v);
  b.put(std::uint32_t(7)).name("sub/a b.jpg").put(std::uint64_t(1)).put(100.5).put(50.5).put(std::uint64_t(9));
  return b;
}

Bytes onePoint() {
  Bytes b;
  b.put(std::uint64_t(1)).put(std::uint64_t(9));
  for (const double v : {4.0, 5.0, 6.0}) b.put(v);
  for (const std::uint8_t c : {1, 2, 3}) b.put(c);
  b.put(0.25).put(std::uint64_t(1)).put(std::uint32_t(3)).put(std::uint32_t(0));
  return b;
}

}  // namespace

TEST(ColmapBinary, ReadsWhatTheManualLaysOut) {
  const auto set = parsed(oneCamera().take(), oneImage().take(), onePoint().take());
  ASSERT_TRUE(set) << set.error().text();
  EXPECT_EQ(set->cameras.at(0).fy, 510);
  EXPECT_EQ(set->cameras[0].cx, 319.5) << "COLMAP's origin is half a pixel away";
  EXPECT_EQ(set->pictures.at(0).name, "sub/a b.jpg");
  EXPECT_EQ(set->pictures[0].camera, 0);
  EXPECT_EQ(set->pictures[0].cameraFromWorld->translation, glm::dvec3(1, 2, 3));
  EXPECT_EQ(set->tiePoints.at(0).seenIn.at(0).second, glm::dvec2(100, 50));
  EXPECT_EQ(set->tiePoints[0].colour, (Rgba8{1, 2, 3, 255}));
  EXPECT_TRUE(set->warnings.empty());
}

TEST(ColmapBinary, EveryCutIsRefusedWithItsPlace) {
  const auto cameras = oneCamera().take(), images = oneImage().take(), points = onePoint().take();
  const auto cut = [](std::vector<std::byte> bytes, std::size_t size) {
    bytes.resize(size);
    return bytes;
  };
  for (std::size_t n = 0; n < cameras.size(); ++n) {
    const auto set = parsed(cut(cameras, n), images, points);
    ASSERT_FALSE(set) << n;
    EXPECT_THAT(set.error().where, HasSubstr("cameras.bin, byte"));
  }
  for (std::size_t n = 0; n < images.size(); ++n) EXPECT_FALSE(parsed(cameras, cut(images, n), points)) << n;
  for (std::size_t n = 0; n < points.size(); ++n) EXPECT_FALSE(parsed(cameras, images, cut(points, n))) << n;
}

TEST(ColmapBinary, LyingCountsAndUnknownModelsAreRefused) {
  const auto with = [](Bytes bytes, std::size_t at, auto value) {
    auto raw = bytes.take();
    std::memcpy(raw.data() + at, &value, sizeof value);
    return raw;
  };
  const std::uint64_t huge = ~std::uint64_t(0) / 2;
  const auto cameras = oneCamera().take(), images = oneImage().take(), points = onePoint().take();
  EXPECT_FALSE(parsed(with(oneCamera(), 0, huge), images, points));
  EXPECT_FALSE(parsed(cameras, with(oneImage(), 0, huge), points));
  EXPECT_FALSE(parsed(cameras, with(oneImage(), oneImage().take().size() - 32, huge), points));
  EXPECT_FALSE(parsed(cameras, images, with(onePoint(), onePoint().take().size() - 16, huge)));
  EXPECT_FALSE(parsed(with(oneCamera(), 16, huge), images, points)) << "the width";
  EXPECT_FALSE(parsed(with(oneCamera(), 32, std::nan("")), images, points));
  const auto unknown = parsed(with(oneCamera(), 12, std::int32_t(7)), images, points);
  ASSERT_FALSE(unknown);
  const auto none = parsed(with(oneCamera(), 12, std::int32_t(-3)), images, points);
  ASSERT_FALSE(none);
  EXPECT_THAT(none.error().what, HasSubstr("model number -3"));
}

TEST(ColmapBinary, SurvivesRandomDamage) {
  std::mt19937 random(5);
  for (int i = 0; i < 5000; ++i) {
    std::vector<std::byte> parts[] = {oneCamera().take(), oneImage().take(), onePoint().take()};
    for (int k = 0; k < 3; ++k) {
      auto& part = parts[random() % 3];
      if (!part.empty()) part[random() % part.size()] = std::byte(random() % 256);
    }
    (void)parsed(parts[0], parts[1], parts[2]);
  }
}

TEST(ColmapBinary, TheDoorAsBytesIsTheDoorAsText) {
  const fs::path source = std::string(ALIDADE_SHARED_DATA_DIR) + "/lund_door/colmap_ground_truth";
  if (!fs::exists(source)) GTEST_SKIP() << "needs " << source;
  std::string pattern = (fs::temp_directory_path() / "alidade-colmap-XXXXXX").string();
  const fs::path folder = mkdtemp(pattern.data());
  const auto write = [&](const char* name, const Bytes& bytes) {
    const auto raw = bytes.take();
    std::ofstream(folder / name, std::ios::binary).write(reinterpret_cast<const char*>(raw.data()), std::streamsize(raw.size()));
  };
  write("cameras.bin", camerasOf(source));
  write("images.bin", imagesOf(source));
  write("points3D.bin", pointsOf(source));
  FileProbe probe;
  probe.path = folder.string();
  probe.isFolder = true;
  EXPECT_EQ(ColmapReader().sniff(probe), 90);
  const auto binary = ColmapReader().read(folder.string(), Progress());
  const auto text = ColmapReader().read(source.string(), Progress());
  const auto headOnly = ColmapReader().inspect((folder / "images.bin").string());
  fs::remove_all(folder);
  ASSERT_TRUE(binary) << binary.error().text();
  ASSERT_TRUE(headOnly) << headOnly.error().text();
  ASSERT_TRUE(text) << text.error().text();
  EXPECT_THAT(binary->details, HasSubstr("binary"));
  EXPECT_EQ(headOnly->pictures.size(), 12u);
  ASSERT_EQ(binary->cameras.size(), text->cameras.size());
  EXPECT_EQ(binary->cameras[0].parameters(), text->cameras[0].parameters());
  ASSERT_EQ(binary->pictures.size(), text->pictures.size());
  for (std::size_t i = 0; i < text->pictures.size(); ++i) {
    EXPECT_EQ(binary->pictures[i].name, text->pictures[i].name);
    EXPECT_EQ(binary->pictures[i].cameraFromWorld->rotation, text->pictures[i].cameraFromWorld->rotation);
    EXPECT_EQ(binary->pictures[i].cameraFromWorld->translation, text->pictures[i].cameraFromWorld->translation);
  }
  ASSERT_EQ(binary->tiePoints.size(), text->tiePoints.size());
  for (std::size_t i = 0; i < text->tiePoints.size(); ++i) {
    EXPECT_EQ(binary->tiePoints[i].world, text->tiePoints[i].world);
    EXPECT_EQ(binary->tiePoints[i].seenIn, text->tiePoints[i].seenIn);
  }
}

}  // namespace alidade
