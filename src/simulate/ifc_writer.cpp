// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <cctype>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "simulate/design_writer.h"
#include "simulate/las_writer.h"
#include "simulate/output_file.h"

namespace alidade {

namespace {

/// STEP wants a decimal point in every real and a capital E.
std::string real(double value) {
  return fmt::format("{:#.9G}", value == 0 ? 0.0 : value);
}

std::string exactReal(double value) {
  return fmt::format("{:.6f}", value);
}

/// Entities in the order in which they are made, each with its number.
class StepFile {
 public:
  int add(const std::string& entity) {
    m_text += fmt::format("#{}={};\n", ++m_count, entity);
    return m_count;
  }
  const std::string& text() const { return m_text; }

 private:
  std::string m_text;
  int m_count = 0;
};

std::string references(const std::vector<int>& ids) {
  std::string text;
  for (std::size_t i = 0; i < ids.size(); ++i) text += fmt::format("{}#{}", i ? "," : "", ids[i]);
  return fmt::format("({})", text);
}

class IfcBuilder {
 public:
  explicit IfcBuilder(const SiteModel& site) : m_site(site) {}

  std::string build() {
    addProject();
    std::vector<std::vector<int>> contained(m_site.storeys.size());
    std::vector<int> outside;
    for (const DesignItem& item : m_site.items) {
      const bool civil = item.ifcType != "IfcColumn" && item.ifcType != "IfcWall" &&
                         item.ifcType != "IfcSlab" && item.ifcType != "IfcBeam";
      (civil ? outside : contained[item.storey]).push_back(addItem(item, civil));
    }
    for (std::size_t i = 0; i < contained.size(); ++i)
      addContainment(contained[i], m_storeys[i], m_site.storeys[i].name);
    addContainment(outside, m_ifcSite, "Site");
    return header() + m_step.text() + "ENDSEC;\nEND-ISO-10303-21;\n";
  }

 private:
  static std::string header() {
    return "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION(('ViewDefinition [ReferenceView_V1.2]'),'2;1');\n"
           "FILE_NAME('design.ifc','2026-01-01T00:00:00',(''),(''),'Alidade','Alidade','');\n"
           "FILE_SCHEMA(('IFC4'));\nENDSEC;\nDATA;\n";
  }

  std::string id(const std::string& name) const { return ifcGlobalId(4711, name + m_site.items[0].globalId); }

  int point(const glm::dvec3& p) {
    return m_step.add(fmt::format("IFCCARTESIANPOINT(({},{},{}))", real(p.x), real(p.y), real(p.z)));
  }
  int point(const glm::dvec2& p) {
    return m_step.add(fmt::format("IFCCARTESIANPOINT(({},{}))", real(p.x), real(p.y)));
  }
  int direction(const glm::dvec3& d) {
    return m_step.add(fmt::format("IFCDIRECTION(({},{},{}))", real(d.x), real(d.y), real(d.z)));
  }
  int axisPlacement(const glm::dvec3& origin, const glm::dmat3& axes) {
    const int o = point(origin), z = direction(axes[2]), x = direction(axes[0]);
    return m_step.add(fmt::format("IFCAXIS2PLACEMENT3D(#{},#{},#{})", o, z, x));
  }
  int localPlacement(int parent, const glm::dvec3& origin, const glm::dmat3& axes = glm::dmat3(1.0)) {
    const int axis = axisPlacement(origin, axes);
    return m_step.add(parent ? fmt::format("IFCLOCALPLACEMENT(#{},#{})", parent, axis)
                             : fmt::format("IFCLOCALPLACEMENT($,#{})", axis));
  }

  int units() {
    const int metre = m_step.add("IFCSIUNIT(*,.LENGTHUNIT.,$,.METRE.)");
    const int area = m_step.add("IFCSIUNIT(*,.AREAUNIT.,$,.SQUARE_METRE.)");
    const int volume = m_step.add("IFCSIUNIT(*,.VOLUMEUNIT.,$,.CUBIC_METRE.)");
    const int angle = m_step.add("IFCSIUNIT(*,.PLANEANGLEUNIT.,$,.RADIAN.)");
    m_metre = metre;
    return m_step.add("IFCUNITASSIGNMENT(" + references({metre, area, volume, angle}) + ")");
  }

  void addMapConversion(int context) {
    const glm::dvec3 origin = m_site.worldFromSite.translation;
    const bool swiss = !coordinateSystemAt(origin).empty();
    const int crs =
        m_step.add(fmt::format("IFCPROJECTEDCRS('{}',{},$,$,$,$,#{})", swiss ? "EPSG:2056" : "Local grid",
                               swiss ? "'CH1903+ / LV95'" : "$", m_metre));
    m_step.add(fmt::format("IFCMAPCONVERSION(#{},#{},{},{},{},{},{},1.)", context, crs, exactReal(origin.x),
                           exactReal(origin.y), exactReal(origin.z),
                           fmt::format("{:.15f}", std::cos(m_site.rotation)),
                           fmt::format("{:.15f}", std::sin(m_site.rotation))));
  }

  void addProject() {
    const int world = axisPlacement(glm::dvec3(0.0), glm::dmat3(1.0));
    const int context =
        m_step.add(fmt::format("IFCGEOMETRICREPRESENTATIONCONTEXT($,'Model',3,1.0E-5,#{},$)", world));
    m_body = m_step.add(fmt::format(
        "IFCGEOMETRICREPRESENTATIONSUBCONTEXT('Body','Model',*,*,*,*,#{},$,.MODEL_VIEW.,$)", context));
    const int unit = units();
    const int project = m_step.add(fmt::format("IFCPROJECT('{}',$,'Alidade demo site',$,$,$,$,(#{}),#{})",
                                               id("project"), context, unit));
    addMapConversion(context);
    m_sitePlacement = localPlacement(0, glm::dvec3(0.0));
    m_ifcSite = m_step.add(
        fmt::format("IFCSITE('{}',$,'Site',$,$,#{},$,$,.ELEMENT.,$,$,$,$,$)", id("site"), m_sitePlacement));
    const int buildingPlacement = localPlacement(m_sitePlacement, glm::dvec3(0.0));
    const int building = m_step.add(fmt::format("IFCBUILDING('{}',$,'Hall A',$,$,#{},$,$,.ELEMENT.,$,$,$)",
                                                id("building"), buildingPlacement));
    for (const Storey& storey : m_site.storeys) {
      m_storeyPlacements.push_back(localPlacement(buildingPlacement, {0, 0, storey.elevation}));
      m_storeys.push_back(
          m_step.add(fmt::format("IFCBUILDINGSTOREY('{}',$,'{}',$,$,#{},$,$,.ELEMENT.,{})", id(storey.name),
                                 storey.name, m_storeyPlacements.back(), real(storey.elevation))));
    }
    m_step.add(fmt::format("IFCRELAGGREGATES('{}',$,$,$,#{},(#{}))", id("agg project"), project, m_ifcSite));
    m_step.add(fmt::format("IFCRELAGGREGATES('{}',$,$,$,#{},(#{}))", id("agg site"), m_ifcSite, building));
    m_step.add(fmt::format("IFCRELAGGREGATES('{}',$,$,$,#{},{})", id("agg building"), building,
                           references(m_storeys)));
  }

  int profile(const Prism& prism) { return closedProfile(prism.contour(), prism.holes()); }

  int polyline(const std::vector<glm::dvec2>& points) {
    std::vector<int> ids;
    for (const auto& p : points) ids.push_back(point(p));
    ids.push_back(ids.front());
    return m_step.add("IFCPOLYLINE(" + references(ids) + ")");
  }

  int closedProfile(const std::vector<glm::dvec2>& outer, const std::vector<std::vector<glm::dvec2>>& holes) {
    const int curve = polyline(outer);
    if (holes.empty()) return m_step.add(fmt::format("IFCARBITRARYCLOSEDPROFILEDEF(.AREA.,$,#{})", curve));
    std::vector<int> inner;
    for (const auto& hole : holes) inner.push_back(polyline(hole));
    return m_step.add(
        fmt::format("IFCARBITRARYPROFILEDEFWITHVOIDS(.AREA.,$,#{},{})", curve, references(inner)));
  }

  int style(Material material) {
    int& made = m_styles[material];
    if (made) return made;
    const glm::dvec3 c = designColour(material);
    const int colour = m_step.add(fmt::format("IFCCOLOURRGB($,{},{},{})", real(c.r), real(c.g), real(c.b)));
    const int rendering =
        m_step.add(fmt::format("IFCSURFACESTYLERENDERING(#{},0.,$,$,$,$,$,$,.NOTDEFINED.)", colour));
    return made = m_step.add(fmt::format("IFCSURFACESTYLE('Material {}',.BOTH.,(#{}))",
                                         static_cast<int>(material), rendering));
  }

  int addItem(const DesignItem& item, bool civil) {
    const Prism& prism = item.prism;
    const double base = civil ? 0.0 : m_site.storeys[item.storey].elevation;
    const int placement = localPlacement(civil ? m_sitePlacement : m_storeyPlacements[item.storey],
                                         prism.origin - glm::dvec3(0, 0, base), prism.axes);
    const int area = profile(prism);
    const int position = axisPlacement(glm::dvec3(0.0), glm::dmat3(1.0));
    const int along = direction({0, 0, 1});
    const int solid = m_step.add(
        fmt::format("IFCEXTRUDEDAREASOLID(#{},#{},#{},{})", area, position, along, real(prism.depth)));
    m_step.add(fmt::format("IFCSTYLEDITEM(#{},(#{}),$)", solid, style(item.material)));
    const int shape =
        m_step.add(fmt::format("IFCSHAPEREPRESENTATION(#{},'Body','SweptSolid',(#{}))", m_body, solid));
    const int product = m_step.add(fmt::format("IFCPRODUCTDEFINITIONSHAPE($,$,(#{}))", shape));
    std::string type = item.ifcType;
    for (char& c : type) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    const std::string predefined = item.predefined.empty() ? "$" : fmt::format(".{}.", item.predefined);
    const int element = m_step.add(fmt::format("{}('{}',$,'{}',$,$,#{},#{},$,{})", type, item.globalId,
                                               item.name, placement, product, predefined));
    addProperties(item, element);
    return element;
  }

  void addProperties(const DesignItem& item, int element) {
    if (item.properties.empty()) return;
    std::vector<int> values;
    for (const auto& [name, value] : item.properties) {
      const bool boolean = value == "true" || value == "false";
      const std::string nominal = boolean ? (value == "true" ? "IFCBOOLEAN(.T.)" : "IFCBOOLEAN(.F.)")
                                          : fmt::format("IFCIDENTIFIER('{}')", value);
      values.push_back(m_step.add(fmt::format("IFCPROPERTYSINGLEVALUE('{}',$,{},$)", name, nominal)));
    }
    const std::string set = fmt::format("Pset_{}Common", item.ifcType.substr(3));
    const int properties = m_step.add(
        fmt::format("IFCPROPERTYSET('{}',$,'{}',$,{})", id(item.name + " set"), set, references(values)));
    m_step.add(fmt::format("IFCRELDEFINESBYPROPERTIES('{}',$,$,$,(#{}),#{})", id(item.name + " properties"),
                           element, properties));
  }

  void addContainment(const std::vector<int>& elements, int structure, const std::string& name) {
    if (elements.empty()) return;
    m_step.add(fmt::format("IFCRELCONTAINEDINSPATIALSTRUCTURE('{}',$,$,$,{},#{})", id(name + " contains"),
                           references(elements), structure));
  }

  const SiteModel& m_site;
  StepFile m_step;
  int m_body = 0, m_metre = 0, m_ifcSite = 0, m_sitePlacement = 0;
  std::vector<int> m_storeys, m_storeyPlacements;
  std::map<Material, int> m_styles;
};

}  // namespace

Result<void> writeDesignIfc(const std::string& path, const SiteModel& site) {
  return writeWholeFile(path, IfcBuilder(site).build());
}

}  // namespace alidade
