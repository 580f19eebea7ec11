// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>

#include <gtest/gtest.h>

#include "ifc/ifc_reader.h"

namespace alidade {
namespace {

std::string dataFile(const std::string& name) { return std::string(ALIDADE_SHARED_DATA_DIR) + "/" + name; }

#define SKIP_WITHOUT(path) \
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no " << path

struct Expected {
  const char* file;
  const char* schema;
  std::size_t drawn;     ///< products with a body that are drawn
  std::size_t notDrawn;  ///< spaces and the like with a body; both together are what ifcplusplus makes
};

class IfcRealFile : public testing::TestWithParam<Expected> {};

TEST_P(IfcRealFile, GivesEveryProductThatHasABody) {
  const Expected& expected = GetParam();
  const std::string path = dataFile(expected.file);
  SKIP_WITHOUT(path);
  const auto info = IfcReader().inspect(path);
  ASSERT_TRUE(info) << info.error().text();
  EXPECT_EQ(info->schema, expected.schema);
  EXPECT_GE(info->elementCount, expected.drawn);
  std::vector<ImportWarning> warnings;
  const auto model = IfcReader().read(path, Progress(), warnings);
  ASSERT_TRUE(model) << model.error().text();
  EXPECT_EQ(model->elements.size(), expected.drawn);
  std::set<std::string> ids;
  for (const DesignElement& e : model->elements) {
    EXPECT_GT(e.indexCount, 0u) << e.name;
    EXPECT_GT(e.edgeCount, 0u) << e.name;
    EXPECT_EQ(e.globalId.size(), 22u) << e.name;
    EXPECT_TRUE(ids.insert(e.globalId).second) << e.name;
    EXPECT_EQ(e.type.rfind("Ifc", 0), 0u);
    EXPECT_GE(e.colour.a, 25) << e.name;
  }
  std::size_t notDrawn = 0;
  for (const auto& w : warnings)
    if (w.what.find("are not drawn") != std::string::npos) notDrawn = std::stoul(w.what);
  EXPECT_GE(notDrawn, expected.notDrawn);
}

INSTANTIATE_TEST_SUITE_P(All, IfcRealFile,
                         testing::Values(Expected{"ifc/AC20-FZK-Haus.ifc", "IFC4", 83, 7},
                                         Expected{"ifc/duplex.ifc", "IFC2X3", 215, 21},
                                         Expected{"ifc/IfcOpenHouse_IFC4.ifc", "IFC4", 35, 0},
                                         Expected{"ifc/LargeBuilding.ifc", "IFC2X3", 114, 8},
                                         Expected{"ifc/SimpleWall.ifc", "IFC2X3", 2, 0},
                                         Expected{"road/road.ifc", "IFC2X3", 64, 0}));

TEST(IfcRealFiles, TheRoadInIfc4x3IsRefusedByName) {
  const std::string path = dataFile("ifc/KIT-Simple-Road-Test-Web-IFC4x3_RC2.ifc");
  SKIP_WITHOUT(path);
  std::vector<ImportWarning> warnings;
  const auto model = IfcReader().read(path, Progress(), warnings);
  ASSERT_FALSE(model);
  EXPECT_NE(model.error().text().find("IFC4X3_RC2"), std::string::npos);
  EXPECT_NE(model.error().advice.find("IFC4 Reference View"), std::string::npos);
}

TEST(IfcRealFiles, FzkHausStandsInMetresWithItsStoreysAndProperties) {
  const std::string path = dataFile("ifc/AC20-FZK-Haus.ifc");
  SKIP_WITHOUT(path);
  std::vector<ImportWarning> warnings;
  const auto model = IfcReader().read(path, Progress(), warnings);
  ASSERT_TRUE(model) << model.error().text();
  Bounds walls;
  std::map<std::string, int> storeys;
  for (std::size_t i = 0; i < model->elements.size(); ++i) {
    ++storeys[model->elements[i].storey];
    if (model->elements[i].type.rfind("IfcWall", 0) == 0) walls.add(model->elementBounds(i));
  }
  // The plan of this well-known model: 12 x 10 m, ridge near 6.5 m.
  EXPECT_NEAR(walls.size().x, 12.0, 1e-3);
  EXPECT_NEAR(walls.size().y, 10.0, 1e-3);
  EXPECT_NEAR(model->bounds().max.z, 6.5, 0.3);
  EXPECT_GT(storeys["Erdgeschoss"], 20);
  EXPECT_GT(storeys["Dachgeschoss"], 5);
}

TEST(IfcRealFiles, RoadVerticesAreTheFilesOwnPoints) {
  const std::string path = dataFile("road/road.ifc");
  SKIP_WITHOUT(path);
  std::vector<ImportWarning> warnings;
  const auto model = IfcReader().read(path, Progress(), warnings);
  ASSERT_TRUE(model) << model.error().text();

  // Bounds of road_mesh_sampled.las, points sampled from the photogrammetric mesh of the same place; trees rise above.
  const Bounds box = model->bounds();
  EXPECT_GT(box.min.x, 100551.86);
  EXPECT_LT(box.max.x, 100635.54);
  EXPECT_GT(box.min.y, 196219.60);
  EXPECT_LT(box.max.y, 196327.07);
  EXPECT_GT(box.min.z, 5.1);

  // The breps are written in world coordinates: every vertex of theirs is a point of the text.
  std::ifstream file(path);
  std::vector<glm::dvec3> points;
  const std::regex pattern(R"(IFCCARTESIANPOINT\(\(([-0-9.E+]+),([-0-9.E+]+),([-0-9.E+]+)\)\))");
  std::smatch match;
  for (std::string line; std::getline(file, line);)
    if (std::regex_search(line, match, pattern)) points.emplace_back(std::stod(match[1]), std::stod(match[2]), std::stod(match[3]));
  std::sort(points.begin(), points.end(), [](const auto& a, const auto& b) { return a.x < b.x; });
  std::size_t found = 0, all = 0;
  for (const DesignElement& e : model->elements) {
    if (e.name.find("Fundering") == std::string::npos && e.name.find("Verhardingstype") == std::string::npos) continue;
    if (e.globalId == "2vLNF4ypr1AxRTiBL6oGaV" || e.globalId == "1n$3RrgP59tB3ZdWRm77Wq") continue;  // extruded: below
    for (std::uint32_t i = 0; i < e.indexCount; ++i) {
      const glm::dvec3 v = model->world(model->triangles[e.firstIndex + i]);
      const auto from = std::lower_bound(points.begin(), points.end(), v.x - 1e-5, [](const auto& p, double x) { return p.x < x; });
      bool hit = false;
      for (auto p = from; p != points.end() && p->x <= v.x + 1e-5 && !hit; ++p) hit = glm::distance(*p, v) < 1e-5;
      found += hit;
      ++all;
    }
  }
  EXPECT_GT(all, 1000u);
  EXPECT_EQ(found, all);

  // #3788, an extrusion in world coordinates: its first profile point by IfcAxis2Placement3D's definition.
  const glm::dvec3 z = glm::normalize(glm::dvec3(0.01622390765622238, 0.01207473732190387, 0.9997954718536034));
  const glm::dvec3 reference(0.9998683837487624, -0.0001959252102254031, -0.01622272458465683);
  const glm::dvec3 x = glm::normalize(reference - z * glm::dot(reference, z)), y = glm::cross(z, x);
  const glm::dvec3 low = glm::dvec3(100586.9609006369, 196284.1159504860, 6.699121974080768) -
                         6.639291837273049 * x + 11.46931973053142 * y;
  double nearLow = 1, nearHigh = 1;
  for (const DesignElement& e : model->elements) {
    if (e.globalId != "2vLNF4ypr1AxRTiBL6oGaV") continue;
    for (std::uint32_t i = 0; i < e.indexCount; ++i) {
      const glm::dvec3 v = model->world(model->triangles[e.firstIndex + i]);
      nearLow = std::min(nearLow, glm::distance(v, low));
      nearHigh = std::min(nearHigh, glm::distance(v, low + 0.0399999999982398 * z));
    }
  }
  EXPECT_LT(nearLow, 1e-5);
  EXPECT_LT(nearHigh, 1e-5);
}

TEST(IfcRealFiles, BoxesAndWallsFaceOutwards) {
  for (const char* name : {"ifc/AC20-FZK-Haus.ifc", "ifc/duplex.ifc", "ifc/LargeBuilding.ifc", "ifc/SimpleWall.ifc"}) {
    const std::string path = dataFile(name);
    SKIP_WITHOUT(path);
    std::vector<ImportWarning> warnings;
    const auto model = IfcReader().read(path, Progress(), warnings);
    ASSERT_TRUE(model) << model.error().text();
    for (const DesignElement& e : model->elements) {
      if (e.type.rfind("IfcWall", 0) != 0 && e.type != "IfcSlab" && e.type != "IfcMember") continue;
      const glm::dvec3 origin(model->vertices[model->triangles[e.firstIndex]]);
      double six = 0;
      for (std::uint32_t i = 0; i < e.indexCount; i += 3) {
        const auto at = [&](std::uint32_t k) { return glm::dvec3(model->vertices[model->triangles[e.firstIndex + i + k]]) - origin; };
        six += glm::dot(at(0), glm::cross(at(1), at(2)));
      }
      EXPECT_GT(six, 0) << name << " " << e.name;
    }
  }
}

}  // namespace
}  // namespace alidade
