// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <filesystem>
#include <fstream>

#include <unistd.h>

#include <gtest/gtest.h>

#include "ifc/ifc_reader.h"
#include "ifc_text.h"

namespace alidade {
namespace {

namespace fs = std::filesystem;

double volumeOf(const DesignModel& model, const DesignElement& element) {
  double six = 0;
  const glm::dvec3 origin(model.vertices[model.triangles[element.firstIndex]]);
  for (std::uint32_t i = 0; i < element.indexCount; i += 3) {
    const auto at = [&](std::uint32_t k) {
      return glm::dvec3(model.vertices[model.triangles[element.firstIndex + i + k]]) - origin;
    };
    six += glm::dot(at(0), glm::cross(at(1), at(2)));
  }
  return six / 6;
}

/// A folder that goes with the test.
class IfcFiles : public testing::Test {
 protected:
  IfcFiles() : m_folder(fs::temp_directory_path() / fmt::format("alidade-ifc-test-{}", ::getpid())) {
    fs::create_directories(m_folder);
  }
  ~IfcFiles() override { fs::remove_all(m_folder); }

  std::string write(const std::string& content) const {
    std::ofstream(m_folder / "t.ifc", std::ios::binary) << content;
    return (m_folder / "t.ifc").string();
  }
  Result<DesignModel> read(const std::string& content) {
    warnings.clear();
    return IfcReader().read(write(content), Progress(), warnings);
  }
  std::string refusal(const std::string& content) {
    const auto model = read(content);
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

void expectWall(const Result<DesignModel>& model, const glm::dvec3& low, double tolerance) {
  ASSERT_TRUE(model) << model.error().text();
  ASSERT_EQ(model->elements.size(), 1u);
  const Bounds box = model->bounds();
  const glm::dvec3 high = low + glm::dvec3(3.0, 0.2, 2.5);
  for (int a = 0; a < 3; ++a) {
    EXPECT_NEAR(box.min[a], low[a], tolerance) << "axis " << a;
    EXPECT_NEAR(box.max[a], high[a], tolerance) << "axis " << a;
  }
  // 3.0 x 0.2 x 2.5 less the window of 1.0 x 0.2 x 1.2, faces outwards.
  EXPECT_NEAR(volumeOf(*model, model->elements[0]), 1.5 - 0.24, 1e-4);
  // The wall's twelve edges and the opening's twelve.
  double length = 0;
  for (const auto& e : model->edges) length += glm::distance(model->world(e[0]), model->world(e[1]));
  EXPECT_NEAR(length, 4 * (3.0 + 0.2 + 2.5) + 4 * (1.0 + 0.2 + 1.2), 1e-3);
}

TEST_F(IfcFiles, AWallWithAWindowHasItsSizeItsOpeningAndItsNames) {
  for (const char* schema : {"IFC4", "IFC2X3"}) {
    for (const double unit : {1.0, 0.001}) {
      IfcText ifc;
      ifc.schema = schema;
      ifc.unit = unit;
      const auto model = read(ifc.text());
      expectWall(model, {-1.5, -0.1, 0}, 1e-6);
      const DesignElement& wall = model->elements[0];
      EXPECT_EQ(wall.globalId, "1F6umJ5H50aeL3A1As_wTm");
      EXPECT_EQ(wall.name, "South wall");
      EXPECT_EQ(wall.type, "IfcWall");
      EXPECT_EQ(wall.storey, "Ground floor");
    }
  }
}

TEST_F(IfcFiles, ASiteFarFromTheOriginCostsNoPrecision) {
  const glm::dvec3 far(2683500.123, 1247800.456, 408.789);
  IfcText ifc;
  ifc.site = far;
  expectWall(read(ifc.text()), far + glm::dvec3(-1.5, -0.1, 0), 1e-5);
  ifc.unit = 1;
  expectWall(read(ifc.text()), far + glm::dvec3(-1.5, -0.1, 0), 1e-5);
}

TEST_F(IfcFiles, GeometryWrittenInFarCoordinatesItselfKeepsItsMillimetres) {
  const glm::dvec3 far(2683500.123, 1247800.456, 408.789);
  IfcText ifc;
  ifc.inSolid = far;
  expectWall(read(ifc.text()), far + glm::dvec3(-1.5, -0.1, 0), 1e-5);
}

TEST_F(IfcFiles, AMapConversionMovesAndTurnsTheModel) {
  IfcText ifc;
  ifc.unit = 1;
  // x axis of the model points north-east by atan2(3, 4).
  ifc.more = "#100=IFCPROJECTEDCRS('EPSG:2056',$,$,$,$,$,#3);\n"
             "#101=IFCMAPCONVERSION(#10,#100,2683500.25,1247800.5,400.,0.8,0.6,$);\n";
  const auto model = read(ifc.text());
  ASSERT_TRUE(model) << model.error().text();
  EXPECT_EQ(model->crs, "EPSG:2056");
  Bounds expected;
  for (const double x : {-1.5, 1.5})
    for (const double y : {-0.1, 0.1})
      for (const double z : {0.0, 2.5})
        expected.add({2683500.25 + 0.8 * x - 0.6 * y, 1247800.5 + 0.6 * x + 0.8 * y, 400.0 + z});
  const Bounds box = model->bounds();
  for (int a = 0; a < 3; ++a) {
    EXPECT_NEAR(box.min[a], expected.min[a], 1e-5);
    EXPECT_NEAR(box.max[a], expected.max[a], 1e-5);
  }
  EXPECT_NEAR(volumeOf(*model, model->elements[0]), 1.26, 1e-4);
}

TEST_F(IfcFiles, AMapConversionInMetresFitsAModelInMillimetres) {
  IfcText ifc;
  ifc.more = "#99=IFCSIUNIT(*,.LENGTHUNIT.,$,.METRE.);\n#100=IFCPROJECTEDCRS('EPSG:2056',$,$,$,$,$,#99);\n"
             "#101=IFCMAPCONVERSION(#10,#100,2683500.25,1247800.5,400.,1.,0.,0.001);\n";
  expectWall(read(ifc.text()), glm::dvec3(2683500.25, 1247800.5, 400) + glm::dvec3(-1.5, -0.1, 0), 1e-5);
  EXPECT_FALSE(warned("scale"));
  // The well-known slip: the scale of the units is forgotten.
  ifc.more.replace(ifc.more.find("0.001"), 5, "1.");
  expectWall(read(ifc.text()), glm::dvec3(2683500.25, 1247800.5, 400) + glm::dvec3(-1.5, -0.1, 0), 1e-5);
  EXPECT_TRUE(warned("scale"));
}

TEST_F(IfcFiles, TheIfc2x3StandInForAMapConversionIsRead) {
  IfcText ifc;
  ifc.schema = "IFC2X3";
  ifc.unit = 1;
  ifc.more = "#100=IFCPROPERTYSINGLEVALUE('Eastings',$,IFCLENGTHMEASURE(2683500.25),$);\n"
             "#101=IFCPROPERTYSINGLEVALUE('Northings',$,IFCLENGTHMEASURE(1247800.5),$);\n"
             "#102=IFCPROPERTYSINGLEVALUE('OrthogonalHeight',$,IFCLENGTHMEASURE(400.),$);\n"
             "#103=IFCPROPERTYSET('000000000000000000000B',$,'ePSet_MapConversion',$,(#100,#101,#102));\n"
             "#104=IFCRELDEFINESBYPROPERTIES('000000000000000000000C',$,$,$,(#20),#103);\n";
  expectWall(read(ifc.text()), glm::dvec3(2683500.25, 1247800.5, 400) + glm::dvec3(-1.5, -0.1, 0), 1e-5);
}

TEST_F(IfcFiles, PropertySetsOfTheWallWinOverThoseOfItsType) {
  IfcText ifc;
  ifc.more = "#100=IFCPROPERTYSINGLEVALUE('LoadBearing',$,IFCBOOLEAN(.T.),$);\n"
             "#101=IFCPROPERTYSINGLEVALUE('Reference',$,IFCIDENTIFIER('W\\X2\\00E4\\X0\\nde'),$);\n"
             "#102=IFCPROPERTYSET('000000000000000000000B',$,'Pset_WallCommon',$,(#100,#101));\n"
             "#103=IFCRELDEFINESBYPROPERTIES('000000000000000000000C',$,$,$,(#50),#102);\n"
             "#110=IFCPROPERTYSINGLEVALUE('LoadBearing',$,IFCBOOLEAN(.F.),$);\n"
             "#111=IFCPROPERTYSINGLEVALUE('ThermalTransmittance',$,IFCTHERMALTRANSMITTANCEMEASURE(0.24),$);\n"
             "#112=IFCPROPERTYSET('000000000000000000000D',$,'Pset_WallCommon',$,(#110,#111));\n"
             "#113=IFCWALLTYPE('000000000000000000000E',$,'W20',$,$,(#112),$,$,$,.STANDARD.);\n"
             "#114=IFCRELDEFINESBYTYPE('000000000000000000000F',$,$,$,(#50),#113);\n";
  const auto model = read(ifc.text());
  ASSERT_TRUE(model) << model.error().text();
  const auto& properties = model->elements.at(0).properties;
  EXPECT_EQ(properties.at("Pset_WallCommon.LoadBearing"), "true");
  EXPECT_EQ(properties.at("Pset_WallCommon.Reference"), "Wände");
  EXPECT_EQ(properties.at("Pset_WallCommon.ThermalTransmittance"), "0.24");
  EXPECT_EQ(properties.at("Type"), "W20");
}

TEST_F(IfcFiles, ASurfaceStyleGivesTheColourElseTheType) {
  IfcText ifc;
  const auto plain = read(ifc.text());
  ASSERT_TRUE(plain) << plain.error().text();
  EXPECT_EQ(plain->elements.at(0).colour.a, 255);
  ifc.more = "#100=IFCSTYLEDITEM(#57,(#101),$);\n#101=IFCSURFACESTYLE($,.BOTH.,(#102));\n"
             "#102=IFCSURFACESTYLERENDERING(#103,0.5,$,$,$,$,$,$,.FLAT.);\n#103=IFCCOLOURRGB($,1.,0.,0.4);\n";
  const auto model = read(ifc.text());
  ASSERT_TRUE(model) << model.error().text();
  EXPECT_EQ(model->elements.at(0).colour, (Rgba8{255, 0, 102, 128}));
}

TEST_F(IfcFiles, SchemasThatAreNotReadAreRefusedByName) {
  for (const char* schema : {"IFC4X3", "IFC4X3_ADD2", "IFC4X1", "IFC2X2_FINAL"}) {
    IfcText ifc;
    ifc.schema = schema;
    const std::string words = refusal(ifc.text());
    EXPECT_NE(words.find(schema), std::string::npos) << words;
    EXPECT_NE(words.find("IFC4 Reference View"), std::string::npos) << words;
    EXPECT_FALSE(IfcReader().inspect(write(ifc.text())));
  }
  IfcText step;
  step.schema = "AUTOMOTIVE_DESIGN";
  EXPECT_NE(refusal(step.text()).find("not IFC"), std::string::npos);
}

TEST_F(IfcFiles, TruncatedEmptyAndForeignFilesAreRefused) {
  const std::string whole = IfcText().text();
  for (const double part : {0.01, 0.1, 0.3, 0.6, 0.9, 0.99})
    EXPECT_NE(refusal(whole.substr(0, static_cast<std::size_t>(part * static_cast<double>(whole.size())))), "accepted") << part;
  EXPECT_NE(refusal(whole.substr(0, whole.size() / 2)).find("cut off"), std::string::npos);
  EXPECT_NE(refusal("").find("is empty"), std::string::npos);
  EXPECT_NE(refusal("PK\x03\x04 a zip").find("no STEP file"), std::string::npos);
  EXPECT_FALSE(IfcReader().inspect("/dev/zero"));
  EXPECT_FALSE(IfcReader().inspect((m_folder / "gone.ifc").string()));
}

TEST_F(IfcFiles, PlacementsInACircleNeitherHangNorCrash) {
  IfcText ifc;
  ifc.wallPlacementUnder = "#200";
  ifc.more = "#200=IFCLOCALPLACEMENT(#201,#11);\n#201=IFCLOCALPLACEMENT(#200,#11);\n";
  const std::string outcome = refusal(ifc.text());
  EXPECT_TRUE(outcome == "accepted" || outcome.find("t.ifc") != std::string::npos) << outcome;
}

TEST_F(IfcFiles, BooleansAndMappedItemsInACircleBecomeAnError) {
  IfcText ifc;
  ifc.more = "#200=IFCWALL('000000000000000000000G',$,'W',$,$,#51,#201,$,$);\n#201=IFCPRODUCTDEFINITIONSHAPE($,$,(#202));\n"
             "#202=IFCSHAPEREPRESENTATION(#10,'Body','MappedRepresentation',(#203));\n#203=IFCMAPPEDITEM(#204,#205);\n"
             "#204=IFCREPRESENTATIONMAP(#11,#202);\n#205=IFCCARTESIANTRANSFORMATIONOPERATOR3D($,$,#12,$,$);\n"
             "#206=IFCBOOLEANRESULT(.DIFFERENCE.,#206,#57);\n";
  const std::string outcome = refusal(ifc.text());
  EXPECT_NE(outcome.find("t.ifc"), std::string::npos) << outcome;
}

TEST_F(IfcFiles, CoordinatesThatAreNoNumbersAreLeftOut) {
  for (const char* bad : {"1.E400", "1.E300", "-1.E400"}) {
    std::string text = IfcText().text();
    const std::string good = "#63=IFCCARTESIANPOINT((0.000000,0.000000,0.000000))";
    text.replace(text.find(good), good.size(), fmt::format("#63=IFCCARTESIANPOINT(({},0.,0.))", bad));
    const auto model = read(text);
    if (!model) continue;
    for (const auto& v : model->vertices) EXPECT_TRUE(std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z));
  }
}

TEST_F(IfcFiles, InspectCountsWithoutMakingGeometry) {
  IfcText ifc;
  ifc.more = "#100=IFCPROJECTEDCRS('EPSG:2056',$,$,$,$,$,#3);\n#101=IFCMAPCONVERSION(#10,#100,1.,2.,3.,1.,0.,$);\n"
             "/* #102=IFCWALL('in a comment'); */\n#103=IFCLABELTHING('#104=IFCWALL(''x'');');\n";
  const auto info = IfcReader().inspect(write(ifc.text()));
  ASSERT_TRUE(info) << info.error().text();
  EXPECT_EQ(info->schema, "IFC4");
  EXPECT_EQ(info->crs, "EPSG:2056");
  EXPECT_EQ(info->elementCount, 2u);  // the site and the wall
  EXPECT_NE(info->details.find("Handwritten"), std::string::npos) << info->details;
}

TEST_F(IfcFiles, ACancelledReadSaysSo) {
  const Progress progress;
  progress.cancel();
  const auto model = IfcReader().read(write(IfcText().text()), progress, warnings);
  ASSERT_FALSE(model);
  EXPECT_TRUE(isCancelled(model.error()));
}

TEST_F(IfcFiles, SniffingKnowsIfcByItsContent) {
  const auto score = [](const std::string& extension, const std::string& head) {
    FileProbe probe;
    probe.extension = extension;
    probe.head = std::as_bytes(std::span(head.data(), head.size()));
    return IfcReader().sniff(probe);
  };
  EXPECT_GE(score("txt", IfcText().text()), 50);
  EXPECT_GE(score("ifc", "ISO-10303-21;\nHEADER;\n/* long */"), 50);
  EXPECT_LT(score("stp", "ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('AUTOMOTIVE_DESIGN'));"), 50);
  EXPECT_EQ(score("las", "LASF"), 0);
}

}  // namespace
}  // namespace alidade
