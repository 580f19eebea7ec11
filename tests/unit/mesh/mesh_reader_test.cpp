// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <cstring>
#include <filesystem>
#include <fstream>
#include <thread>

#include <unistd.h>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "mesh/mesh_reader.h"

namespace alidade {
namespace {

namespace fs = std::filesystem;

const glm::dvec3 kLow(2683500.123, 1247800.456, 408.789), kSize(3.001, 0.251, 2.507);

/// A folder that goes with the test.
class MeshFiles : public testing::Test {
 protected:
  MeshFiles() : m_folder(fs::temp_directory_path() / fmt::format("alidade-mesh-test-{}", ::getpid())) {
    fs::create_directories(m_folder);
  }
  ~MeshFiles() override { fs::remove_all(m_folder); }

  std::string write(const std::string& name, const std::string& content) const {
    std::ofstream(m_folder / name, std::ios::binary) << content;
    return (m_folder / name).string();
  }
  Result<DesignModel> read(const std::string& name, const std::string& content) {
    warnings.clear();
    return MeshReader().read(write(name, content), Progress(), warnings);
  }
  /// The whole text of the error, for what both ways of opening say.
  std::string refusal(const std::string& name, const std::string& content) {
    const auto model = read(name, content);
    return model ? std::string("accepted") : model.error().text();
  }
  bool warned(const std::string& words) const {
    for (const auto& w : warnings)
      if (w.what.find(words) != std::string::npos) return true;
    return false;
  }

  std::vector<ImportWarning> warnings;
  fs::path m_folder;
};

glm::dvec3 corner(const glm::dvec3& low, const glm::dvec3& size, int i) {
  return low + size * glm::dvec3(i & 1, (i >> 1) & 1, (i >> 2) & 1);
}

constexpr int kSides[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};

std::string objBox(const glm::dvec3& low, const glm::dvec3& size, const std::string& head = "o box\n") {
  std::string text = head;
  for (int i = 0; i < 8; ++i) {
    const glm::dvec3 c = corner(low, size, i);
    text += fmt::format("v {:.4f} {:.4f} {:.4f}\n", c.x, c.y, c.z);
  }
  for (const auto& s : kSides) text += fmt::format("f {} {} {} {}\n", s[0] + 1, s[1] + 1, s[2] + 1, s[3] + 1);
  return text;
}

double volumeOf(const DesignModel& model) {
  double six = 0;
  for (std::size_t i = 0; i + 2 < model.triangles.size(); i += 3) {
    const glm::dvec3 a(model.vertices[model.triangles[i]]), b(model.vertices[model.triangles[i + 1]]),
        c(model.vertices[model.triangles[i + 2]]);
    six += glm::dot(a, glm::cross(b, c));
  }
  return six / 6;
}

void expectBox(const Result<DesignModel>& model, const glm::dvec3& low, const glm::dvec3& size, double tolerance) {
  ASSERT_TRUE(model) << model.error().text();
  EXPECT_EQ(model->triangles.size(), 36u);
  EXPECT_EQ(model->edges.size(), 12u);
  const Bounds box = model->bounds();
  for (int a = 0; a < 3; ++a) {
    EXPECT_NEAR(box.min[a], low[a], tolerance);
    EXPECT_NEAR(box.max[a], low[a] + size[a], tolerance);
  }
  EXPECT_NEAR(volumeOf(*model), size.x * size.y * size.z, 1e-3);
}

TEST_F(MeshFiles, AnObjFarFromTheOriginKeepsItsTenthOfAMillimetre) {
  expectBox(read("far.obj", objBox(kLow, kSize)), kLow, kSize, 2e-5);
  expectBox(read("near.obj", objBox({0.1, 0.2, 0.3}, kSize)), {0.1, 0.2, 0.3}, kSize, 1e-6);
}

TEST_F(MeshFiles, ObjGroupsBecomeElementsAndMaterialsTheirColours) {
  write("site.mtl", "newmtl red\nKd 1 0 0\nnewmtl glass\nKd 0 0 1\nd 0.5\n");
  const std::string text = "mtllib site.mtl\no wall\nusemtl red\nv 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n"
                           "o pane\nusemtl glass\nv 0 0 5\nv 1 0 5\nv 1 1 5\nf -3 -2 -1\n";
  const auto model = read("site.obj", text);
  ASSERT_TRUE(model) << model.error().text();
  ASSERT_EQ(model->elements.size(), 2u);
  EXPECT_EQ(model->elements[0].name, "wall");
  EXPECT_EQ(model->elements[0].colour, (Rgba8{255, 0, 0, 255}));
  EXPECT_EQ(model->elements[1].name, "pane");
  EXPECT_EQ(model->elements[1].colour, (Rgba8{0, 0, 255, 128}));
  EXPECT_NEAR(model->elementBounds(1).min.z, 5.0, 1e-9);
  EXPECT_TRUE(warnings.empty()) << warnings.front().what;
}

TEST_F(MeshFiles, AMissingMaterialFileIsAWarning) {
  expectBox(read("lost.obj", objBox({0, 0, 0}, kSize, "mtllib gone.mtl\no box\nusemtl brick\n")), {0, 0, 0}, kSize, 1e-6);
  EXPECT_TRUE(warned("material file is missing"));
}

TEST_F(MeshFiles, ObjIndicesThatDoNotExistAreRefusedWithTheirLine) {
  const std::string v = "v 0 0 0\nv 1 0 0\nv 1 1 0\n";
  EXPECT_NE(refusal("a.obj", v + "f 1 2 4\n").find("line 4"), std::string::npos);
  EXPECT_NE(refusal("b.obj", v + "f 1 2 -4\n").find("does not exist"), std::string::npos);
  EXPECT_NE(refusal("c.obj", v + "f 0 1 2\n").find("does not exist"), std::string::npos);
  EXPECT_NE(refusal("d.obj", v + "f 1/9 2/9 3/9\n").find("does not exist"), std::string::npos);
  EXPECT_NE(refusal("e.obj", v + "f 1 2 99999999999999999999\n").find("does not exist"), std::string::npos);
}

TEST_F(MeshFiles, ObjCoordinatesThatAreNoNumbersAreRefused) {
  for (const char* bad : {"nan", "inf", "1e300", "1,5", "x", ""})
    EXPECT_NE(refusal("n.obj", fmt::format("v 0 0 0\nv 1 0 {}\nv 1 1 0\nf 1 2 3\n", bad)).find("line 2"), std::string::npos)
        << bad;
}

TEST_F(MeshFiles, DegenerateTrianglesAreLeftOutAndSaid) {
  const auto model = read("d.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 2 0 0\nf 1 2 3\nf 1 2 4\nf 1 1 2\n");
  ASSERT_TRUE(model) << model.error().text();
  EXPECT_EQ(model->triangles.size(), 3u);
  EXPECT_TRUE(warned("without area")) << "or their equal";
}

std::string stlBox(const glm::dvec3& low, const glm::dvec3& size) {
  std::string text = "solid box\n";
  for (const auto& s : kSides)
    for (const auto& t : {std::array{s[0], s[1], s[2]}, std::array{s[0], s[2], s[3]}}) {
      text += "facet normal 0 0 0\nouter loop\n";
      for (const int i : t) {
        const glm::dvec3 c = corner(low, size, i);
        text += fmt::format("vertex {:.4f} {:.4f} {:.4f}\n", c.x, c.y, c.z);
      }
      text += "endloop\nendfacet\n";
    }
  return text + "endsolid box\n";
}

std::string binaryStlBox(const glm::dvec3& low, const glm::dvec3& size) {
  std::string bytes(80, ' ');
  const auto put = [&bytes](const auto& value) { bytes.append(reinterpret_cast<const char*>(&value), sizeof value); };
  put(std::uint32_t{12});
  for (const auto& s : kSides)
    for (const auto& t : {std::array{s[0], s[1], s[2]}, std::array{s[0], s[2], s[3]}}) {
      put(glm::vec3(0));
      for (const int i : t) put(glm::vec3(corner(low, size, i)));
      put(std::uint16_t{0});
    }
  return bytes;
}

TEST_F(MeshFiles, AnAsciiStlFarFromTheOriginKeepsItsTenthOfAMillimetre) {
  expectBox(read("far.stl", stlBox(kLow, kSize)), kLow, kSize, 2e-5);
}

TEST_F(MeshFiles, ABinaryStlIsReadAndWarnedOfFarFromTheOrigin) {
  expectBox(read("near.stl", binaryStlBox({1, 2, 3}, kSize)), {1, 2, 3}, kSize, 1e-6);
  EXPECT_FALSE(warned("mm only"));
  const auto far = read("far.stl", binaryStlBox(kLow, {300, 300, 300}));
  ASSERT_TRUE(far) << far.error().text();
  EXPECT_TRUE(warned("250 mm only"));
}

TEST_F(MeshFiles, AnStlWithALyingCountIsRefused) {
  std::string bytes = binaryStlBox({1, 2, 3}, kSize);
  const std::uint32_t many = 0xFFFFFFFF;
  std::memcpy(bytes.data() + 80, &many, 4);
  EXPECT_NE(refusal("lie.stl", bytes).find("promises 4294967295 facets"), std::string::npos);
  EXPECT_NE(refusal("cut.stl", binaryStlBox({1, 2, 3}, kSize).substr(0, 300)).find("promises 12 facets"), std::string::npos);
  EXPECT_NE(refusal("cut2.stl", stlBox({1, 2, 3}, kSize).substr(0, 200)).find("STL"), std::string::npos);
}

std::string base64(const std::string& bytes) {
  static const char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t v = 0;
    for (std::size_t k = 0; k < 3; ++k) v = (v << 8) | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k) out += i * 4 / 3 + k <= (bytes.size() * 4 + 2) / 3 && i + k <= bytes.size() ? kDigits[(v >> (18 - 6 * k)) & 63] : '=';
  }
  return out;
}

/// A box of unit-scale positions in a mesh, placed by `nodes`.
std::string gltfBox(const glm::dvec3& size, const std::string& nodes, const std::string& more = "") {
  std::string bytes;
  for (int i = 0; i < 8; ++i) {
    const glm::vec3 c(corner(glm::dvec3(0), size, i));
    bytes.append(reinterpret_cast<const char*>(&c), sizeof c);
  }
  for (const auto& s : kSides)
    for (const int i : {s[0], s[1], s[2], s[0], s[2], s[3]}) {
      const auto index = static_cast<std::uint16_t>(i);
      bytes.append(reinterpret_cast<const char*>(&index), 2);
    }
  return fmt::format(
      R"({{"asset":{{"version":"2.0"}},{}"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":{},
"materials":[{{"name":"m","pbrMetallicRoughness":{{"baseColorFactor":[1,0.2140411,0,1]}}}}],
"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1,"material":0}}]}}],
"accessors":[{{"bufferView":0,"componentType":5126,"count":8,"type":"VEC3","min":[0,0,0],"max":[{},{},{}]}},
{{"bufferView":1,"componentType":5123,"count":36,"type":"SCALAR"}}],
"bufferViews":[{{"buffer":0,"byteOffset":0,"byteLength":96}},{{"buffer":0,"byteOffset":96,"byteLength":72}}],
"buffers":[{{"byteLength":168,"uri":"data:application/octet-stream;base64,{}"}}]}})",
      more, nodes, size.x, size.y, size.z, base64(bytes));
}

TEST_F(MeshFiles, AGltfFarFromTheOriginComesOutZUpToTheTenthOfAMillimetre) {
  // y-up in the file: world (E, N, H) is (x, -z, y); a box of (dx, dy, dz) reaches from -z - dz to -z.
  const glm::dvec3 size(3.001, 2.507, 0.251);
  const std::string nodes = fmt::format(
      R"([{{"name":"site","children":[1],"translation":[{:.4f},{:.4f},{:.4f}]}},{{"name":"wall","mesh":0,"translation":[0.5,0,0]}}])",
      kLow.x - 0.5, kLow.z, -(kLow.y + size.z));
  const auto model = read("far.gltf", gltfBox(size, nodes));
  expectBox(model, kLow, {size.x, size.z, size.y}, 2e-5);
  ASSERT_EQ(model->elements.size(), 1u);
  EXPECT_EQ(model->elements[0].name, "wall");
  EXPECT_EQ(model->elements[0].storey, "site");
  EXPECT_EQ(model->elements[0].colour, (Rgba8{255, 127, 0, 255}));  // linear 0.214 is half grey on screen
}

TEST_F(MeshFiles, AGltfNodeBelowItselfIsRefused) {
  EXPECT_NE(refusal("loop.gltf", gltfBox({1, 1, 1}, R"([{"mesh":0,"children":[1]},{"children":[0]}])")).find("below itself"),
            std::string::npos);
  EXPECT_NE(refusal("gone.gltf", gltfBox({1, 1, 1}, R"([{"mesh":7}])")).find("mesh that does not exist"), std::string::npos);
  EXPECT_NE(refusal("kids.gltf", gltfBox({1, 1, 1}, R"([{"mesh":0,"children":[99999999999]}])")).find("node that does not exist"),
            std::string::npos);
  EXPECT_NE(refusal("nan.gltf", gltfBox({1, 1, 1}, R"([{"mesh":0,"translation":[1,"x",2]}])")).find("no number"), std::string::npos);
}

TEST_F(MeshFiles, AGltfThatNeedsDracoIsRefusedByName) {
  const std::string text = gltfBox({1, 1, 1}, R"([{"mesh":0}])", R"("extensionsRequired":["KHR_draco_mesh_compression"],)");
  EXPECT_NE(refusal("draco.gltf", text).find("KHR_draco_mesh_compression"), std::string::npos);
}

TEST_F(MeshFiles, BrokenGltfIsRefused) {
  const std::string whole = gltfBox({1, 1, 1}, R"([{"mesh":0}])");
  EXPECT_NE(refusal("cut.gltf", whole.substr(0, whole.size() / 2)).find("JSON is broken"), std::string::npos);
  EXPECT_NE(refusal("deep.gltf", std::string(100000, '[')).find("nested too deep"), std::string::npos);
  EXPECT_NE(refusal("bad.glb", "glTF\x02").find("GLB"), std::string::npos);
  std::string huge = whole;
  huge.replace(huge.find("\"count\":8"), 9, "\"count\":4000000000");
  EXPECT_NE(refusal("huge.gltf", huge), "accepted");
}

TEST_F(MeshFiles, APlyWithDoublesFarFromTheOriginKeepsItsTenthOfAMillimetre) {
  for (const bool text : {true, false}) {
    std::string bytes = fmt::format("ply\nformat {} 1.0\nelement vertex 8\nproperty double x\nproperty double y\n"
                                    "property double z\nelement face 6\nproperty list uchar int vertex_indices\nend_header\n",
                                    text ? "ascii" : "binary_little_endian");
    const auto put = [&bytes](const auto& value) { bytes.append(reinterpret_cast<const char*>(&value), sizeof value); };
    for (int i = 0; i < 8; ++i) {
      const glm::dvec3 c = corner(kLow, kSize, i);
      if (text) bytes += fmt::format("{:.4f} {:.4f} {:.4f}\n", c.x, c.y, c.z);
      else put(c);
    }
    for (const auto& s : kSides) {
      if (text) bytes += fmt::format("4 {} {} {} {}\n", s[0], s[1], s[2], s[3]);
      else {
        put(std::uint8_t{4});
        for (const int i : s) put(std::int32_t{i});
      }
    }
    expectBox(read("far.ply", bytes), kLow, kSize, 2e-5);
  }
}

TEST_F(MeshFiles, APlyOfPointsIsLeftToTheScanReader) {
  EXPECT_NE(refusal("p.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
                             "end_header\n0 0 0\n").find("Open it as a scan"), std::string::npos);
}

TEST_F(MeshFiles, EmptyMissingAndForeignFilesAreRefused) {
  EXPECT_NE(refusal("empty.obj", "").find("is empty"), std::string::npos);
  EXPECT_NE(refusal("none.obj", "# nothing\n").find("no faces"), std::string::npos);
  EXPECT_NE(refusal("noise.obj", std::string("\x7f" "ELF\x02\x01\x00garbage", 14)).find("no faces"), std::string::npos);
  EXPECT_FALSE(MeshReader().read((m_folder / "gone.obj").string(), Progress(), warnings));
  EXPECT_FALSE(MeshReader().inspect("/dev/zero"));
}

TEST_F(MeshFiles, ACancelledReadSaysSo) {
  const Progress progress;
  progress.cancel();
  const auto model = MeshReader().read(write("box.obj", objBox(kLow, kSize)), progress, warnings);
  ASSERT_FALSE(model);
  EXPECT_TRUE(isCancelled(model.error()));
}

TEST_F(MeshFiles, ManyThreadsReadAtOnce) {
  const std::string path = write("box.obj", objBox(kLow, kSize));
  std::vector<std::thread> threads;
  std::array<bool, 8> good{};
  for (bool& each : good)
    threads.emplace_back([&each, &path] {
      std::vector<ImportWarning> none;
      const auto model = MeshReader().read(path, Progress(), none);
      each = model && model->triangles.size() == 36;
    });
  for (auto& t : threads) t.join();
  for (const bool each : good) EXPECT_TRUE(each);
}

TEST_F(MeshFiles, SniffingTellsMeshesFromClouds) {
  const auto score = [](const std::string& name, const std::string& head) {
    FileProbe probe;
    probe.path = name;
    probe.extension = fs::path(name).extension().string().substr(1);
    probe.head = std::as_bytes(std::span(head.data(), head.size()));
    return MeshReader().sniff(probe);
  };
  EXPECT_GE(score("a.glb", "glTF\x02"), 50);
  EXPECT_GE(score("a.ply", "ply\nformat ascii 1.0\nelement vertex 3\nelement face 1\n"), 50);
  EXPECT_EQ(score("a.ply", "ply\nformat ascii 1.0\nelement vertex 3\nelement face 0\nend_header\n"), 0);
  EXPECT_EQ(score("a.ply", "ply\nformat ascii 1.0\nelement vertex 3\nend_header\n"), 0);
  EXPECT_GT(score("a.obj", "v 0 0 0"), 0);
  EXPECT_EQ(score("a.las", "LASF"), 0);
}

TEST(MeshRealFiles, TheBoxIsAClosedSolid) {
  const std::string path = std::string(ALIDADE_SHARED_DATA_DIR) + "/text_and_ply/box.obj";
  if (!fs::exists(path)) GTEST_SKIP() << "no " << path;
  std::vector<ImportWarning> warnings;
  const auto info = MeshReader().inspect(path);
  ASSERT_TRUE(info) << info.error().text();
  const auto model = MeshReader().read(path, Progress(), warnings);
  ASSERT_TRUE(model) << model.error().text();
  EXPECT_EQ(model->triangles.size() / 3, 12u);
  EXPECT_NEAR(std::abs(volumeOf(*model)), model->bounds().size().x * model->bounds().size().y * model->bounds().size().z, 1e-6);
}

TEST(MeshRealFiles, TheRoadMeshLiesWhereItsSampledPointsLie) {
  const std::string path = std::string(ALIDADE_SHARED_DATA_DIR) + "/road/road.ply";
  if (!fs::exists(path)) GTEST_SKIP() << "no " << path;
  std::vector<ImportWarning> warnings;
  const auto model = MeshReader().read(path, Progress(), warnings);
  ASSERT_TRUE(model) << model.error().text();
  EXPECT_NEAR(static_cast<double>(model->triangles.size() / 3), 49999, 100);
  const Bounds box = model->bounds();
  // Bounds in the header of road_mesh_sampled.las, whose points were drawn from this mesh.
  EXPECT_NEAR(box.min.x, 100551.86, 0.1);
  EXPECT_NEAR(box.max.x, 100635.53, 0.1);
  EXPECT_NEAR(box.min.y, 196219.60, 0.1);
  EXPECT_NEAR(box.max.y, 196327.07, 0.1);
  EXPECT_NEAR(box.min.z, 5.177, 0.1);
  EXPECT_NEAR(box.max.z, 8.241, 0.1);
}

}  // namespace
}  // namespace alidade
