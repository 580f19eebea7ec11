// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

// Holds ARCHITECTURE.md's table: a module includes only what stands on a lower line, and each
// third-party library is seen in its owner folders alone.

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace fs = std::filesystem;

namespace {

const std::vector<std::vector<std::string>> kFloors = {
    {"base"},
    {"geometry"},
    {"survey", "camera"},
    {"cloud", "cleaning", "gpu", "targets"},
    {"plugin_api", "raster"},
    {"io", "scene", "overlay", "inspect", "adjust", "simulate"},
    {"report", "align"},
    {"app"},
    {"cli"},
};

/// Pairs on one floor, or across, that DESIGN forbids or allows beyond the floors.
const std::set<std::pair<std::string, std::string>> kForbidden = {
    {"adjust", "cloud"}, {"scene", "gpu"}, {"scene", "overlay"}, {"overlay", "scene"}};
const std::set<std::pair<std::string, std::string>> kAllowedOnOneFloor = {{"survey", "camera"}};

/// Library header prefix -> folders that may include it.
const std::map<std::string, std::vector<std::string>> kOwners = {
    {"vulkan/", {"src/gpu"}},
    {"vtk", {"src/scene"}},
    {"ceres/", {"src/adjust"}},
    {"hwy/", {"src/cloud"}},
    {"pcl/", {"src/cleaning"}},
    {"opencv2/", {"src/io", "src/targets", "plugins/opencv-calib", "plugins/pictures", "plugins/e57", "src/align"}},
    {"pugixml", {"plugins/e57", "plugins/metashape", "plugins/realitycapture"}},
    {"ifcpp/", {"plugins/ifc"}},
    {"assimp/", {"plugins/mesh"}},
    {"embree3/", {"src/simulate", "src/inspect"}},
    {"proj.h", {"plugins/las"}},
    {"QWidget", {"ui"}},
    {"QtWidgets", {"ui"}},
    {"QMainWindow", {"ui"}},
    {"QSql", {"src/io"}},
};

int floorOf(const std::string& module) {
  for (std::size_t i = 0; i < kFloors.size(); ++i)
    if (std::find(kFloors[i].begin(), kFloors[i].end(), module) != kFloors[i].end()) return static_cast<int>(i);
  return -1;
}

struct Include {
  std::string file;    // relative to the source tree
  std::string header;  // as written
};

std::vector<Include> includesBelow(const std::string& folder) {
  static const std::regex pattern(R"(^\s*#\s*include\s*[<"]([^>"]+)[>"])");
  const fs::path root(ALIDADE_SOURCE_DIR);
  std::vector<Include> found;
  if (!fs::exists(root / folder)) return found;
  for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
    const auto extension = entry.path().extension();
    if (extension != ".h" && extension != ".cpp") continue;
    std::ifstream file(entry.path());
    std::string line;
    std::smatch match;
    while (std::getline(file, line))
      if (std::regex_search(line, match, pattern))
        found.push_back({fs::relative(entry.path(), root).generic_string(), match[1]});
  }
  return found;
}

std::string moduleOf(const std::string& path) {
  const auto slash = path.find('/');
  return slash == std::string::npos ? std::string() : path.substr(0, slash);
}

}  // namespace

TEST(Architecture, AModuleIncludesOnlyLowerFloors) {
  for (const auto& include : includesBelow("src")) {
    const std::string from = moduleOf(include.file.substr(4));
    const std::string to = moduleOf(include.header);
    if (to.empty() || floorOf(to) < 0 || from == to) continue;
    ASSERT_GE(floorOf(from), 0) << "src/" << from << " is no room of ARCHITECTURE.md";
    const bool lower = floorOf(to) < floorOf(from) || kAllowedOnOneFloor.contains({from, to});
    EXPECT_TRUE(lower && !kForbidden.contains({from, to})) << include.file << " includes " << include.header;
  }
}

TEST(Architecture, PluginsKnowPluginApiAndWhatItNames) {
  const std::set<std::string> allowed = {"plugin_api", "survey", "camera", "geometry", "base"};
  for (const auto& include : includesBelow("plugins")) {
    const std::string to = moduleOf(include.header);
    if (floorOf(to) < 0) continue;
    EXPECT_TRUE(allowed.contains(to)) << include.file << " includes " << include.header;
  }
}

TEST(Architecture, AThirdPartyLibraryStaysWithItsOwner) {
  for (const std::string folder : {"src", "plugins", "ui"}) {
    for (const auto& include : includesBelow(folder)) {
      for (const auto& [prefix, owners] : kOwners) {
        if (!include.header.starts_with(prefix)) continue;
        const bool owned = std::any_of(owners.begin(), owners.end(),
                                       [&](const std::string& owner) { return include.file.starts_with(owner + "/"); });
        EXPECT_TRUE(owned) << include.file << " includes " << include.header;
      }
    }
  }
}

TEST(Architecture, EveryModuleOnDiskIsInTheTable) {
  for (const auto& entry : fs::directory_iterator(fs::path(ALIDADE_SOURCE_DIR) / "src")) {
    if (!entry.is_directory()) continue;
    EXPECT_GE(floorOf(entry.path().filename().string()), 0) << entry.path();
  }
}

TEST(Architecture, EverySourceFileNamesItsLicence) {
  for (const std::string folder : {"src", "plugins", "ui", "tests", "resources/shaders"}) {
    const fs::path root = fs::path(ALIDADE_SOURCE_DIR) / folder;
    if (!fs::exists(root)) continue;
    for (const auto& entry : fs::recursive_directory_iterator(root)) {
      const std::string extension = entry.path().extension().string();
      static const std::set<std::string> sources = {".h", ".cpp", ".glsl", ".vert", ".frag", ".comp", ".tesc", ".tese"};
      if (!sources.contains(extension)) continue;
      std::ifstream file(entry.path());
      std::string first;
      for (std::string line; first.size() < 300 && std::getline(file, line);) first += line + '\n';
      EXPECT_NE(first.find("SPDX-License-Identifier: BSD-3-Clause"), std::string::npos) << entry.path();
    }
  }
}
