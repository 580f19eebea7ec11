// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <string>

#include <fmt/format.h>
#include <glm/glm.hpp>

namespace alidade {

/// A small IFC4 model written out by hand, so that its true geometry is known: a site, a storey, a wall of
/// 3.0 x 0.2 x 2.5 m with a window opening of 1.0 x 1.2 m through it. Numbers are in `unit` metres.
struct IfcText {
  std::string schema = "IFC4";
  double unit = 0.001;             ///< metres per file unit: 1 or 0.001
  glm::dvec3 site{0.0};            ///< placement of the site, metres
  glm::dvec3 inSolid{0.0};         ///< offset within the wall's own geometry instead, metres
  std::string wallPlacementUnder = "#21";
  std::string more;                ///< further data lines

  std::string point(const glm::dvec3& metres) const {
    return fmt::format("IFCCARTESIANPOINT(({:.6f},{:.6f},{:.6f}))", metres.x / unit, metres.y / unit, metres.z / unit);
  }

  std::string text() const {
    const std::string prefix = unit == 1 ? "$" : ".MILLI.";
    const auto n = [this](double metres) { return fmt::format("{:.6f}", metres / unit); };
    std::string s = "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION(('ViewDefinition [ReferenceView]'),'2;1');\n"
                    "FILE_NAME('t.ifc','2026-01-01T00:00:00',(''),(''),'pre','Handwritten','');\n"
                    "FILE_SCHEMA(('" + schema + "'));\nENDSEC;\nDATA;\n";
    s += "#1=IFCPROJECT('0000000000000000000001',$,'P',$,$,$,$,(#10),#2);\n#2=IFCUNITASSIGNMENT((#3,#4));\n"
         "#3=IFCSIUNIT(*,.LENGTHUNIT.," + prefix + ",.METRE.);\n#4=IFCSIUNIT(*,.PLANEANGLEUNIT.,$,.RADIAN.);\n"
         "#10=IFCGEOMETRICREPRESENTATIONCONTEXT($,'Model',3,1.E-5,#11,$);\n#11=IFCAXIS2PLACEMENT3D(#12,$,$);\n"
         "#12=IFCCARTESIANPOINT((0.,0.,0.));\n";
    s += "#20=IFCSITE('0000000000000000000002',$,'Site',$,$,#21,$,$,.ELEMENT.,$,$,$,$,$);\n"
         "#21=IFCLOCALPLACEMENT($,#22);\n#22=IFCAXIS2PLACEMENT3D(#23,$,$);\n#23=" + point(site) + ";\n"
         "#30=IFCBUILDING('0000000000000000000003',$,'B',$,$,#21,$,$,.ELEMENT.,$,$,$);\n"
         "#40=IFCBUILDINGSTOREY('0000000000000000000004',$,'Ground floor',$,$,#21,$,$,.ELEMENT.,0.);\n"
         "#41=IFCRELAGGREGATES('0000000000000000000005',$,$,$,#1,(#20));\n"
         "#42=IFCRELAGGREGATES('0000000000000000000006',$,$,$,#20,(#30));\n"
         "#43=IFCRELAGGREGATES('0000000000000000000007',$,$,$,#30,(#40));\n"
         "#44=IFCRELCONTAINEDINSPATIALSTRUCTURE('0000000000000000000008',$,$,$,(#50),#40);\n";
    s += "#50=IFCWALL('1F6umJ5H50aeL3A1As_wTm',$,'South wall',$,$,#51,#55,$" +
         std::string(schema == "IFC2X3" ? "" : ",$") + ");\n#51=IFCLOCALPLACEMENT(" + wallPlacementUnder + ",#11);\n"
         "#55=IFCPRODUCTDEFINITIONSHAPE($,$,(#56));\n#56=IFCSHAPEREPRESENTATION(#10,'Body','SweptSolid',(#57));\n"
         "#57=IFCEXTRUDEDAREASOLID(#58,#62,#61," + n(2.5) + ");\n"
         "#58=IFCRECTANGLEPROFILEDEF(.AREA.,$,#59," + n(3.0) + "," + n(0.2) + ");\n"
         "#59=IFCAXIS2PLACEMENT2D(#60,$);\n#60=IFCCARTESIANPOINT((0.,0.));\n#61=IFCDIRECTION((0.,0.,1.));\n"
         "#62=IFCAXIS2PLACEMENT3D(#63,$,$);\n#63=" + point(inSolid) + ";\n";
    s += "#70=IFCOPENINGELEMENT('0000000000000000000009',$,'Opening',$,$,#71,#75,$" +
         std::string(schema == "IFC2X3" ? "" : ",$") + ");\n#71=IFCLOCALPLACEMENT(#51,#11);\n"
         "#75=IFCPRODUCTDEFINITIONSHAPE($,$,(#76));\n#76=IFCSHAPEREPRESENTATION(#10,'Body','SweptSolid',(#77));\n"
         "#77=IFCEXTRUDEDAREASOLID(#78,#82,#61," + n(1.2) + ");\n"
         "#78=IFCRECTANGLEPROFILEDEF(.AREA.,$,#59," + n(1.0) + "," + n(0.4) + ");\n"
         "#82=IFCAXIS2PLACEMENT3D(#83,$,$);\n#83=" + point(inSolid + glm::dvec3(0, 0, 0.9)) + ";\n"
         "#90=IFCRELVOIDSELEMENT('000000000000000000000A',$,$,$,#50,#70);\n";
    return s + more + "ENDSEC;\nEND-ISO-10303-21;\n";
  }
};

}  // namespace alidade
