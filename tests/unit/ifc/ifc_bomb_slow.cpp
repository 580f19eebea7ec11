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

TEST(IfcBomb, MappedItemsThatMultiplyHitALimit) {
  // Each level shows the one below ten times: 10^12 walls from a few lines.
  IfcText ifc;
  ifc.more = "#205=IFCCARTESIANTRANSFORMATIONOPERATOR3D($,$,#12,$,$);\n#300=IFCREPRESENTATIONMAP(#11,#56);\n";
  for (int level = 1; level <= 12; ++level) {
    std::string items;
    for (int i = 0; i < 10; ++i) items += fmt::format("{}#{}", i ? "," : "", 300 + 20 * level + i);
    for (int i = 0; i < 10; ++i)
      ifc.more += fmt::format("#{}=IFCMAPPEDITEM(#{},#205);\n", 300 + 20 * level + i, 300 + 20 * (level - 1) + (level > 1 ? 15 : 0));
    ifc.more += fmt::format("#{}=IFCSHAPEREPRESENTATION(#10,'Body','MappedRepresentation',({}));\n", 300 + 20 * level + 14, items);
    ifc.more += fmt::format("#{}=IFCREPRESENTATIONMAP(#11,#{});\n", 300 + 20 * level + 15, 300 + 20 * level + 14);
  }
  ifc.more += "#200=IFCWALL('000000000000000000000G',$,'W',$,$,#51,#201,$,$);\n#201=IFCPRODUCTDEFINITIONSHAPE($,$,(#554));\n";
  const auto path = std::filesystem::temp_directory_path() / fmt::format("alidade-ifc-bomb-{}.ifc", ::getpid());
  std::ofstream(path) << ifc.text();
  std::vector<ImportWarning> warnings;
  const auto model = IfcReader().read(path.string(), Progress(), warnings);
  std::filesystem::remove(path);
  ASSERT_FALSE(model);
  const std::string outcome = model.error().text();
  EXPECT_NE(outcome.find("Split the model"), std::string::npos) << outcome;
}

}  // namespace
}  // namespace alidade
